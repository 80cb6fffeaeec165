"""Friction compensation: keeps joints that creep against dry friction from holding an error near the goal.

A position controller that pushes a joint against dry friction rests with its set-point ahead of the joint, by the lag
F / p. Its integral works that lag off, and so the joint creeps, by i/p of the lag per second. The law only sees an
error of creep / lambda that stays (T62). But the joints tell what the law cannot see: how far the camera really moved,
beside how far it was told to. The difference is worked off at `creep_rate_per_s`.

Far from the goal this difference is the delay of the arm, which is not to be corrected, so it counts from near the goal
on. It is bounded, so that a joint that sticks does not shoot ahead when it comes free.
"""

import numpy as np

#: The correction is no faster than this [m/s; rad/s]: the creep of dry friction five times that of the shipped arm.
FASTEST = np.array([0.0003, 0.0003, 0.0003, 0.003, 0.003, 0.003])


class CreepCompensation:
    """What the camera was told to do near the goal, less what it did.

    Attributes:
        twist: (6,) the correction last given, [v; w] [m/s; rad/s].
    """

    def __init__(self, rate_per_s):
        """Args: rate_per_s: of working the difference off, 0: never."""
        from .._kinematics import between  # C++: not needed to describe the settings of the servo
        self._rate_per_s, self._between = rate_per_s, between
        self._most = FASTEST / rate_per_s if rate_per_s > 0.0 else FASTEST
        self._X_BC, self._off, self.twist = None, np.zeros(6), np.zeros(6)

    def clear(self):
        """Begin anew with the next image."""
        if self._X_BC is not None:
            self._X_BC, self._off, self.twist = None, np.zeros(6), np.zeros(6)

    def correction(self, twist, X_BC, dt_s):
        """`twist` of this image.

        Args: twist: (6,) V_C that is asked for beside the correction, for the next dt_s.  X_BC: (4, 4) by the joints.
        """
        if self._rate_per_s == 0.0:
            return self.twist
        if self._X_BC is not None:
            off = self._off - self._between(self._X_BC, X_BC)
            self._off = np.minimum(np.maximum(off, -self._most), self._most)
            self.twist = self._rate_per_s * self._off
        self._off = self._off + dt_s * twist
        self._X_BC = X_BC
        return self.twist
