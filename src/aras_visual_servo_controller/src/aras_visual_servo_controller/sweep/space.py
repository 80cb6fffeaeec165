"""Where the runs of a sweep start, by space: from numbers in the unit cube to a displacement X_CgC of the camera.

camera: a box along the goal camera's axes. ball: within a distance and an angle of the goal, uniformly. view: where the
target appears in the image, over all of it that shows it whole. (Space joint needs no displacement: sweep_plan.)
"""

from math import acos, cos, pi, sin

import numpy as np

from ..ground.errors import ParameterError
from ..scenario.sweep import BALL_AXES, CAMERA_AXES
from ..target.outline import Outline
from ..arm.reach import rotation, rotation_vector

#: u = +-1 leaves this much of the image between target and border: a target that touches it is not measured [px].
VIEW_MARGIN_PX = 2.0
#: Space view: the image at the goal counts as parallel to the target below this angle [rad].
PARALLEL_RAD = 0.01


def pose_of(offset):
    """X_CgC, (4, 4), of a displacement by axis of CAMERA_AXES (rotation vector); missing axes are 0."""
    delta = np.array([offset.get(axis, 0.0) for axis in CAMERA_AXES])
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation(delta[3:]), delta[:3]
    return X


def offset_of(X):
    """The inverse of `pose_of`: dict by axis."""
    return dict(zip(CAMERA_AXES, [*X[:3, 3].tolist(), *rotation_vector(X[:3, :3]).tolist()]))


def in_ball(ranges, place):
    """Displacement within a distance and an angle of the goal, as by axis of CAMERA_AXES.

    Args:
        ranges: BALL_AXES -> (least, most).  place: (6,) in the unit cube.
    Returns:
        dict; position and rotation vector are each uniform in their (hollow) ball.
    """
    parts = []
    for (low, high), (a, b, c) in zip((ranges[axis] for axis in BALL_AXES), (place[:3], place[3:])):
        radius = (low ** 3 + a * (high ** 3 - low ** 3)) ** (1.0 / 3.0)
        polar, azimuth = acos(1.0 - 2.0 * b), 2.0 * pi * c
        parts += [radius * sin(polar) * cos(azimuth), radius * sin(polar) * sin(azimuth), radius * cos(polar)]
    return dict(zip(CAMERA_AXES, map(float, parts)))


class View:
    """Space view of a scenario.

    Args:
        scenario: `Scenario`.  X_WCg: (4, 4) pose of the camera at the goal.
    Raises:
        ParameterError: no flat target of known outline, or it is not seen parallel at the goal.
    """

    def __init__(self, scenario, X_WCg):
        outline = Outline.of(scenario)
        if outline is None:
            raise ParameterError("sweep.space: found view, which needs a flat target of known outline and a camera "
                                 "without fisheye lens")
        self._X_CgT = np.linalg.solve(X_WCg, outline.X_WT)
        tilt = acos(min(1.0, abs(float(self._X_CgT[2, 2]))))
        if tilt > PARALLEL_RAD:
            raise ParameterError(f"sweep.space: found view with the target tilted by {tilt:.3g} rad at the goal, "
                                 f"allowed <= {PARALLEL_RAD}")
        self._points = outline.points_T @ self._X_CgT[:3, :3].T
        px = 2.0 * outline.half[0] / scenario.sim["cameras"][0]["width"]
        self._half = np.array(outline.half) - VIEW_MARGIN_PX * px

    def offset(self, point):
        """Displacement of the camera, dict by axis, at which the target is seen there.

        Args:
            point: u, v: place of the outline's box in the room the image leaves it, -1 at the left or upper border, 1
                at the right or lower one.  depth_m.  rz_rad: turn of the camera about its axis.
        Raises:
            ParameterError: the target does not fit into the image at that depth.
        """
        R = rotation(np.array([0.0, 0.0, point["rz_rad"]]))
        depth_m = point["depth_m"]
        outline = (self._points @ R)[:, :2] / depth_m  # R^T of every point
        least, most = -self._half - outline.min(axis=0), self._half - outline.max(axis=0)
        if not (least < most).all():
            raise ParameterError(f"target does not fit into the image: at depth {depth_m:.3g} m")
        part = 0.5 * (1.0 + np.array([point["u"], point["v"]]))
        x, y = least + part * (most - least)
        X = np.eye(4)
        X[:3, :3] = R
        X[:3, 3] = self._X_CgT[:3, 3] - R @ (depth_m * np.array([x, y, 1.0]))
        return offset_of(X)


def tilted_goal(point, t_C, normal_C):
    """The goal camera moved on a sphere about the target, which it keeps in the same place of the image.

    Args:
        point: tilt_rad, about_rad: by how much, and about which axis of the image plane (0: x, pi/2: y).
        t_C: (3,) target in the goal camera [m].  normal_C: (3,) its normal there.
    Returns:
        (X_CgCn, normal (3,) in Cn): the new camera in the old one.
    """
    R = rotation(point["tilt_rad"] * np.array([cos(point["about_rad"]), sin(point["about_rad"]), 0.0]))
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, np.asarray(t_C) - R @ np.asarray(t_C)
    return X, np.asarray(normal_C, dtype=float) @ R
