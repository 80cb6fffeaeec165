"""Interaction matrices of image moments of a planar target: s_dot = L V_C, V_C = [v; w] of the camera, target at rest.

All functions take the same arguments. `m` and `mu` are raw and centred moments of normalised image coordinates, as a
mapping by name "ij" (`Features.raw_moments()`, `Features.centred_moments()`). `plane` is (A, B, C) of
1/Z = A x + B y + C in the camera frame [1/m] (docs/theory.md T5). Rows have shape (6,), columns [vx vy vz wx wy wz].
An object without area raises DegenerateFeature. The tests check every row against central differences of exact polygon
moments.
"""

from typing import Iterable, List, Mapping, Sequence, Tuple

import numpy as np

from ..ground.errors import DegenerateFeature

#: _NAME[i][j] is the name of the moment ij. Looking it up is faster than making the text each time.
_NAME = tuple(tuple(f"{i}{j}" for j in range(10)) for i in range(10))


def shape(m: Mapping[str, float]) -> Tuple[float, float, float, float, float]:
    """Centroid and n20, n11, n02 of raw moments m. Raises DegenerateFeature for an empty object."""
    area = m["00"]
    if not area > 0.0:
        raise DegenerateFeature(f"area: found {area}, must be > 0")
    xg, yg = m["10"] / area, m["01"] / area
    return xg, yg, m["20"] / area - xg * xg, m["11"] / area - xg * yg, m["02"] / area - yg * yg


def plane_from_pose(normal_C: Sequence[float], point_C: Sequence[float]) -> np.ndarray:
    """(A, B, C), (3,) [1/m], of the plane through point_C [m] with normal_C, both (3,) in the camera frame (T5).

    Raises DegenerateFeature: the plane passes through the optical centre, so the camera sees it as a line.
    """
    normal = np.asarray(normal_C, dtype=float)
    distance = float(normal @ point_C)
    if distance == 0.0:
        raise DegenerateFeature("plane: passes through the optical centre, so the camera sees it as a line")
    return normal / distance


def plane_from(X: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """Returns the plane (A, B, C), (3,) [1/m], as a camera at X, (4, 4), sees it, from that of a camera at 0 (T21)."""
    seen: np.ndarray = (plane @ X[:3, :3]) / (1.0 - plane @ X[:3, 3])
    return seen


def centred_moments(m: Mapping[str, float], mu: Mapping[str, float], orders: Iterable[Tuple[int, int]],
                    plane: Sequence[float]) -> np.ndarray:
    """L of several mu_ij, (k, 6), i + j >= 2 (T7); needs centred moments to order i + j + 1 and raw ones to order 2.

    Args: orders: k pairs (i, j).
    """
    about = shape(m)
    return np.array([_centred_row(about, mu, i, j, plane) for i, j in orders])


def _centred_row(about, mu, i, j, plane):
    A, B, C = plane
    xg, yg, n20, n11, n02 = about
    here, up_i, up_j = mu[_NAME[i][j]], mu[_NAME[i + 1][j]], mu[_NAME[i][j + 1]]
    down_i, to_j = (mu[_NAME[i - 1][j]], mu[_NAME[i - 1][j + 1]]) if i > 0 else (0.0, 0.0)
    down_j, to_i = (mu[_NAME[i][j - 1]], mu[_NAME[i + 1][j - 1]]) if j > 0 else (0.0, 0.0)
    vx = -(i + 1) * A * here - i * B * to_j
    vy = -j * A * to_i - (j + 1) * B * here
    wx = ((i + j + 3) * up_j + i * xg * to_j + (i + 2 * j + 3) * yg * here - 4 * i * n11 * down_i
          - 4 * j * n02 * down_j)
    wy = (-(i + j + 3) * up_i - (2 * i + j + 3) * xg * here - j * yg * to_i + 4 * i * n20 * down_i
          + 4 * j * n11 * down_j)
    vz = -A * wy + B * wx + (i + j + 2) * C * here
    wz = i * to_j - j * to_i
    return vx, vy, vz, wx, wy, wz


def area(m: Mapping[str, float], plane: Sequence[float]) -> np.ndarray:
    """L of a = m00 (T8); needs raw moments to order 1."""
    return np.array(_area_row(m, plane))


def _area_row(m, plane):
    A, B, C = plane
    a = m["00"]
    if not a > 0.0:
        raise DegenerateFeature(f"area: found {a}, must be > 0")
    xg, yg = m["10"] / a, m["01"] / a
    over_Zg = A * xg + B * yg + C
    return [a * part for part in (-A, -B, 3.0 * over_Zg - C, 3.0 * yg, -3.0 * xg, 0.0)]


def centroid(m: Mapping[str, float], plane: Sequence[float]) -> np.ndarray:
    """L of (xg, yg), (2, 6) (T8); needs raw moments to order 2."""
    return np.array(centroid_rows(shape(m), plane))


def centroid_rows(about: Sequence[float], plane: Sequence[float]) -> List[List[float]]:
    """L of (xg, yg). Args: about: as of `shape`."""
    A, B, C = plane
    xg, yg, n20, n11, n02 = about
    over_Zg = A * xg + B * yg + C
    return [
        [-over_Zg, 0.0, xg * over_Zg + 4 * (A * n20 + B * n11), xg * yg + 4 * n11, -(1 + xg * xg + 4 * n20), yg],
        [0.0, -over_Zg, yg * over_Zg + 4 * (A * n11 + B * n02), 1 + yg * yg + 4 * n02, -xg * yg - 4 * n11, -xg],
    ]  # fmt: skip


def normalised(m: Mapping[str, float], plane: Sequence[float], z_star_m: float, area_star: float) -> np.ndarray:
    """L of (xn, yn, an), (3, 6) (T9). Args: z_star_m, area_star: depth [m] and area m00 of the reference view (T4)."""
    a = m["00"]
    L_a, (L_x, L_y) = _area_row(m, plane), centroid_rows(shape(m), plane)
    an = z_star_m * float(np.sqrt(area_star / a))
    slope, xg, yg = -(an / (2.0 * a)), m["10"] / a, m["01"] / a
    L_an = [slope * part for part in L_a]
    return np.array([[an * part + xg * other for part, other in zip(L_x, L_an)],
                     [an * part + yg * other for part, other in zip(L_y, L_an)], L_an])


def orientation(m: Mapping[str, float], mu: Mapping[str, float], plane: Sequence[float]) -> np.ndarray:
    """L of alpha (T10); needs raw and centred moments to order 3. Raises DegenerateFeature for an isotropic object."""
    A, B, _ = plane
    xg, yg, _, _, _ = shape(m)
    mu20, mu11, mu02 = mu["20"], mu["11"], mu["02"]
    mu30, mu21, mu12, mu03 = mu["30"], mu["21"], mu["12"], mu["03"]
    difference = mu20 - mu02
    D = difference * difference + 4.0 * mu11 * mu11
    if not D > 0.0:
        raise DegenerateFeature("orientation: the second-order moments are isotropic")
    p = mu11 * (mu20 + mu02) / D
    q = (2.0 * mu11 * mu11 - mu02 * difference) / D
    r = (2.0 * mu11 * mu11 + mu20 * difference) / D
    d = 5.0 * (mu12 * difference + mu11 * (mu03 - mu21)) / D
    e = 5.0 * (-mu21 * difference + mu11 * (mu30 - mu12)) / D
    wx, wy = -q * xg + p * yg + d, p * xg - r * yg + e
    return np.array([p * A + q * B, -r * A - p * B, -A * wy + B * wx, wx, wy, -1.0])


def times(factor: complex, row: np.ndarray) -> np.ndarray:
    """factor * row, (n,) complex.

    numpy multiplies arrays of complex numbers with fused products on processors with AVX-512 and without on others, so
    that its last bits, and the run hash with them, would depend on the processor.
    Args: factor: complex.  row: (n,) complex.
    """
    a, b, x, y = factor.real, factor.imag, row.real, row.imag
    product = np.empty_like(row)
    product.real, product.imag = a * x - b * y, a * y + b * x
    return product


def parallel_condition(xn: float, yn: float) -> float:
    """Condition number of the published L, eq. (16), of a target parallel to the image (T11), in closed form.

    L has the columns (vx, vy, vz, wz) and the determinant 1; it is exact at any depth.
    """
    r2 = xn * xn + yn * yn
    return 0.5 * (2.0 + r2 + (r2 * (r2 + 4.0)) ** 0.5)
