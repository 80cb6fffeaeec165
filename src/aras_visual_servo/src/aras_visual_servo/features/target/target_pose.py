"""Pose of a known planar target from the moments of its image: least squares by Gauss-Newton (docs/theory.md T24).

The ten measures of an image are x_g/sqrt(a), y_g/sqrt(a), ln(sqrt(a)) and mu_ij / a^((i+j+2)/2) to third order.
"""

from math import log
from typing import Any, Sequence, Tuple

import numpy as np

from ...ground.errors import DegenerateFeature
from ...spatial import exponential
from ..interaction import centroid_rows
from .points_pose import gauss_newton

ORDER = 4  # of the predicted moments: rows of third order need it
_I, _J = np.array([(i, k - i) for k in (2, 3) for i in range(k, -1, -1)]).T
_NAMES = [f"{i}{j}" for i, j in zip(_I, _J)]
_HALF_DEGREE = 0.5 * (_I + _J + 2)
_DIVISORS = np.arange(1, ORDER + 2)[:, None]
#: Gauss-Legendre nodes of [0, 1]; three are exact for polynomials of degree 5, what order 4 asks for.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
#: Largest residual of a measure at which a pose is accepted, in a first view and while it is followed. In a first view,
#: coverage images of the right target leave 2e-5, those of another of our targets at least 4e-3.
MAX_FOUND, MAX_FOLLOWED = 1e-3, 0.05
FOLLOW_STEPS = 5
#: A pose with a residual below this is taken without trying the other first guesses.
SURE = 1e-4
#: First guesses: the given normal and others tilted from it by this angle, each at this number of turns about the
#: normal.
GUESS_TILT_RAD, GUESS_TURNS = 0.35, 8
_BEHIND = "pose of the target: behind the camera"


class PlanarTarget:
    """A target whose outlines are known.

    Attributes: outlines_m: polygons, (n, 2) each, in the target's plane z = 0 [m].  max_followed: largest residual of a
    pose that `follow` may be taken at.
    """

    max_followed = MAX_FOLLOWED

    def __init__(self, outlines_m: Sequence[Any]) -> None:
        self.outlines_m = [np.asarray(outline, dtype=float) for outline in outlines_m]

    def moments(self, X_CT: np.ndarray) -> np.ndarray:
        """Raw moments m[i, j] to ORDER of the image from pose X_CT, (5, 5). Raises DegenerateFeature: behind it."""
        m = np.zeros((ORDER + 1, ORDER + 1))
        for outline in self.outlines_m:
            corners = outline @ X_CT[:3, :2].T + X_CT[:3, 3]
            if not corners[:, 2].min() > 0.0:
                raise DegenerateFeature(_BEHIND)
            p = corners[:, :2] / corners[:, 2:]
            way = np.concatenate([p[1:], p[:1]]) - p
            x, y = (p[:, k, None] + way[:, k, None] * _NODES for k in (0, 1))
            power_y = np.empty((ORDER + 1, x.size))
            power_x = np.empty((ORDER + 1, x.size))
            power_y[0], power_x[0] = 1.0, (x * way[:, 1, None] * _WEIGHTS).ravel()
            x, y = x.ravel(), y.ravel()
            for k in range(1, ORDER + 1):
                power_x[k], power_y[k] = power_x[k - 1] * x, power_y[k - 1] * y
            part = (power_x @ power_y.T) / _DIVISORS
            m += part if part[0, 0] > 0.0 else -part  # seen from either side
        if not m[0, 0] > 0.0:
            raise DegenerateFeature("pose of the target: its image is empty")
        return m

    def predicted(self, X_CT: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Measures (10,) and their interaction matrix (10, 6) at pose X_CT."""
        m = self.moments(X_CT)
        a, m10, m01 = float(m[0, 0]), float(m[1, 0]), float(m[0, 1])
        xg, yg = m10 / a, m01 / a
        mu = _centred(m, xg, yg)
        n20, n11, n02 = float(mu[2, 0]) / a, float(mu[1, 1]) / a, float(mu[0, 2]) / a
        normal = X_CT[:3, 2]
        A, B, C = (normal / float(normal @ X_CT[:3, 3])).tolist()
        g = A * xg + B * yg + C
        L_area = np.array([-A, -B, 3.0 * g - C, 3.0 * yg, -3.0 * xg, 0.0])  # of ln(a)
        L_x, L_y = np.array(centroid_rows((xg, yg, n20, n11, n02), (A, B, C)))
        L_mu = _centred_rows(mu, xg, yg, n20, n11, n02, (A, B, C))
        root, scale = a**-0.5, a**-_HALF_DEGREE
        measures, L, seven = np.empty(10), np.empty((10, 6)), mu[_I, _J]
        measures[:3], measures[3:] = (xg * root, yg * root, 0.5 * log(a)), seven * scale
        L[0], L[1] = root * (L_x - 0.5 * xg * L_area), root * (L_y - 0.5 * yg * L_area)
        L[2] = 0.5 * L_area
        L[3:] = scale[:, None] * (L_mu - (_HALF_DEGREE * seven)[:, None] * L_area)
        return measures, L

    def improve(self, X_CT: np.ndarray, measured: np.ndarray) -> Tuple[np.ndarray, float, float]:
        """One Gauss-Newton step.

        Returns: (X_CT, largest residual of a measure before the step, condition number of the matrix).
        """
        measures, L = self.predicted(X_CT)
        return gauss_newton(X_CT, L, measured - measures)[:3]

    @staticmethod
    def measured(features: Any) -> np.ndarray:
        """`measures_of` an image."""
        return measures_of(features)

    def follow(self, X_CT: np.ndarray, measured: np.ndarray) -> Tuple[np.ndarray, float, float]:
        """`improve` once, and again, at most FOLLOW_STEPS times, while the pose before the step was far off."""
        for _ in range(FOLLOW_STEPS):
            X_CT, residual, condition = self.improve(X_CT, measured)
            if residual < MAX_FOUND:
                break
        return X_CT, residual, condition

    def find(self, features: Any, normal_C: Sequence[float], steps: int = 40) -> np.ndarray:
        """X_CT from a view alone and a guess of the plane's normal; `features` give z_star_m as a first depth.

        Beside the right pose a planar target has a second, wrong minimum. So several guesses are tried, and the best
        result is returned. A target of central symmetry has two poses, of which one is returned.
        Raises: DegenerateFeature: no pose explains the view.
        """
        measured, best, least = measures_of(features), None, MAX_FOUND
        t = features.z_star_m * np.array([features.xg, features.yg, 1.0])
        for X in _guesses(np.asarray(normal_C, dtype=float), t):
            try:
                for _ in range(steps):
                    X, residual, _ = self.improve(X, measured)
                    if residual < 1e-13:
                        break
            except (DegenerateFeature, np.linalg.LinAlgError):
                continue
            if residual < least and X[2, 2] < 0.0:
                best, least = X, residual
                if least < SURE:
                    return best
        if best is None:
            raise DegenerateFeature("pose of the target: no pose of the known outline explains this view")
        return best


def _guesses(normal_C, t):
    """Poses X_CT at t whose face looks at the camera: the plane's normal first, then tilted ones, each in all turns."""
    z = normal_C / np.linalg.norm(normal_C)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    face = np.eye(4)
    face[:3, :3] = np.stack([x, -np.cross(z, x), -z], axis=1)
    for tilt in ((0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)):
        tilted = face @ exponential(GUESS_TILT_RAD * np.array([0.0, 0.0, 0.0, *tilt, 0.0]))
        for turn in range(GUESS_TURNS):
            X = tilted @ exponential(np.array([0.0, 0.0, 0.0, 0.0, 0.0, 2.0 * np.pi * turn / GUESS_TURNS]))
            X[:3, 3] = t
            yield X


def measures_of(features: Any) -> np.ndarray:
    """The ten measures of an image's moments. Raises DegenerateFeature: a moment is missing or the object empty."""
    m, mu = dict(zip(features.moment_names, features.m)), dict(zip(features.moment_names, features.mu))
    try:
        a, centred = m["00"], np.array([mu[name] for name in _NAMES])
        if not a > 0.0:
            raise DegenerateFeature("pose of the target: the object is empty")
        return np.concatenate([[m["10"] / a**1.5, m["01"] / a**1.5, 0.5 * log(a)], centred * a**-_HALF_DEGREE])
    except KeyError as error:
        raise DegenerateFeature(f"pose of the target: moment {error} is missing") from None


def _centred(m, xg, yg):
    """mu[i, j] to ORDER of raw moments m[i, j]: shifting the origin is one matrix for x and one for y."""
    return _shift(xg) @ m @ _shift(yg).T


def _shift(offset):
    """S[i, k] = binomial(i, k) (-offset)^(i-k)."""
    return _BINOMIAL * (-offset) ** _EXPONENT


_EXPONENT = np.maximum(np.subtract.outer(np.arange(ORDER + 1), np.arange(ORDER + 1)), 0)
_BINOMIAL = np.array([[1.0, 0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0, 0.0], [1.0, 2.0, 1.0, 0.0, 0.0],
                      [1.0, 3.0, 3.0, 1.0, 0.0], [1.0, 4.0, 6.0, 4.0, 1.0]])


def _centred_rows(mu, xg, yg, n20, n11, n02, plane):
    """L of mu_ij (T7) for the seven of second and third order at once, (7, 6)."""
    (A, B, C), flat, rows = plane, mu.ravel().tolist(), []
    for i, j, half, places in _CASES:
        here, to_j, to_i, down_i, down_j, up_j, up_i = [flat[place] * factor for place, factor in places]
        wx = up_j + xg * to_j + (i + 2.0 * j + 3.0) * (yg * here) - (4.0 * n11) * down_i - (4.0 * n02) * down_j
        wy = (4.0 * n20) * down_i + (4.0 * n11) * down_j - up_i - (2.0 * i + j + 3.0) * (xg * here) - yg * to_i
        rows.append(((-A) * ((i + 1.0) * here) - B * to_j, (-A) * to_i - B * ((j + 1.0) * here),
                     B * wx - A * wy + (2.0 * C) * (half * here), wx, wy, to_j - to_i))
    return np.array(rows)


#: The terms of (T7), as places in the flattened mu and factors: mu_ij, i mu_{i-1,j+1}, j mu_{i+1,j-1}, i mu_{i-1,j},
#: j mu_{i,j-1}, k mu_{i,j+1}, k mu_{i+1,j} with k = i + j + 3. Where an index would be -1 the factor i or j is 0, so
#: that any place will do.
_DOWN_I, _DOWN_J = np.maximum(_I - 1, 0), np.maximum(_J - 1, 0)
_TERMS = (ORDER + 1) * np.array([_I, _DOWN_I, _I + 1, _DOWN_I, _I, _I, _I + 1]) + np.array(
    [_J, _J + 1, _DOWN_J, _J, _DOWN_J, _J + 1, _J])
_FACTORS = np.array([np.ones(7), _I, _J, _I, _J, _I + _J + 3, _I + _J + 3], dtype=float)
_CASES = [(float(i), float(j), float(half), tuple(zip(_TERMS[:, k].tolist(), _FACTORS[:, k].tolist())))
          for k, (i, j, half) in enumerate(zip(_I, _J, _HALF_DEGREE))]
