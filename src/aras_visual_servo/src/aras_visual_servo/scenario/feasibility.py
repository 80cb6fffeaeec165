"""Checks before anything moves whether a run can be done at all, by kinematics and the target's outline. No ROS.

A run is refused, with its reason, when goal or start are outside joint limits, when the image does not show the whole
target at the goal or at the start (unless the servo works on keypoints, for which a part is enough), or when the wrist
would have to pass its limits because the shorter turn home leads beyond them.
"""

from math import pi
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..arm.real import RealSettings
from ..ground.errors import ParameterError
from ..features.sources.base import source_named
from ..features.target.outline import Outline
from ..arm.reach import outside_limits

if TYPE_CHECKING:
    from .scenario import Scenario

#: The target counts as not in view when it is cut by more than this [px]; when it is cut by less, the image decides.
CUT_PX = 1.0
#: The last joint turns the camera about its optical axis when both axes agree this nearly (cosine, distance).
ALIGNED, ON_AXIS_M = 0.999, 1e-6
#: The last joint alone turns the camera home when the others add less than this part of a full turn.
OTHERS_TURN = 0.02


def check_feasible(scenario: "Scenario") -> None:
    """Raises ParameterError, naming the reason, if the scenario's experiment cannot be done as it stands."""
    kinematics = scenario.kinematics()
    source = scenario.servo.get("source")
    whole = not source or not source_named(source).sees_parts
    feasibility = Feasibility(scenario, kinematics, look=whole)
    refusal = feasibility.refusal(scenario.goal_posture(kinematics), scenario.start_posture(kinematics))
    if refusal:
        raise ParameterError(f"scenario '{scenario.name}' refused, nothing has moved: {refusal}")


def check_workspace(scenario: "Scenario") -> None:
    """Raises ParameterError, naming each, if the camera is outside `real.workspace` at goal or start: the arm would
    brake before it gets there."""
    kinematics = scenario.kinematics()
    box = RealSettings.from_dict(scenario.real, kinematics.joint_names).workspace
    if box is None:
        return
    faults = []
    for place, joints in (("goal", scenario.goal_posture(kinematics)), ("start", scenario.start_posture(kinematics))):
        position = kinematics.pose(joints)[:3, 3]
        if box.outside_m(position) > 0.0:
            x, y, z = position
            faults.append(f"real.workspace: found the camera at the {place} at {x:.3f} {y:.3f} {z:.3f} m, allowed "
                          f"between lower_m {list(box.lower_m)} and upper_m {list(box.upper_m)}")
    if faults:
        raise ParameterError(faults)


class Feasibility:
    """Checks the feasibility of goals and starts of one scenario.

    Attributes:
        outline: `Outline`, None where the target's place in the image cannot be told beforehand.
    """

    def __init__(self, scenario: "Scenario", kinematics: RobotKinematics, look: Any = True) -> None:
        """Args: scenario: `Scenario`. kinematics: `Kinematics` of its robot. look: check the target's outline too."""
        self._kinematics, self._look = kinematics, look
        self.outline = Outline.of(scenario)

    def refusal(self, goal: np.ndarray, start: np.ndarray) -> str:
        """Why a run cannot be done, "REASON: detail"; "" if it can be done as far as these checks tell.

        Args: goal, start: (n,) joint positions.
        """
        by_name = self._kinematics.by_name
        for place, joints in (("goal ", goal), ("", start)):
            fault = outside_limits(self._kinematics, by_name(np.asarray(joints, dtype=float)))
            if fault:
                return place + fault
        for place, joints in (("at the goal", goal), ("at the start", start)):
            if self._look and self.outline is not None:
                border_px = self.outline.border_px(self._kinematics.pose(joints))
                if border_px < -CUT_PX:
                    behind = border_px == -np.inf
                    how = "behind the camera" if behind else f"beyond the image border by {-border_px:.0f} px"
                    return f"target not in view {place}: {how}"
        return self._wound_up(np.asarray(goal, dtype=float), np.asarray(start, dtype=float))

    def _wound_up(self, goal, start):
        """Why the last joint cannot do the turn home: the servo turns the camera the shorter way round, and that may
        lead beyond the joint's limits."""
        last, sign = self._wrist()
        if last is None:
            return ""
        name = self._kinematics.joint_names[last]
        lower, upper = self._kinematics.lower[last], self._kinematics.upper[last]
        X = np.linalg.solve(self._kinematics.pose(start), self._kinematics.pose(goal))
        turn = float(np.arctan2(X[1, 0] - X[0, 1], X[0, 0] + X[1, 1])) * sign
        turns_more = (goal[last] - start[last] - turn) / (2.0 * pi)
        if abs(turns_more - round(turns_more)) > OTHERS_TURN:
            return ""  # other joints turn the camera too, and may take over
        end = goal[last] - 2.0 * pi * round(turns_more)
        if lower <= end <= upper:
            return ""
        return (f"goal posture outside joint limits after the shorter turn: {name} would end at {end:.4g}, not in "
                f"[{lower:.4g}, {upper:.4g}]")

    def _wrist(self):
        """(index of the joint that turns the camera about its own axis, its sign), (None, 0) if there is none."""
        J = self._kinematics.jacobian(np.linspace(0.2, 0.5, len(self._kinematics.joint_names)))  # nothing in line
        for i in range(J.shape[1]):
            if abs(J[5, i]) > ALIGNED and float(np.abs(J[:3, i]).max()) < ON_AXIS_M:
                return i, float(np.sign(J[5, i]))
        return None, 0.0
