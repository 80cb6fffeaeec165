"""Views of the toy target from seeded, tilted poses, and central differences over camera motions."""

import numpy as np
from toy_plant import Camera

from aras_visual_servo import Look, View
from aras_visual_servo.features import interaction


STEP = 3e-6
TOLERANCE = 1e-7
SIX = ("xn", "yn", "an", "sx", "sy", "alpha")
ROUNDING = 1e-11  # of centred moments of an outline away from the image centre, some hundred operations


def look_at(features, dt_s=0.0, plane=None, X_CgC=None, applied=None):
    """`Look` of these features."""
    return Look(View(features, plane), dt_s, X_CgC, applied)


def parallel(xn, yn):
    """L of a target parallel to the image, columns (vx, vy, vz, wz), (4, 4): the published eq. (16)."""
    return np.array([[-1.0, 0.0, 0.0, yn], [0.0, -1.0, 0.0, -xn], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, -1.0]])


def tilted_pose(seed):
    """Camera about 0.6 m above the target, tilted by up to 0.35 rad about x and y, anywhere about its axis."""
    rng = np.random.default_rng(seed)
    rx, ry = rng.uniform(-0.35, 0.35, 2)
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[:3, 3] = np.r_[rng.uniform(-0.05, 0.05, 2), rng.uniform(0.5, 0.7)]
    for twist in ([0, 0, 0, rx, 0, 0], [0, 0, 0, 0, ry, 0], [0, 0, 0, 0, 0, rng.uniform(-np.pi, np.pi)]):
        X = X @ exponential(twist, 1.0)
    return X


def exponential(twist, t):
    """Pose after a body twist held for t."""
    v, w = np.asarray(twist[:3], float), np.asarray(twist[3:], float)
    M = np.zeros((4, 4))
    M[:3, :3] = [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]
    M[:3, 3] = v
    X, term = np.eye(4), np.eye(4)
    for k in range(1, 40):
        term = term @ M * (t / k)
        X = X + term
    return X


def plane_of(X_WC):
    X_CW = np.linalg.inv(X_WC)
    return interaction.plane_from_pose(X_CW[:3, 2], X_CW[:3, 3])


def differences(function, X_WC, difference=np.subtract):
    """(k, 6) central differences of function(X_WC), one camera twist component at a time."""
    columns = []
    for axis in np.eye(6):
        ahead, behind = function(X_WC @ exponential(axis, STEP)), function(X_WC @ exponential(axis, -STEP))
        columns.append(np.atleast_1d(difference(ahead, behind)) / (2.0 * STEP))
    return np.array(columns).T


def assert_same(L, expected):
    for row, wanted in zip(np.atleast_2d(L), np.atleast_2d(expected)):
        np.testing.assert_allclose(row, wanted, rtol=0.0, atol=TOLERANCE * np.abs(wanted).max())


def view(X_WC, outline=None, plane=None):
    camera = Camera(None) if outline is None else Camera(None, outline)
    camera.star = (0.6, 0.03)
    return View(camera.features(X_WC), plane)


def parallel_pose(angle=0.4):
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0, 0, 0, 0, 0, angle], 1.0)
    X[:3, 3] = [0.05, -0.03, 0.6]
    return X
