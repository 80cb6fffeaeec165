"""Spaces that the starts of a sweep are drawn from: each turns numbers into a displacement X_CgC of the camera.

Space camera is a box along the axes of the goal camera; ball lies within a distance and an angle of the goal,
uniformly; view is over the places of the image where the whole target is seen. Space joint draws joint positions: see
plan.
"""

from math import acos, cos, pi, sin
from typing import Dict, Sequence, Tuple

import numpy as np

from aras_visual_servo import BALL_AXES, CAMERA_AXES, Outline, ParameterError, Scenario, spatial

#: At u, v = +-1 the target keeps this distance from the border of the image, since one that touches it is not measured
#: [px].
VIEW_MARGIN_PX = 2.0
#: In space view, image and target count as parallel at the goal if they are tilted by less than this [rad].
PARALLEL_RAD = 0.01


def pose_of(offset: Dict[str, float]) -> np.ndarray:
    """X_CgC, (4, 4), of a displacement along and a rotation vector about CAMERA_AXES; missing axes are 0."""
    delta = np.array([offset.get(axis, 0.0) for axis in CAMERA_AXES])
    return spatial.transform(spatial.rotation(delta[3:]), delta[:3])


def offset_of(X: np.ndarray) -> Dict[str, float]:
    """The displacement of X_CgC as a dict by axis: the inverse of `pose_of`."""
    return dict(zip(CAMERA_AXES, [*X[:3, 3].tolist(), *spatial.rotation_vector(X[:3, :3]).tolist()]))


def in_ball(ranges: Dict[str, Tuple[float, float]], place: np.ndarray) -> Dict[str, float]:
    """Displacement by axis of CAMERA_AXES: position and rotation vector are each uniform in a ball or hollow ball.

    Args: ranges: BALL_AXES -> (least, most).  place: (6,) in the unit cube.
    """
    parts = []
    for (low, high), (a, b, c) in zip((ranges[axis] for axis in BALL_AXES), (place[:3], place[3:])):
        radius = (low ** 3 + a * (high ** 3 - low ** 3)) ** (1.0 / 3.0)
        polar, azimuth = acos(1.0 - 2.0 * b), 2.0 * pi * c
        parts += [radius * sin(polar) * cos(azimuth), radius * sin(polar) * sin(azimuth), radius * cos(polar)]
    return dict(zip(CAMERA_AXES, map(float, parts)))


class View:
    """Space view of a scenario.

    Args: scenario: `Scenario`.  X_WCg: (4, 4) pose of the camera at the goal.
    Raises: ParameterError: there is no flat target of known outline, or it is not parallel to the image at the goal.
    """

    def __init__(self, scenario: Scenario, X_WCg: np.ndarray) -> None:
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

    def offset(self, point: Dict[str, float]) -> Dict[str, float]:
        """Displacement of the camera, dict by axis, from which the target is seen at this place of the image.

        Args:
            point: dict of u, v: place of the box around the outline, -1 at the left or upper border of the image and 1
                at the right or lower one; depth_m: of the target; rz_rad: turn of the camera about its axis.
        Raises: ParameterError: the target does not fit into the image at that depth.
        """
        R = spatial.rotation(np.array([0.0, 0.0, point["rz_rad"]]))
        depth_m = point["depth_m"]
        outline = (self._points @ R)[:, :2] / depth_m  # R^T times every point
        least, most = -self._half - outline.min(axis=0), self._half - outline.max(axis=0)
        if not (least < most).all():
            raise ParameterError(f"target does not fit into the image: at depth {depth_m:.3g} m")
        part = 0.5 * (1.0 + np.array([point["u"], point["v"]]))
        x, y = least + part * (most - least)
        return offset_of(spatial.transform(R, self._X_CgT[:3, 3] - R @ (depth_m * np.array([x, y, 1.0]))))


def tilted_goal(point: Dict[str, float], t_C: np.ndarray, normal_C: Sequence[float]) -> Tuple[np.ndarray, np.ndarray]:
    """Pose of a goal camera that is moved on a sphere about the target and sees it in the same place of the image.

    Args:
        point: dict of tilt_rad: by how much, and about_rad: about which axis in the image plane (0: x, pi/2: y).
        t_C: (3,) position of the target in the goal camera [m].  normal_C: (3,) its normal there.
    Returns: (X_CgCn, normal): pose of the new camera Cn in the old one, and the normal of the target in Cn, (3,).
    """
    R = spatial.rotation(point["tilt_rad"] * np.array([cos(point["about_rad"]), sin(point["about_rad"]), 0.0]))
    return spatial.transform(R, np.asarray(t_C) - R @ np.asarray(t_C)), np.asarray(normal_C, dtype=float) @ R
