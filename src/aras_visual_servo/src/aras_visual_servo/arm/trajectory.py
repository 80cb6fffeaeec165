"""Joint trajectories: all joints start and stop together, at rest at both ends."""

import numpy as np


class JointTrajectory:
    """Quintic from q0 to q1: s(u) = 10 u^3 - 15 u^4 + 6 u^5, u = t / duration; s_dot <= 1.875, s_ddot <= 5.7735."""

    PEAK_VELOCITY = 1.875
    PEAK_ACCELERATION = 10.0 / 3.0**0.5

    def __init__(self, kinematics, q0, q1, max_velocity, max_acceleration, min_duration_s=0.1):
        """Plan it.

        Args:
            kinematics: knows `way` and `moved`: straight in the joints of an arm, a screw for a free camera.
            q0, q1: (n,).  max_velocity: (n,) > 0 or inf [m/s, rad/s].  max_acceleration: > 0 [m/s^2, rad/s^2].
        """
        self._q0, self._way, self._q1, self._space = q0, kinematics.way(q0, q1), q1, kinematics
        way = np.abs(self._way)
        self.duration_s = max(
            min_duration_s,
            self.PEAK_VELOCITY * float((way / max_velocity).max()),
            (self.PEAK_ACCELERATION * float(way.max()) / max_acceleration) ** 0.5,
        )

    def position(self, t_s):
        """(n,) positions t_s after the start; the ends before and after."""
        if t_s >= self.duration_s:
            return self._q1
        u = max(0.0, t_s / self.duration_s)
        return self._space.moved(self._q0, self._way, u * u * u * (10.0 + u * (6.0 * u - 15.0)))

    def velocity(self, t_s, hold_s):
        """(n,) velocity that, held for hold_s > 0 from t_s on, ends where the trajectory then is."""
        return self.step(t_s, hold_s)[1]

    def step(self, t_s, hold_s):
        """((n,), (n,)): `position` and `velocity` together."""
        here = self.position(t_s)
        return here, self._space.way(here, self.position(t_s + hold_s)) / hold_s
