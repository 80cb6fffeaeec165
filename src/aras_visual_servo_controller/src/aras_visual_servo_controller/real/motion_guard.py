"""The last limits before the arm: speed, acceleration, joint positions, and the box that the camera stays in."""

from math import inf
from typing import Any, Tuple

import numpy as np

from aras_visual_servo import RealSettings, accelerated, position_factor, velocity_factor


class MotionGuard:
    """Limits the wanted joint velocities to allowed ones.

    Args: kinematics: `Kinematics`.  settings: `RealSettings`.
    """

    def __init__(self, kinematics: Any, settings: RealSettings) -> None:
        self._kinematics = kinematics
        self._speed = settings.largest_speed(kinematics)
        self._most = settings.joint_acceleration
        self._acceleration = np.full(len(kinematics.joint_names), self._most)
        self._box = settings.workspace

    def velocity(self, q: np.ndarray, before: np.ndarray, wanted: np.ndarray, dt_s: float
                 ) -> Tuple[np.ndarray, str, bool]:
        """Velocities for the next period.

        Args: q: (n,) set-points now.  before: (n,) velocities of the last period.  wanted: (n,).  dt_s: period.
        Returns: ((n,) velocities, text about the cause of a slowdown or "", whether they were stopped by a limit of
            positions).
        """
        factor = velocity_factor(wanted, self._speed)
        q_dot = accelerated(before, wanted * factor, self._acceleration * dt_s)
        text = f"slowed to {factor:.2f} of the speed by real.speed_part or real.joint_speed" if factor < 1.0 else ""
        room, joint = position_factor(q, q_dot, self._kinematics.lower, self._kinematics.upper, 2.0 * dt_s)
        if joint is not None:
            q_dot, text = q_dot * room, f"joint '{self._kinematics.joint_names[joint]}' at its limit"
        left = self._leaves(q, q_dot, dt_s)
        if left:
            return np.zeros_like(q_dot), left, True
        return q_dot, text, joint is not None

    def clipped(self, q_dot: np.ndarray) -> np.ndarray:
        """(n,) velocities within the speed limits, all slowed by one factor."""
        return q_dot * velocity_factor(q_dot, self._speed)

    def _leaves(self, q, q_dot, dt_s):
        """Text if the camera would leave its box before it stands, going on with q_dot; "" if it may go on."""
        if self._box is None or not q_dot.any():
            return ""
        braking_s = 0.5 * float(np.abs(q_dot).max()) / self._most if self._most < inf else 0.0
        here = self._outside(q)
        there = self._outside(self._kinematics.moved(q, q_dot, dt_s + braking_s))
        # The way back into the box is free.
        if there <= 0.0 or there < here:
            return ""
        x, y, z = self._kinematics.pose(q)[:3, 3]
        lower, upper = (" ".join(f"{value:g}" for value in corner) for corner in (self._box.lower_m, self._box.upper_m))
        return f"workspace: the camera at {x:.3f} {y:.3f} {z:.3f} m would leave the box from {lower} to {upper} m"

    def _outside(self, q):
        """How far the camera is outside its box, 0 inside [m]."""
        return self._box.outside_m(self._kinematics.pose(q)[:3, 3])
