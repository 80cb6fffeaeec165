"""Joints driven by hand: set-points that walk to where a slider is, no faster than a part of the joints' speed."""

from typing import Dict

import numpy as np

from aras_visual_servo import Kinematics, ParameterError

#: Part of the joints' velocity limits that is used, and the speed of joints without one [m/s or rad/s].
SPEED_PART, SPEED = 0.2, 0.5


class Hand:
    """Where the sliders of a page want the joints."""

    def __init__(self, kinematics: Kinematics):
        self._kinematics = kinematics
        fastest = np.where(np.isfinite(kinematics.velocity), SPEED_PART * kinematics.velocity, SPEED)
        self._speed = dict(zip(kinematics.joint_names, np.minimum(fastest, SPEED)))
        self._wanted, self._at, self._last_ns = {}, {}, None

    def hold(self, name: str, position: float, q: np.ndarray) -> None:
        """Drives a joint to a position, from q, (n,). Raises ParameterError: unknown joint, or outside its limits."""
        names = self._kinematics.joint_names
        if name not in names:
            raise ParameterError(f"joint.name: found '{name}', allowed {', '.join(names)}")
        i = names.index(name)
        low, high = self._kinematics.lower[i], self._kinematics.upper[i]
        if not low <= position <= high:
            raise ParameterError(f"joint.position of {name}: found {position:g}, allowed {low:g} to {high:g}")
        if name not in self._at:
            self._at[name] = float(q[i])
        self._wanted[name] = position

    @property
    def busy(self) -> bool:
        """Returns whether a joint is on its way."""
        return bool(self._wanted)

    def let_go(self) -> None:
        """Forgets all of it."""
        self._wanted, self._at = {}, {}

    def walk(self, stamp_ns: int) -> Dict[str, float]:
        """Moves the set-points on to this time. Returns those of the joints that are on their way [m or rad]."""
        dt_s = 0.0 if self._last_ns is None else min(0.1, 1e-9 * (stamp_ns - self._last_ns))
        self._last_ns = stamp_ns
        positions: Dict[str, float] = {}
        if dt_s <= 0.0:
            return positions
        for name, wanted in list(self._wanted.items()):
            way, most = wanted - self._at[name], self._speed[name] * dt_s
            self._at[name] += max(-most, min(most, way))
            positions[name] = self._at[name]
            if self._at[name] == wanted:
                del self._wanted[name]
        return positions
