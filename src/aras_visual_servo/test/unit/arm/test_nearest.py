"""How near the camera comes to a pose, against SciPy's bounded least squares, which shares no code with it."""

import numpy as np
import pytest
from scipy.optimize import least_squares
from toy_plant import GOAL, arm

from aras_visual_servo import spatial
from aras_visual_servo.arm.nearest import LENGTH_M, nearest

ARM = arm()
HOME = ARM.vector(GOAL)
LOWER, UPPER = ARM.lower + 0.01, ARM.upper - 0.01
#: Both searches end where a step changes nothing any more: they agree to this.
SAME_M = 2e-4
TILT_FREE = np.eye(6)[[0, 1, 2, 5]]


def moved(x, y, z):
    X = ARM.pose(HOME)
    X[:3, 3] += x, y, z
    return X


def least_missing(X_BC, counts=(1.0,) * 6):
    """(m, rad) by SciPy, from HOME. Args: counts: weight of each component."""
    def off(q):
        X = np.linalg.solve(ARM.pose(q), X_BC)
        return counts * np.concatenate([X[:3, 3] / LENGTH_M, spatial.rotation_vector(X[:3, :3])])

    best = least_squares(off, HOME, bounds=(LOWER, UPPER), xtol=1e-13, ftol=1e-13, gtol=1e-13, max_nfev=500)
    return LENGTH_M * np.linalg.norm(best.fun[:3]), np.linalg.norm(best.fun[3:])


@pytest.mark.parametrize("way", [(0.03, 0.5, 0.0), (0.0, -1.2, 0.0), (-0.05, 0.0, 0.15)])
def test_a_pose_within_reach_is_reached(way):
    found = nearest(ARM, moved(*way), HOME, LOWER, UPPER)
    assert found.within(1e-5, 1e-5)
    assert np.allclose(ARM.pose(found.q), moved(*way), atol=1e-5)


@pytest.mark.parametrize("way", [(0.15, 0.0, 0.0), (0.3, 0.2, 0.0), (0.0, 1.7, 0.0), (0.0, 0.0, -0.3),
                                 (-0.2, -1.6, 0.0)])
def test_out_of_reach_it_is_as_near_as_can_be(way):
    found = nearest(ARM, moved(*way), HOME, LOWER, UPPER, steps=300)
    least_m, least_rad = least_missing(moved(*way))
    assert found.sizes[0] == pytest.approx(least_m, abs=SAME_M) and least_m > 0.005
    assert found.sizes[1] == pytest.approx(least_rad, abs=1e-3)
    assert (LOWER <= found.q).all() and (found.q <= UPPER).all()
    X = np.linalg.solve(ARM.pose(found.q), moved(*way))
    assert np.allclose(found.missing, [*X[:3, 3], *spatial.rotation_vector(X[:3, :3])])


def test_what_does_not_count_is_free():
    """The camera comes nearer with any tilt than straight down."""
    X = moved(0.15, 0.0, 0.0)
    least_m, _ = least_missing(X, np.array([1.0, 1.0, 1.0, 0.0, 0.0, 1.0]))
    found = nearest(ARM, X, HOME, LOWER, UPPER, TILT_FREE, steps=200)
    assert found.sizes[0] == pytest.approx(least_m, abs=SAME_M) and not found.missing[[3, 4]].any()
    assert least_m < nearest(ARM, X, HOME, LOWER, UPPER).sizes[0] - 0.002
