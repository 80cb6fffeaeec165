"""Circles and spheres, whose image is an ellipse: `xe, ye, e20, e11, e02` of a circle, `ox, oy, oz` of a sphere.

Of a circle: the centre of the ellipse, and its second-order moments n_ij = mu_ij / a (docs/theory.md T70). The values
are those of `xg, yg, n20, n11, n02`; the rows are those of an ellipse, so that moments of second order are all they
need, and an object whose image is not an ellipse, for example a disc that something covers in part, has none.

Of a sphere: the direction c in which its centre is seen, over the sine of the angle xi at which its radius R is seen.
That is the place of the centre in radii, O / R, so that a translation of the camera moves it straight and a turn turns
it rigidly (T71). The sphere's depth is that of the target's plane, which is taught as passing through its centre.

Reference for circles: B. Espiau, F. Chaumette, P. Rives, "A new approach to visual servoing in robotics", IEEE T-RA
8(3), 1992.
"""

from math import pi, sqrt
from typing import Tuple

import numpy as np

from ...ground.errors import DegenerateFeature
from ...spatial import skew
from .. import interaction
from ..base import Feature, View, register_each
from ...palette import BLUE, BROWN, GREEN, NAVY, VERMILION, VIOLET

#: An object counts as an ellipse if its area differs by no more than this part from that of the ellipse with the same
#: second-order moments. A square differs by 4.5 %, a disc of 20 px by 0.1 %.
NOT_ELLIPTIC = 0.03
#: The image of a sphere is the cut of a round cone. The two widths of the cone, as tangents, may differ by this part.
NOT_ROUND = 0.03


def ellipse(view: View) -> Tuple[float, float, float, float, float]:
    """(xg, yg, n20, n11, n02) of the object. Raises DegenerateFeature: its image is not an ellipse."""
    area, (xg, yg, n20, n11, n02) = view.m["00"], interaction.shape(view.m)
    determinant = n20 * n02 - n11 * n11
    elliptic = 4.0 * pi * sqrt(determinant) if determinant > 0.0 else 0.0
    if not abs(area - elliptic) <= NOT_ELLIPTIC * area:
        raise DegenerateFeature(f"ellipse: the area is {area:.4g}, an ellipse with its moments has {elliptic:.4g}, "
                                f"allowed {NOT_ELLIPTIC:g} of it apart: the object is no circle or sphere, or "
                                "is partly covered")
    return xg, yg, n20, n11, n02


def circle_rows(view: View) -> np.ndarray:
    """L of (xg, yg, n20, n11, n02), (5, 6), of a circle in the plane of the view (T70)."""
    x, y, n20, n11, n02 = view.shared(ellipse)
    A, B, C = view.plane
    over_Z = A * x + B * y + C
    along_x, along_y = A * n20 + B * n11, A * n11 + B * n02
    return np.array([
        *interaction.centroid_rows((x, y, n20, n11, n02), view.plane),
        [-2.0 * along_x, 0.0, 2.0 * (over_Z * n20 + x * along_x), 2.0 * (y * n20 + x * n11), -4.0 * x * n20, 2.0 * n11],
        [-along_y, -along_x, 2.0 * over_Z * n11 + x * along_y + y * along_x, x * n02 + 3.0 * y * n11,
         -(y * n20 + 3.0 * x * n11), n02 - n20],
        [0.0, -2.0 * along_y, 2.0 * (over_Z * n02 + y * along_y), 4.0 * y * n02, -2.0 * (x * n02 + y * n11),
         -2.0 * n11],
    ])  # fmt: skip


class _OfCircle(Feature):
    """Of a circle's image (T70) [-]."""

    sees_tilt = True

    def value(self, view):
        return view.shared(ellipse)[self.index]

    def row(self, view):
        return view.shared(circle_rows)[self.index]


register_each(_OfCircle, (
    ("xe", "x_e", "centre of the ellipse in x", BLUE), ("ye", "y_e", "centre of the ellipse in y", VERMILION),
    ("e20", "e_20", "variance of the ellipse in x", NAVY), ("e11", "e_11", "covariance of the ellipse", VIOLET),
    ("e02", "e_02", "variance of the ellipse in y", BROWN)))


def sphere(view: View) -> Tuple[np.ndarray, float]:
    """(O / R, (3,), and sin xi) of a sphere in the view. Raises DegenerateFeature: the image is not one of a sphere."""
    x, y, n20, n11, n02 = view.shared(ellipse)
    E = 0.25 * np.linalg.inv([[n20, n11], [n11, n02]])
    g = np.array([x, y])
    cone = np.empty((3, 3))
    cone[:2, :2], cone[2, :2], cone[2, 2] = E, -E @ g, g @ E @ g - 1.0
    cone[:2, 2] = cone[2, :2]
    (inside, small, large), axes = np.linalg.eigh(cone)
    if not sqrt(large / small) <= 1.0 + NOT_ROUND:
        raise DegenerateFeature(f"sphere: the cone of rays is {sqrt(large / small):.3f} times as wide in one direction "
                                f"as in the other, allowed 1 to {1.0 + NOT_ROUND:g}: the object is no sphere")
    sine = sqrt(-inside / (sqrt(small * large) - inside))
    c = axes[:, 0] if axes[2, 0] > 0.0 else -axes[:, 0]
    return c / sine, sine


class _OfSphere(Feature):
    """Of a sphere's centre, in its radii (T71) [-]."""

    sees_tilt = True

    def value(self, view):
        return float(view.shared(sphere)[0][self.index])

    def row(self, view):
        place, sine = view.shared(sphere)
        over_R = float(np.dot(view.plane, place))  # 1 / (distance sin xi), the distance along c to the plane
        return np.concatenate([-over_R * np.eye(3)[self.index], skew(place)[self.index]])


register_each(_OfSphere, ((f"o{axis}", f"o_{axis}", f"centre of the sphere in {axis}, in radii", colour)
                          for axis, colour in zip("xyz", (BLUE, VERMILION, GREEN))))
