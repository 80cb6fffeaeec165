"""From the twist wanted to joint velocities that the arm may do: inverse, spare motion, limits, tilt hold."""

from math import asin, inf
from typing import TYPE_CHECKING, Any, Dict, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .kinematics import RobotKinematics
from .limits import accelerated, end_factor, end_speeds, joint_bounds, limit_factors, position_factor, velocity_factor
from .redundancy import TwistInverse, Wish, norm_part
from ..ground.types import Reference, Status

if TYPE_CHECKING:
    from ..servo.settings import ServoSettings

#: NEAR_SINGULARITY is reported when more than this part of the twist cannot be achieved, and that part is also larger
#: than LOST_FLOOR, below which it is noise [rad/s].
LOST_PART, LOST_FLOOR = 0.1, 1e-3
#: A joint moves at most so fast that it would reach its limit in this many periods and this time: the joints of an arm
#: lag behind their set-points and overshoot them.
LIMIT_HORIZON, LAG_S = 2.0, 0.1
#: A joint nearer than this to the end of its way is at its limit [m, rad]. The others could do a twist when less than
#: this part of it is left.
AT_LIMIT, OTHERS_PART = 0.005, 0.5
#: A direction with a smaller singular value is one that the arm cannot do.
LOST_SIGMA = 0.1
#: How readily rotation is given up for a direction that the arm cannot do, against 1 for translation.
TURN_EASE = 1e-3
#: The correction for the change of the Jacobian adds at most this part of the joint velocity.
TURNING_PART = 0.25
#: A velocity counts as fast from this part of the joint's limit on.
FAST_PART = 0.1
#: Every reversal from fast to fast adds REVERSAL to a joint's count, and every other image takes 1 away; the joint
#: chatters from CHATTERS on. The count does not grow above MOST, so that the joint is trusted again soon.
REVERSAL, CHATTERS, MOST = 2, 6, 9


class Motion(NamedTuple):
    """Joint velocities of a twist, within all limits.

    Attributes:
        q_dot: (n,) [m/s, rad/s].  twist: (6,) the twist as scaled by the limits.
        status, text: the reason why the arm does not do the twist in full; None and "" if it does.
    """

    q_dot: np.ndarray
    twist: np.ndarray
    status: Optional[Status] = None
    text: str = ""


class Chatter:
    """Detects a joint that chatters: its commanded velocity is large and changes its sign from image to image.

    This happens next to a singularity, for example of a stretched elbow: the camera hardly moves, without a limit.
    """

    def __init__(self, names: Sequence[str], limit: np.ndarray) -> None:
        """Args: names: of the joints.  limit: (n,) of their velocity, may be infinite [m/s, rad/s]."""
        self._names = names
        self._fast = [FAST_PART * most if most < float("inf") else FAST_PART for most in limit.tolist()]
        self.clear()

    def clear(self) -> None:
        """The joints were told to stand still."""
        self._last, self._counts = [0.0] * len(self._names), [0] * len(self._names)

    def joint(self, q_dot: np.ndarray) -> Optional[str]:
        """Name of a joint that chatters, or None. Call it once for each image. Args: q_dot: (n,) told."""
        last, counts, found = self._last, self._counts, None
        self._last = q_dot.tolist()
        for i, (old, new, fast) in enumerate(zip(last, self._last, self._fast)):
            if old * new < 0.0 and abs(old) > fast and abs(new) > fast:
                counts[i] = min(MOST, counts[i] + REVERSAL)
            elif counts[i]:
                counts[i] -= 1
            if counts[i] >= CHATTERS:
                found = self._names[i]
        return found


class ArmMotion:
    """The arm as the servo sees it.

    Attributes:
        lower, upper: (n,) limits that the arm keeps: those of the URDF, less the margin [m, rad].
        posture: (n,) joint positions that the spare motion returns to, or None.
        has_ends: False for a camera that flies freely.  chatters: name of the joint that chatters, or None.
        optical_axis_B: (3,) direction to which the optical axis is held, or None.
    """

    def __init__(self, kinematics: RobotKinematics, config: "ServoSettings", sees_tilt: bool) -> None:
        """Args: kinematics: `Kinematics`. config: `ServoSettings`. sees_tilt: all six rows of the twist are servoed."""
        self._kinematics = kinematics
        inverse, spare = config.inverse, config.null_space
        weights = [inverse.joint_weights.get(name, 1.0) for name in kinematics.joint_names]
        self._invert = TwistInverse(weights, inverse.length_m, inverse.singular_value_threshold, inverse.damping,
                                    inverse.method)
        self._scale = np.array([1.0 / inverse.length_m] * 3 + [1.0] * 3)
        self._length_m, self._rows = inverse.length_m, list(range(6)) if sees_tilt else [0, 1, 2, 5]
        self._manipulability_gain = spare.manipulability_gain_per_s
        self._large_from = spare.large_from if spare.projection == "large" else None
        self._limits, self._others_go_on = config.limits, inverse.at_limits == "saturate"
        self._acceleration = np.array([config.limits.joint_acceleration.get(name, inf)
                                       for name in kinematics.joint_names])
        self._accelerates = bool(config.limits.joint_acceleration)
        self._lag_s = LAG_S + (config.filter.latency_s if config.filter is not None else 0.0)
        self._before = np.zeros(len(kinematics.joint_names))
        # A free camera has no singularity: what goes to and fro there is the law's own twist.
        self._chatter = Chatter(kinematics.joint_names, kinematics.velocity) if kinematics.spare_motion else None
        self.has_ends, self.chatters = self._chatter is not None, None  # type: bool, Optional[str]
        lower, upper = kinematics.lower, kinematics.upper
        self._wish = Wish(lower, upper, spare.posture_gain_per_s, spare.joint_limit_gain_per_s, spare.max_speed)
        self.lower, self.upper = lower + config.joint_limit_margin, upper - config.joint_limit_margin
        self.posture = self.optical_axis_B = None
        self._axis_B = self._seen_from = self._axis = None  # the taught axis; the last camera pose, and the axis in it

    def set_reference(self, reference: Reference) -> None:
        """Takes over the posture and the optical axis of a `Reference`."""
        self.posture = None if reference.posture is None else self._kinematics.vector(reference.posture)
        self.optical_axis_B, self._seen_from = reference.optical_axis_B, None
        if self.optical_axis_B is not None:
            self._axis_B = tuple(map(float, self.optical_axis_B))

    def rest(self) -> None:
        """Call this when the arm is told to stand still: its next motion begins at zero velocity."""
        self._before = np.zeros_like(self._before)
        if self._chatter is not None:
            self._chatter.clear()

    def at(self, q: np.ndarray) -> Tuple[np.ndarray, Any]:
        """(jacobian, inverse) at joint positions q, (n,)."""
        jacobian = self._kinematics.jacobian(q)
        return jacobian, self._invert(jacobian)

    def tilt(self, X_BC: np.ndarray, inverse: Any, gain: float, target_C: Sequence[float]) -> np.ndarray:
        """Twist that turns the optical axis towards the taught one, as far as the arm can; zeros if none was taught.

        Args: X_BC: (4, 4) pose of the camera.  gain: part of the angle to turn per second [1/s], or in one move.
            target_C: (x, y, z) of a point that keeps its place in the camera frame [m].
        """
        if self.optical_axis_B is None:
            return np.zeros(6)
        a, b, sine = self._taught_axis_in(X_BC)
        if sine > 0.0:
            gain *= asin(min(1.0, sine)) / sine
        return inverse.turn_about((-gain * b, gain * a), target_C)

    def tilt_of(self, X_BC: np.ndarray) -> Optional[Tuple[float, float]]:
        """Turn (x, y) of the camera from where the optical axis is as taught [rad]; None if none was taught.

        Args: X_BC: (4, 4) pose of the camera.
        """
        if self.optical_axis_B is None:
            return None
        a, b, sine = self._taught_axis_in(X_BC)
        scale = asin(min(1.0, sine)) / sine if sine > 0.0 else 1.0
        return scale * b, -scale * a

    def _taught_axis_in(self, X_BC):
        """(x, y, sine of the angle to z) of the taught axis in the frame of a camera at X_BC."""
        if X_BC is not self._seen_from:
            (x, y, z), X = self._axis_B, X_BC.tolist()
            a, b = x * X[0][0] + y * X[1][0] + z * X[2][0], x * X[0][1] + y * X[1][1] + z * X[2][1]
            self._seen_from, self._axis = X_BC, (a, b, (a * a + b * b) ** 0.5)
        return self._axis

    def joint_velocity(self, q: np.ndarray, twist: np.ndarray, jacobian: np.ndarray, inverse: Any,
                       dt_s: float) -> Motion:
        """`Motion` of a twist V_C, (6,), held for dt_s at q, (n,); jacobian and inverse are those that `at` returns."""
        motion = self._joint_velocity(q, twist, jacobian, inverse, dt_s)
        self.chatters = name = None if self._chatter is None else self._chatter.joint(motion.q_dot)
        if name is None or motion.status is not None:
            return motion
        return motion._replace(status=Status.NEAR_SINGULARITY,
                               text=f"joint '{name}' chatters: it reverses from image to image")

    def _joint_velocity(self, q, twist, jacobian, inverse, dt_s):
        twist, q_dot, factor = self._wanted(q, twist, jacobian, inverse, dt_s)
        if self._accelerates:
            q_dot = q_dot * velocity_factor(q_dot, self._kinematics.velocity)
        again, room, joint = self._limited(q, q_dot, dt_s)
        if joint is not None and self._others_go_on:
            return self._without_blocked(q, q_dot * again, joint, twist, jacobian, dt_s)
        scale = min(again, room)
        if scale < 1.0:
            q_dot = q_dot * scale
        scaled = twist * (factor * scale) if factor * scale < 1.0 else twist
        if self._accelerates:
            q_dot = accelerated(self._before, q_dot, self._acceleration * dt_s)
            q_dot = self._before = q_dot * position_factor(q, q_dot, self.lower, self.upper, dt_s)[0]
            scaled = jacobian @ q_dot
        if joint is not None:
            name = self._kinematics.joint_names[joint]
            return Motion(q_dot, scaled, Status.JOINT_LIMIT, f"joint '{name}' at its limit, speed times {room:.2f}")
        lost = inverse.lost(twist)
        if lost > LOST_FLOOR and lost > LOST_PART * float(twist @ twist) ** 0.5:
            return Motion(q_dot, scaled, Status.NEAR_SINGULARITY, "part of the twist cannot be achieved here")
        return Motion(q_dot, scaled)

    def _limited(self, q, q_dot, dt_s):
        """(factor of the velocity limits, that of the ends of the joints' ways, the joint that asks for the latter)."""
        if self._accelerates:
            return 1.0, *end_factor(q_dot, self._end_speeds(q, dt_s))
        return limit_factors(q, q_dot, self._kinematics.velocity, self.lower, self.upper, self._horizon_s(dt_s))

    def _end_speeds(self, q, dt_s):
        return end_speeds(q, self.lower, self.upper, self._acceleration, dt_s, self._horizon_s(dt_s))

    def _horizon_s(self, dt_s):
        return LIMIT_HORIZON * dt_s + self._lag_s

    def _wanted(self, q, twist, jacobian, inverse, dt_s):
        """(twist within the camera's limits, (n,) joint velocities for it, the factor that slowed all of them)."""
        twist = self.within_limits(twist)
        q_dot, factor = self._kinematics.held(inverse, jacobian, q, self.unlimited(q, twist, inverse), dt_s,
                                              TURNING_PART)
        return twist, q_dot, factor

    def within_limits(self, twist: np.ndarray) -> np.ndarray:
        """Returns a twist, (6,), shortened to the limits of the camera's speed."""
        if self._limits.camera_speed_m_s < inf or self._limits.camera_turn_rad_s < inf:
            speed, turn = float(twist[:3] @ twist[:3]) ** 0.5, float(twist[3:] @ twist[3:]) ** 0.5
            twist = twist / max(1.0, speed / self._limits.camera_speed_m_s, turn / self._limits.camera_turn_rad_s)
        return twist

    def lost_directions(self, q: np.ndarray) -> np.ndarray:
        """Returns the twists that the arm cannot do at q, (k, 6), orthonormal with linear parts over `length_m`."""
        U, sigmas, _ = np.linalg.svd(self._scale[:, None] * self._kinematics.jacobian(q))
        return U.T[np.append(sigmas, np.zeros(len(U) - len(sigmas))) < LOST_SIGMA]

    def scaled(self, twist: np.ndarray) -> np.ndarray:
        """Returns a twist, (6,), with its linear parts over `length_m`."""
        return self._scale * twist

    def without(self, twist: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """Returns the twist nearest to one, (6,), that has no part along `lost_directions`, (k, 6).

        Translation is given up before rotation, which would take the target out of view.
        """
        ease = np.array([1.0] * 3 + [TURN_EASE] * 3)
        parts = np.linalg.solve(directions * ease @ directions.T, directions @ (self._scale * twist))
        return twist - ease * (directions.T @ parts) / self._scale

    def others_could(self, q: np.ndarray, twist: np.ndarray, jacobian: np.ndarray, motion: Motion) -> bool:
        """Returns whether joints that `at_limits: scale` stops could do most of a twist, (6,), without those at limits.

        Args: motion: `Motion` of the twist.
        """
        if motion.status != Status.JOINT_LIMIT or self._others_go_on:
            return False
        free = (q - self.lower > AT_LIMIT) & (self.upper - q > AT_LIMIT)
        left = twist - jacobian @ (free * self._invert(jacobian * free).joint_velocity(twist))
        return float(np.linalg.norm(self._scale * left)) < OTHERS_PART * float(np.linalg.norm(self._scale * twist))

    def as_seen(self, q: np.ndarray, X_BC: np.ndarray, twist: np.ndarray, jacobian: np.ndarray, inverse: Any,
                dt_s: float) -> Dict[str, Any]:
        """The values of `laws.look.Arm`, a dict, for a law that chooses the joint velocities itself."""
        _, wanted, _ = self._wanted(q, twist, jacobian, inverse, dt_s)
        velocity, names = self._kinematics.velocity, self._kinematics.joint_names
        low, high, at_stop, short = joint_bounds(q, self._before, self.lower, self.upper, velocity,
                                                 self._acceleration, dt_s, self._horizon_s(dt_s))
        return {"joint_names": names, "q": q, "before": self._before, "X_BC": X_BC, "jacobian": jacobian,
                "wanted": wanted, "low": low, "high": high, "at_stop": at_stop,
                "short": tuple(name for name, late in zip(names, short) if late), "lower": self.lower,
                "upper": self.upper, "velocity": velocity, "acceleration": self._acceleration, "dt_s": dt_s}

    def told(self, q_dot: np.ndarray, jacobian: np.ndarray, status: Optional[Status], text: str) -> Motion:
        """`Motion` of joint velocities, (n,), that a law has chosen within the limits."""
        self._before = q_dot
        self.chatters = None if self._chatter is None else self._chatter.joint(q_dot)
        return Motion(q_dot, jacobian @ q_dot, status, text)

    def driven(self, q: np.ndarray, q_dot: np.ndarray, jacobian: np.ndarray, dt_s: float, status: Status,
               text: str) -> Motion:
        """`Motion` of joint velocities, (n,), that lead to joint positions within the limits, slowed as these ask."""
        twist = jacobian @ q_dot
        bounded = self.within_limits(twist)
        slower = [float(np.linalg.norm(bounded[part]) / np.linalg.norm(twist[part]))
                  for part in (slice(3), slice(3, 6)) if twist[part].any()]
        q_dot = q_dot * min([velocity_factor(q_dot, self._kinematics.velocity), *slower])
        if self._accelerates:
            q_dot = accelerated(self._before, q_dot, self._acceleration * dt_s)
            q_dot = q_dot * position_factor(q, q_dot, self.lower, self.upper, dt_s)[0]
        return self.told(q_dot, jacobian, status, text)

    def _without_blocked(self, q, q_dot, joint, twist, jacobian, dt_s):
        """`Motion` in which joints at their limits stop there and the others go on: saturation in the null space (T44).

        The joint that violates its limit most gets only the velocity that its room allows. The rest of the twist is
        inverted for the other joints. This is repeated until all joints keep their limits.
        Args: q_dot: (n,) that violates a limit.  joint: index of the joint that violates its limit most.
        """
        (down, up), names = self._end_speeds(q, dt_s), []
        held, others = np.zeros_like(q), np.ones_like(q)
        while joint is not None:
            held[joint] = up[joint] if q_dot[joint] > 0.0 else -down[joint]
            others[joint] = 0.0
            names.append(self._kinematics.joint_names[joint])
            inverse = self._invert(jacobian * others)
            q_dot = others * self.unlimited(q, twist - jacobian @ held, inverse)
            _, joint = end_factor(q_dot, np.array([down, up]))
        q_dot = held + q_dot
        if self._accelerates:
            q_dot = accelerated(self._before, q_dot, self._acceleration * dt_s)
        q_dot = q_dot * velocity_factor(q_dot, self._kinematics.velocity)
        # What brakes too late stops at once, each joint on its own: those that are beyond their ends stop no other.
        q_dot = self._before = np.clip(q_dot, np.minimum(self.lower - q, 0.0) / dt_s,
                                       np.maximum(self.upper - q, 0.0) / dt_s)
        text = f"at their limits, the others go on: {', '.join(names)}"
        return Motion(q_dot, jacobian @ q_dot, Status.JOINT_LIMIT, text)

    def unlimited(self, q: np.ndarray, twist: np.ndarray, inverse: Any) -> np.ndarray:
        """(n,) joint velocities of the twist and of the spare motion, before any limit is applied."""
        if not self._kinematics.spare_motion:
            return inverse.joint_velocity(twist)
        more = None
        if self._manipulability_gain > 0.0:
            more = self._manipulability_gain * self._kinematics.manipulability(q, self._length_m, self._rows)[1]
        if self._large_from is None:
            return inverse.with_wish(twist, self._wish, q, self.posture, more)
        wish, part = self._wish(q, self.posture, more), norm_part(inverse.size(twist), *self._large_from)
        return (inverse.joint_velocity(twist)
                + ((1.0 - part) * inverse.free(wish) + part * inverse.free_of_norm(wish, twist)))

    def split(self, q: np.ndarray, q_dot: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """((n,), (n,)): the part of the joint velocities q_dot at q that moves the camera, and the null-space part."""
        null = self.at(q)[1].null_part(q_dot)
        return q_dot - null, null

    def turning(self, q: np.ndarray, q_dot: np.ndarray, jacobian: np.ndarray, inverse: Any, dt_s: float) -> np.ndarray:
        """Correction of q_dot for the change of the Jacobian while q_dot is held: the twist is then right half-way.

        Near the stretched elbow the Jacobian changes fast. The correction is at most TURNING_PART of q_dot.
        """
        half_way = self._kinematics.jacobian(self._kinematics.moved(q, q_dot, 0.5 * dt_s))
        return inverse.turning(jacobian, half_way, q_dot, TURNING_PART)
