"""Set-points for robots that take one number per joint controller, as ros_control does: velocities are integrated here.
No ROS."""

from typing import Dict, Sequence

import numpy as np
from aras_visual_servo import Command


class SetPointIntegrator:
    """Turns commands (positions and velocities by joint name) into set-points, step by step.

    A controller that takes only positions gets the integral of the commanded velocities. Nothing moves before the first
    command: the set-point of a joint starts at its measured position.

    Args:
        joint_names: n names.  lower, upper: (n,) limits of the set-points [m or rad], +-inf where there is none.
        timeout_ns: age at which a velocity stops acting [ns].
    """

    def __init__(self, joint_names: Sequence[str], lower: np.ndarray, upper: np.ndarray, timeout_ns: int) -> None:
        self._names = tuple(joint_names)
        self._limits = {name: (float(low), float(high)) for name, low, high in zip(self._names, lower, upper)}
        self._timeout_ns = timeout_ns
        self._set_points = {}
        self._velocities = {}
        self._command_ns = 0
        self._time_ns = None

    def reset(self) -> None:
        """Forget set-points, velocities and time."""
        self._set_points, self._velocities, self._time_ns = {}, {}, None

    def command(self, command: Command, q: np.ndarray) -> None:
        """Take a command.

        Args: command: `Command`; a joint in neither of its parts stops.  q: (n,) measured positions [m or rad].
        """
        for name, position in zip(self._names, np.asarray(q, dtype=float)):
            self._set_points.setdefault(name, float(position))
        self._set_points.update((name, self._clamp(name, position)) for name, position in command.position.items())
        self._velocities = dict(command.velocity)
        self._command_ns = command.stamp_ns

    def advance(self, time_ns: int) -> Dict[str, float]:
        """Set-points at a time: dict of joint name -> set-point [m or rad]; {} before the first command."""
        last_ns, self._time_ns = self._time_ns, time_ns
        if last_ns is not None and self._velocities:
            end_ns = min(time_ns, self._command_ns + self._timeout_ns)
            dt_s = max(end_ns - last_ns, 0) * 1e-9
            for name, velocity in self._velocities.items():
                self._set_points[name] = self._clamp(name, self._set_points[name] + velocity * dt_s)
        return dict(self._set_points)

    def _clamp(self, name, position):
        lower, upper = self._limits[name]
        return min(max(position, lower), upper)
