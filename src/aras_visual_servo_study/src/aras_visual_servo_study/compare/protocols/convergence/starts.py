"""Starts of the protocol `map`: by distance and angle they cover the map evenly, and each sees the whole target."""

import math
from typing import List

import numpy as np

from aras_visual_servo import Outline, ParameterError, Scenario, spatial
from ....sweep.plan import Start
from ....sweep.space import offset_of, pose_of
from ..base import halton

#: Ends of the map: distance of the start from the goal, and angle of its rotation.
MOST_M, MOST_RAD = 0.3, math.pi
SEED = 11
#: Half the sides of a rectangle about the target's origin that holds every target; a start sees all of it.
HALF_M = (0.12, 0.1)
#: Directions of the way and of the axis that are drawn for a start until it sees the target.
TRIES = 20_000


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The first `count` starts, list of `Start`; the first ones are the same, however many there are.

    Distances and angles are a Halton sequence. The direction of the way and the axis of the rotation are drawn
    uniformly until the image shows the whole rectangle HALF_M: at large angles the axis is therefore near the optical
    one. Raises ParameterError: no direction was found, because the camera does not see the target from there.
    """
    kinematics = scenario.kinematics(calibrated=False)
    X_WCg, outline = kinematics.pose(scenario.goal_posture(kinematics)), _rectangle(scenario)
    starts = []
    for number, (a, b) in enumerate(halton(count), start=1):
        X_CgC = _seeing(outline, X_WCg, MOST_M * a, MOST_RAD * b, np.random.default_rng([SEED, number]))
        joints = kinematics.by_name(kinematics.coordinates(X_WCg @ X_CgC))  # type: ignore[attr-defined]
        starts.append(Start(number, joints, offset_of(X_CgC)))
    return starts


def _seeing(outline, X_WCg, distance_m, angle_rad, rng):
    """X_CgC, (4, 4), of a camera that is this far away and turned by this angle, and sees the rectangle."""
    for _ in range(TRIES):
        way, axis = (v / np.linalg.norm(v) for v in rng.standard_normal((2, 3)))
        X = pose_of(dict(zip(("x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"),
                             [*distance_m * way, *angle_rad * axis])))
        if outline.border_px(X_WCg @ X) >= 0.0:
            return X
    raise ParameterError(f"map: found no start {distance_m:.3g} m away and turned by {angle_rad:.3g} rad that sees the "
                         f"target in {TRIES} tries")


def _rectangle(scenario):
    model, (x, y) = scenario.sim["scene"]["models"][0], HALF_M
    X_WT = spatial.pose_from_rpy(model["position_m"], model.get("rpy_rad", (0.0, 0.0, 0.0)))
    return Outline([[(-x, -y), (x, -y), (x, y), (-x, y)]], X_WT, scenario.sim["cameras"][0])
