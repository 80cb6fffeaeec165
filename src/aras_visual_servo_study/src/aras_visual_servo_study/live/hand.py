"""Joints driven by hand: set-points that walk to where a slider is, no faster than a part of the joints' speed."""

import numpy as np

from aras_visual_servo import ParameterError

#: Part of the joints' velocity limits that is used, and the speed of joints without one [m/s or rad/s].
SPEED_PART, SPEED = 0.2, 0.5


class Hand:
    """Where the sliders of a page want the joints."""

    def __init__(self, kinematics):
        self._kinematics = kinematics
        fastest = np.where(np.isfinite(kinematics.velocity), SPEED_PART * kinematics.velocity, SPEED)
        self._speed = dict(zip(kinematics.joint_names, np.minimum(fastest, SPEED)))
        self._wanted, self._at, self._last_ns = {}, {}, None

    def hold(self, name, position, loop):
        """Drive a joint to a position. Raises ParameterError: there is no such joint, or it cannot be there."""
        names = self._kinematics.joint_names
        if name not in names:
            raise ParameterError(f"joint.name: found '{name}', allowed {', '.join(names)}")
        i = names.index(name)
        low, high = self._kinematics.lower[i], self._kinematics.upper[i]
        if not low <= position <= high:
            raise ParameterError(f"joint.position of {name}: found {position:g}, allowed {low:g} to {high:g}")
        if name not in self._at:
            self._at[name] = float(dict(zip(loop.sim.joint_names, loop.sim.joint_positions))[name])
        self._wanted[name] = position

    @property
    def busy(self):
        """Whether a joint is on its way."""
        return bool(self._wanted)

    def let_go(self):
        """Forget all of it."""
        self._wanted, self._at = {}, {}

    def drive(self, loop, stamp_ns):
        """After each image: the set-points walk on."""
        dt_s = 0.0 if self._last_ns is None else min(0.1, 1e-9 * (stamp_ns - self._last_ns))
        self._last_ns = stamp_ns
        if not self._wanted or dt_s <= 0.0:
            return
        positions = {}
        for name, wanted in list(self._wanted.items()):
            way, most = wanted - self._at[name], self._speed[name] * dt_s
            self._at[name] += max(-most, min(most, way))
            positions[name] = self._at[name]
            if self._at[name] == wanted:
                del self._wanted[name]
        loop.sim.set_command(position=positions, velocity=dict.fromkeys(positions, 0.0), stamp_ns=stamp_ns)
