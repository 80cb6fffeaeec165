"""Exact views of a tilted, asymmetric polygon, and central differences over the camera's motions: made once each."""
import functools

import numpy as np
import views
from toy_plant import OUTLINE, picture, polygon_moments
from views import exponential, tilted_pose

from aras_visual_servo.features.base import View
from aras_visual_servo.ground.types import Features

#: Of a row's largest entry: truncation and rounding of differences with views.STEP, see there.
DIFFERENCES = views.TOLERANCE
SEEDS = (1, 2, 3)
#: Of the moments that views have: rows of order 5 need one more.
ORDER = 6
#: Z* [m] and a* that the normalised features of these tests have.
Z_STAR, AREA_STAR = 0.6, 0.03


class Moments(dict):
    """Moments by (i, j). Those of negative order occur only multiplied by zero."""

    def __missing__(self, key):
        return 0.0


def moments_of(xy, order=ORDER):
    """(m, mu) of a polygon in the image: raw and centred moments."""
    m = polygon_moments(xy, order)
    mu = polygon_moments(xy, order, (m["10"] / m["00"], m["01"] / m["00"]))
    return tuple(Moments({(int(name[0]), int(name[1])): value for name, value in some.items()}) for some in (m, mu))


@functools.lru_cache(maxsize=None)
def pose(seed):
    """X_WC, (4, 4), of a tilted camera."""
    return tilted_pose(seed)


@functools.lru_cache(maxsize=None)
def seen(seed):
    """(m, mu, plane) of the outline from `pose(seed)`."""
    return (*moments_of(picture(pose(seed))), tuple(views.plane_of(pose(seed))))


def in_product(m, mu, plane, **more):
    """`View` of the product on these moments."""
    features = Features(moment_names=tuple(f"{i}{j}" for i, j in m), m=list(m.values()), mu=list(mu.values()),
                        area=m[0, 0], xg=m[1, 0] / m[0, 0], yg=m[0, 1] / m[0, 0], z_star_m=Z_STAR,
                        area_star=AREA_STAR, **more)
    return View(features, plane)


@functools.lru_cache(maxsize=None)
def slope(function, X, order=4, outline=None):
    """(k, 6) central differences of function(m, mu), the moments of the outline seen from X (bytes) as it moves."""
    corners = OUTLINE if outline is None else np.frombuffer(outline).reshape(-1, 2)

    def value(X):
        return function(*moments_of(picture(X, None, corners), order))

    return views.differences(value, np.frombuffer(X).reshape(4, 4))


def derivative(function, seed, order=4):
    """`slope` at pose(seed). The function must not depend on a formula under test."""
    return slope(function, pose(seed).tobytes(), order)


def rows_same(found, expected, tolerance=DIFFERENCES, what=""):
    """Fail where a row of `found`, (k, 6), is off by more than this part of the row's largest entry."""
    found, expected = np.atleast_2d(found), np.atleast_2d(expected)
    assert found.shape == expected.shape, f"{what}: shape {found.shape}, expected {expected.shape}"
    off = np.abs(found - expected).max(axis=1)
    assert (off <= tolerance * np.abs(expected).max(axis=1)).all(), f"{what}: found {found}, expected {expected}"


def moved(X, twist):
    """X after a body twist held for one second."""
    return X @ exponential(twist, 1.0)
