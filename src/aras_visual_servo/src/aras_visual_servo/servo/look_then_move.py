"""Look then move: one image, one move of the set-points, wait until the arm rests, the next image (T15)."""

from math import inf

import numpy as np

from ..arm.limits import position_factor
from ..arm.trajectory import JointTrajectory

#: A look's displacement is followed in this many steps (the arm's Jacobian turns on the way), and this part of the tilt
#: is corrected by each look.
LOOK_STEPS, LOOK_TILT = 10, 0.9


class LookThenMove:
    """The moves of the set-points, one after the other.

    Attributes:
        set_point: (n,) joint set-points as commanded last, None until they are known.
        under_way: a move is not finished, or its joints have not settled.
    """

    def __init__(self, kinematics, arm, config):
        """Args: kinematics: `Kinematics`. arm: `ArmMotion`. config: `ServoSettings`."""
        self._kinematics, self._arm, self._config = kinematics, arm, config
        self.clear(None)

    def clear(self, set_point):
        """Forget the past. set_point: (n,) or None: the positions measured at the first look."""
        self.set_point = set_point
        self._move, self._begin_ns, self._followed_s, self._last_q = None, 0, 0.0, None

    def shift(self, way):
        """The set-points were moved by something else: way, (n,)."""
        if self.set_point is not None:
            self.set_point = self._kinematics.moved(self.set_point, way, 1.0)

    @property
    def under_way(self):
        """Whether the last move is not finished."""
        return self._move is not None

    def plan(self, stamp_ns, q, X_BC, twist, target_C):
        """Begin the move that one look asks for.

        Args:
            q: (n,) measured.  X_BC: (4, 4) pose of the camera there.  twist: V_C, (6,), of the law.
            target_C: (x, y, z) of the target if tilt is held, or None.
        Returns:
            (twist with tilt hold, manipulability, name of the joint that shortens the move or None).
        """
        motion, ahead = twist * self._config.sample_time_s, q
        for step in range(LOOK_STEPS):
            jacobian, inverse = self._arm.at(ahead)
            if step == 0:
                manipulability = inverse.manipulability
                if target_C is not None:
                    motion = motion + self._arm.tilt(X_BC, inverse, LOOK_TILT, target_C)
                twist = motion / self._config.sample_time_s
            q_dot = self._arm.unlimited(ahead, motion, inverse)
            turning = self._arm.turning(ahead, q_dot, jacobian, inverse, 1.0 / LOOK_STEPS)
            ahead = self._kinematics.moved(ahead, (q_dot + turning) / LOOK_STEPS, 1.0)
        if self.set_point is None:
            self.set_point = q
        wanted, shortened_by = self._kinematics.moved(self.set_point, self._kinematics.way(q, ahead), 1.0), None
        target = np.clip(wanted, self._arm.lower, self._arm.upper)
        if (target != wanted).any():  # shorten, so that the direction is kept
            way = wanted - self.set_point
            room, joint = position_factor(self.set_point, way, self._arm.lower, self._arm.upper, 1.0)
            target, shortened_by = self.set_point + room * way, self._kinematics.joint_names[joint]
        self._move = JointTrajectory(self._kinematics, self.set_point, target, self._kinematics.velocity,
                                     self._config.acceleration)
        self._begin_ns = stamp_ns
        return twist, manipulability, shortened_by

    def goes_on(self, stamp_ns, q, gap_s):
        """Whether the move is still under way or settling at q, gap_s after the image before; if not, it is over."""
        way = self._kinematics.way
        speed = inf if self._last_q is None else float(np.abs(way(self._last_q, q)).max()) / gap_s
        self._last_q = q
        waited_s = 1e-9 * (stamp_ns - self._begin_ns) - self._move.duration_s
        if waited_s < 0.0:
            return True
        near = float(np.abs(way(self.set_point, q)).max()) < self._config.settle_tolerance
        if (near and speed < self._config.settle_speed) or waited_s > self._config.settle_limit_s:
            self._move = self._last_q = None
            return False
        return True

    def follow(self, stamp_ns, dt_s):
        """(set-points, velocities), (n,) each, of the move under way, for the next dt_s."""
        t_s = 1e-9 * (stamp_ns - self._begin_ns)
        self._followed_s = t_s + dt_s
        self.set_point, q_dot = self._move.step(t_s, dt_s)
        return self.set_point, q_dot

    def break_off(self, stamp_ns):
        """End the move where the integrated set-point now is, (n,); the next look starts from there."""
        t_s = min(1e-9 * (stamp_ns - self._begin_ns), self._followed_s)
        self.set_point = self._move.position(t_s)
        self._move = self._last_q = None
        return self.set_point
