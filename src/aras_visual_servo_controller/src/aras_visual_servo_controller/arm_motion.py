"""From the twist wanted to joint velocities that the arm may do: inverse, spare motion, limits, tilt hold."""

from math import asin
from typing import NamedTuple

import numpy as np

from .limits import position_factor, velocity_factor
from .redundancy import TwistInverse, Wish
from .types import Status

#: NEAR_SINGULARITY is reported when this part of the twist cannot be achieved, and it is above noise [rad/s].
LOST_PART, LOST_FLOOR = 0.1, 1e-3
#: A joint may use up its room to the limit within this many periods at the soonest.
LIMIT_HORIZON = 2.0
#: Largest part of the joint velocity that the correction for a turning Jacobian may add.
TURNING_PART = 0.25


class Motion(NamedTuple):
    """Joint velocities of a twist, within all limits.

    Attributes:
        q_dot: (n,) [m/s, rad/s].  twist: (6,) the twist as scaled by the limits.
        status, text: what kept it from being done in full; None and "" if nothing did.
    """

    q_dot: np.ndarray
    twist: np.ndarray
    status: Status = None
    text: str = ""


class ArmMotion:
    """The arm as the servo sees it.

    Attributes:
        lower, upper: (n,) limits that are kept, the margin taken off [m, rad].
        posture: (n,) joint positions that the spare motion returns to, or None.
        optical_axis_B: (3,) direction to which the optical axis is held, or None.
    """

    def __init__(self, kinematics, config):
        """Args: kinematics: `Kinematics`. config: `ServoConfig`."""
        self._kinematics = kinematics
        weights = [config.joint_weights.get(name, 1.0) for name in kinematics.joint_names]
        self._invert = TwistInverse(weights, config.length_m, config.singular_value_threshold, config.damping)
        lower, upper = kinematics.lower, kinematics.upper
        self._wish = Wish(lower, upper, config.posture_gain_per_s, config.joint_limit_gain_per_s, config.max_speed)
        self.lower, self.upper = lower + config.joint_limit_margin, upper - config.joint_limit_margin
        self.posture = self.optical_axis_B = None

    def set_reference(self, reference):
        """Take over the posture and the optical axis of a `Reference`."""
        self.posture = None if reference.posture is None else self._kinematics.vector(reference.posture)
        self.optical_axis_B = reference.optical_axis_B

    def at(self, q):
        """(jacobian, inverse) at joint positions q, (n,)."""
        jacobian = self._kinematics.jacobian(q)
        return jacobian, self._invert(jacobian)

    def tilt(self, q, inverse, gain, target_C):
        """Twist that turns the optical axis towards the taught one, as far as the arm can; zeros without one.

        Args: gain: part of the angle [1/s], or of one move.  target_C: (x, y, z) of a point that keeps its place [m].
        """
        if self.optical_axis_B is None:
            return np.zeros(6)
        a, b, _ = (self.optical_axis_B @ self._kinematics.pose(q)[:3, :3]).tolist()  # the taught axis in C
        sine = (a * a + b * b) ** 0.5
        if sine > 0.0:
            gain *= asin(min(1.0, sine)) / sine
        _, _, _, wx, wy, _ = inverse.achieved(np.array([0.0, 0.0, 0.0, -gain * b, gain * a, 0.0])).tolist()
        x, y, z = target_C  # v = -w x P keeps the point P where it is
        return np.array([-wy * z, wx * z, wy * x - wx * y, wx, wy, 0.0])

    def joint_velocity(self, q, twist, jacobian, inverse, dt_s):
        """`Motion` of a twist V_C, (6,), held for dt_s at q, (n,); jacobian and inverse as of `at`."""
        q_dot = self.unlimited(q, twist, inverse)
        factor = velocity_factor(q_dot, self._kinematics.velocity)
        if factor < 1.0:
            q_dot = q_dot * factor
        q_dot = q_dot + self.turning(q, q_dot, jacobian, inverse, dt_s)
        again = velocity_factor(q_dot, self._kinematics.velocity)
        room, joint = position_factor(q, q_dot, self.lower, self.upper, LIMIT_HORIZON * dt_s)
        scale = min(again, room)
        if scale < 1.0:
            q_dot = q_dot * scale
        scaled = twist * (factor * scale) if factor * scale < 1.0 else twist
        if joint is not None:
            name = self._kinematics.joint_names[joint]
            return Motion(q_dot, scaled, Status.JOINT_LIMIT, f"joint '{name}' at its limit, speed times {room:.2f}")
        lost = inverse.lost(twist)
        if lost > LOST_FLOOR and lost > LOST_PART * float(twist @ twist) ** 0.5:
            return Motion(q_dot, scaled, Status.NEAR_SINGULARITY, "part of the twist cannot be achieved here")
        return Motion(q_dot, scaled)

    def unlimited(self, q, twist, inverse):
        """(n,) joint velocities of the twist and of the spare motion, whatever the limits."""
        return inverse.joint_velocity(twist) + inverse.free(self._wish(q, self.posture))

    def turning(self, q, q_dot, jacobian, inverse, dt_s):
        """Correction of q_dot for the Jacobian turning while it is held: makes the twist right half-way.

        Next to the stretched elbow the Jacobian turns fast. At most TURNING_PART of q_dot.
        """
        half_way = self._kinematics.jacobian(q + (0.5 * dt_s) * q_dot)
        correction = inverse.joint_velocity((jacobian - half_way) @ q_dot)
        most, size = TURNING_PART * float(q_dot @ q_dot) ** 0.5, float(correction @ correction) ** 0.5
        return correction if size <= most else correction * (most / size)
