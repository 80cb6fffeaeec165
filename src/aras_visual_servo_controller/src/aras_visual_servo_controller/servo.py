"""The servo: one observation in, one joint command and one record out. No ROS, no wall time, no random numbers.

    servo = Servo(kinematics, scenario["servo"])
    servo.teach(features, q)                     # this view is the goal (features normalised by its own reference)
    servo.start(stamp_ns)                        # or start(stamp_ns, set_point=q_last_commanded)
    command, record = servo.step(Observation(stamp_ns, features, q), dt_s)
    ... until servo.finished

The four default features say nothing about tilt, and 0.006 degrees of it look like 0.05 mm at 0.5 m. So the optical
axis is held at its taught direction from the measured joint positions: w_xy turns it there at tilt_gain_per_s. Features
that see tilt (`FeatureSet.sees_tilt`) turn it themselves.

Nothing moves on data that is missing, not valid, late or not finite: zero velocity, and a status that says why.
"""

from math import asin, expm1, inf, isfinite, nan
from typing import Mapping, Optional, Tuple

import numpy as np

from .errors import DegenerateFeature, NotFiniteError, ParameterError
from .features import FeatureSet, View
from .interaction import plane_from_pose
from .laws import make_law
from .limits import position_factor, velocity_factor
from .redundancy import TwistInverse, Wish
from .servo_config import ServoConfig
from .trajectory import JointTrajectory
from .types import Command, Features, Observation, Reference, ServoRecord, Status

_FINAL = (Status.CONVERGED, Status.TIMED_OUT, Status.STOPPED, Status.FAULT)
_MOVING_STATUSES = (Status.SERVOING, Status.JOINT_LIMIT, Status.NEAR_SINGULARITY)
#: NEAR_SINGULARITY is reported when this part of the twist cannot be achieved, and it is above noise [rad/s].
LOST_PART, LOST_FLOOR = 0.1, 1e-3
#: A joint may use up its room to the limit within this many periods at the soonest.
LIMIT_HORIZON = 2.0
#: look_then_move: a look's displacement is followed in this many steps (the arm's Jacobian turns on the way), and this
#: part of the tilt is corrected by each look.
LOOK_STEPS, LOOK_TILT = 10, 0.9
#: Largest part of the joint velocity that the correction for a turning Jacobian may add.
TURNING_PART = 0.25


class Servo:
    """Drives the camera to the taught view.

    Attributes:
        config: `ServoConfig` in use.  reference: `Reference` or None.  status: `Status` of the last step.
        finished: only start() moves again (CONVERGED, TIMED_OUT, STOPPED or FAULT).
    """

    def __init__(self, kinematics, config: Mapping):
        """Args: kinematics: `Kinematics`. config: the scenario's section `servo` (dict). Raises ParameterError."""
        names = kinematics.joint_names
        self._kinematics = kinematics
        self._scenario_config = self.config = ServoConfig.from_dict(config, names)
        setup = self.config
        weights = [setup.joint_weights.get(name, 1.0) for name in names]
        self._invert = TwistInverse(weights, setup.length_m, setup.singular_value_threshold, setup.damping)
        lower, upper = kinematics.lower, kinematics.upper
        self._wish = Wish(lower, upper, setup.posture_gain_per_s, setup.joint_limit_gain_per_s, setup.max_speed)
        self._lower, self._upper = lower + setup.joint_limit_margin, upper - setup.joint_limit_margin
        self._features = FeatureSet(setup.features)
        self._law = self._make_law()
        self._no_velocity = dict.fromkeys(names, 0.0)
        self._zeros, self._nans = np.zeros(len(names)), np.full(len(names), nan)
        self._s_star, self._posture = np.full(len(self._features), nan), None
        self._X_CgB = None
        self.reference: Optional[Reference] = None
        self.status = Status.IDLE
        self._clear(0, None)

    @property
    def finished(self) -> bool:
        """True when only start() moves again."""
        return self.status in _FINAL

    @property
    def feature_names(self) -> Tuple[str, ...]:
        """Names of s, s_star and e."""
        return self._features.names

    def _make_law(self):
        return make_law(self.config.law, self.config.gains_per_s, self.config.law_setup)

    def configure(self, law="", gains_per_s=(), thresholds=(), time_limit_s=0.0) -> None:
        """Override the scenario's values from the next start on; empty or 0 takes the scenario's. ParameterError."""
        self.config = self._scenario_config.with_overrides(law, gains_per_s, thresholds, time_limit_s)

    def teach(self, features, q) -> Reference:
        """This view, seen at joint positions q, is the goal. ParameterError when the features are not fit for it."""
        fit = features is not None and features.target_visible and features.valid and features.has_reference
        try:
            s_star = np.array(self._features.values(View(features)) if fit else [nan])
        except DegenerateFeature as error:
            raise ParameterError(f"teach: {error}") from error
        q = self._kinematics.vector(q)
        if not (np.isfinite(s_star).all() and np.isfinite(q).all()):
            raise ParameterError("teach: the view has no valid, normalised features of the target")
        view = plane = None
        if hasattr(features, "moment_names"):
            view, t = Features.from_object(features), features.z_star_m * np.array([features.xg, features.yg, 1.0])
            plane = plane_from_pose(self.config.target_normal_C, t)
        axis_B = self._kinematics.pose(q)[:3, 2].copy()
        self.set_reference(Reference(s_star, axis_B, self._kinematics.by_name(q), view, plane))
        return self.reference

    def set_reference(self, reference: Reference) -> None:
        """Use a reference taught before."""
        self._law.reset(reference)
        self._s_star = np.array(reference.s_star, dtype=float)
        self._posture = None if reference.posture is None else self._kinematics.vector(reference.posture)
        self._X_CgB = None if self._posture is None else np.linalg.inv(self._kinematics.pose(self._posture))
        self.reference = reference

    def start(self, stamp_ns: int, set_point=None) -> None:
        """Begin servoing.

        Args: stamp_ns: start of the time limit. set_point: joint set-points last commanded, by name or as an array
        (look_then_move moves them; default: the positions measured at the first step).
        Raises: ParameterError without a reference.
        """
        if self.reference is None:
            raise ParameterError("servo: no reference, teach one first")
        self._law = self._make_law()
        self._law.reset(self.reference)
        self._clear(stamp_ns, None if set_point is None else self._kinematics.vector(set_point))
        self.status = Status.SERVOING

    def stop(self, stamp_ns: int, reason: str = "stopped") -> Tuple[Command, ServoRecord]:
        """End servoing: zero velocity, STOPPED."""
        return self._rest(stamp_ns, Status.STOPPED, reason)

    def stale(self, stamp_ns: int, reason: str) -> Tuple[Command, ServoRecord]:
        """Watchdog: input is late. Zero velocity, STALE_INPUT; servoing goes on with the next step."""
        if self.status == Status.IDLE or self.finished:
            return self._rest(stamp_ns, self.status, self._text)
        return self._rest(stamp_ns, Status.STALE_INPUT, reason)

    def step(self, observation: Observation, dt_s: float) -> Tuple[Command, ServoRecord]:
        """Answer to one image.

        Args: observation: at this image. dt_s: time to the next image, through which the command holds [s].
        """
        stamp_ns, features = observation.stamp_ns, observation.features
        if self.status == Status.IDLE:
            return Command(stamp_ns), self._record(stamp_ns, "not started", self._zeros, self._nans)
        if self.finished:
            return self._rest(stamp_ns, self.status, self._text)
        q, self._q = self._kinematics.vector(observation.q), self._nans
        if q.shape != self._zeros.shape or not isfinite(float(q.sum())):
            return self._rest(stamp_ns, Status.FAULT, f"joint positions {q} are not {len(self._zeros)} finite numbers")
        self._q = q
        gap_s = nan if self._last_ns is None else 1e-9 * (stamp_ns - self._last_ns)
        if gap_s <= 0.0 or not 0.0 < dt_s < inf:
            return self._rest(stamp_ns, Status.STALE_INPUT, f"stamp advanced by {gap_s} s, period {dt_s} s")
        self._last_ns = stamp_ns
        if stamp_ns - self._start_ns >= 1e9 * self.config.time_limit_s:
            return self._rest(stamp_ns, Status.TIMED_OUT, f"not converged after {self.config.time_limit_s} s")
        if gap_s > self.config.input_timeout_s or features is None:
            text = "no image" if features is None else f"no image for {gap_s:.3f} s"
            return self._rest(stamp_ns, Status.STALE_INPUT, text)
        if self._move is not None and self._moving(stamp_ns, q, gap_s):
            return self._follow(stamp_ns, dt_s)
        if not (features.target_visible and features.valid):
            text = "target not in view" if not features.target_visible else "target cut by the border or not orientable"
            return self._rest(stamp_ns, Status.TARGET_LOST, text)
        return self._servo(stamp_ns, features, q, dt_s)

    def _servo(self, stamp_ns, features, q, dt_s):
        """One look at valid features."""
        look, law = self.config.mode == "look_then_move", self._law
        try:
            if law.needs_pose:
                law.X_CgC = self._displacement(q)
            if law.needs_plane:
                twist = law.step(features, 0.0 if look else dt_s, self._plane(q))
            else:
                twist = law.step(features, 0.0 if look else dt_s)
        except NotFiniteError as error:
            return self._rest(stamp_ns, Status.FAULT, f"not finite: {error}")
        except DegenerateFeature as error:
            return self._rest(stamp_ns, Status.TARGET_LOST, str(error))
        except Exception as error:  # a law or feature of somebody else: the arm must stand still, whatever it raises
            return self._rest(stamp_ns, Status.FAULT, f"law '{law.name}': {type(error).__name__}: {error}")
        if np.shape(twist) != (6,) or not isfinite(float(twist.sum())):
            return self._rest(stamp_ns, Status.FAULT, f"law '{law.name}' gave a twist that is not six finite numbers")
        self._s, self._e = law.s, law.e
        self._cond_l = law.current_condition()
        below = all([abs(error) < most for error, most in zip(self._e, self.config.thresholds)])
        if not below:
            self._below_ns = None
        elif self._below_ns is None:
            self._below_ns = stamp_ns
        if below and stamp_ns - self._below_ns >= 1e9 * self.config.hold_s:
            return self._rest(stamp_ns, Status.CONVERGED, "every |e| below its threshold")
        self.status, self._text = Status.SERVOING, "servoing"
        if look:
            return self._rest_until_held(stamp_ns) if below else self._look(stamp_ns, features, q, twist, dt_s)
        jacobian = self._kinematics.jacobian(q)
        inverse = self._invert(jacobian)
        gain = self.config.tilt_gain_per_s
        if gain > 0.0 and not self._features.sees_tilt:
            self._add_tilt(twist, q, inverse, -expm1(-gain * dt_s) / dt_s, (features.xn, features.yn, features.an))
        q_dot = self._joint_velocity(q, twist, jacobian, inverse, dt_s)
        velocity = self._kinematics.by_name(q_dot)
        return Command(stamp_ns, {}, velocity), self._record(stamp_ns, self._text, q_dot, self._nans)

    def _plane(self, q):
        """(A, B, C) of the target, at rest, in the camera frame at q: the taught one, moved by the kinematics (T21)."""
        if self.reference.plane_C is None:
            raise ParameterError("the reference holds no plane: teach it again")
        X_CgC = self._displacement(q)
        return (self.reference.plane_C @ X_CgC[:3, :3]) / (1.0 - self.reference.plane_C @ X_CgC[:3, 3])

    def _displacement(self, q):
        """X_CgC, (4, 4): pose of the camera at q in that of the goal, by the kinematics."""
        if self._X_CgB is None:
            raise ParameterError("the reference holds no posture: teach it again")
        return self._X_CgB @ self._kinematics.pose(q)

    def _add_tilt(self, twist, q, inverse, gain, target_C):
        """Turn the optical axis towards the taught one, as far as the arm can; target_C, (x, y, z), keeps its place."""
        axis_B = self.reference.optical_axis_B
        if axis_B is None:
            return
        a, b, _ = (axis_B @ self._kinematics.pose(q)[:3, :3]).tolist()  # the taught axis in C
        sine = (a * a + b * b) ** 0.5
        if sine > 0.0:
            gain *= asin(min(1.0, sine)) / sine
        _, _, _, wx, wy, _ = inverse.achieved(np.array([0.0, 0.0, 0.0, -gain * b, gain * a, 0.0])).tolist()
        x, y, z = target_C  # v = -w x P keeps the point P where it is
        twist += np.array([-wy * z, wx * z, wy * x - wx * y, wx, wy, 0.0])

    def _joint_velocity(self, q, twist, jacobian, inverse, dt_s):
        """Joint velocities of the twist, within all limits; sets status, twist as scaled and manipulability."""
        q_dot = inverse.joint_velocity(twist) + inverse.free(self._wish(q, self._posture))
        factor = velocity_factor(q_dot, self._kinematics.velocity)
        if factor < 1.0:
            q_dot = q_dot * factor
        q_dot = q_dot + self._turning(q, q_dot, jacobian, inverse, dt_s)
        again = velocity_factor(q_dot, self._kinematics.velocity)
        room, joint = position_factor(q, q_dot, self._lower, self._upper, LIMIT_HORIZON * dt_s)
        scale = min(again, room)
        if scale < 1.0:
            q_dot = q_dot * scale
        if joint is not None:
            self.status = Status.JOINT_LIMIT
            self._text = f"joint '{self._kinematics.joint_names[joint]}' at its limit, speed times {room:.2f}"
        else:
            lost = inverse.lost(twist)
            if lost > LOST_FLOOR and lost > LOST_PART * float(twist @ twist) ** 0.5:
                self.status, self._text = Status.NEAR_SINGULARITY, "part of the twist cannot be achieved here"
        self._twist = twist * (factor * scale) if factor * scale < 1.0 else twist
        self._manipulability = inverse.manipulability
        return q_dot

    def _turning(self, q, q_dot, jacobian, inverse, dt_s):
        """Correction of q_dot for the Jacobian turning while it is held: makes the twist right half-way.

        Next to the stretched elbow the Jacobian turns fast. At most TURNING_PART of q_dot.
        """
        half_way = self._kinematics.jacobian(q + (0.5 * dt_s) * q_dot)
        correction = inverse.joint_velocity((jacobian - half_way) @ q_dot)
        most, size = TURNING_PART * float(q_dot @ q_dot) ** 0.5, float(correction @ correction) ** 0.5
        return correction if size <= most else correction * (most / size)

    # --- look then move -----------------------------------------------------------------------------------------

    def _look(self, stamp_ns, features, q, twist, dt_s):
        """Plan the move that one look asks for, and begin it."""
        motion, ahead = twist * self.config.sample_time_s, q
        for step in range(LOOK_STEPS):
            jacobian = self._kinematics.jacobian(ahead)
            inverse = self._invert(jacobian)
            if step == 0:
                self._manipulability = inverse.manipulability
                if self.config.tilt_gain_per_s > 0.0 and not self._features.sees_tilt:
                    self._add_tilt(motion, q, inverse, LOOK_TILT, (features.xn, features.yn, features.an))
                self._twist = motion / self.config.sample_time_s
            q_dot = inverse.joint_velocity(motion) + inverse.free(self._wish(ahead, self._posture))
            ahead = ahead + (q_dot + self._turning(ahead, q_dot, jacobian, inverse, 1.0 / LOOK_STEPS)) / LOOK_STEPS
        if self._set_point is None:
            self._set_point = q
        wanted = self._set_point + (ahead - q)
        target = np.clip(wanted, self._lower, self._upper)
        if (target != wanted).any():  # shorten, so that the direction is kept
            room, joint = position_factor(self._set_point, wanted - self._set_point, self._lower, self._upper, 1.0)
            target = self._set_point + room * (wanted - self._set_point)
            self.status = Status.JOINT_LIMIT
            self._text = f"joint '{self._kinematics.joint_names[joint]}' at its limit"
        self._move = JointTrajectory(self._set_point, target, self._kinematics.velocity, self.config.acceleration)
        self._move_ns = stamp_ns
        return self._follow(stamp_ns, dt_s)

    def _moving(self, stamp_ns, q, gap_s):
        """Whether the last move is still under way or settling."""
        speed = inf if self._last_q is None else float(np.abs(q - self._last_q).max()) / gap_s
        self._last_q = q
        waited_s = 1e-9 * (stamp_ns - self._move_ns) - self._move.duration_s
        if waited_s < 0.0:
            return True
        near = float(np.abs(q - self._set_point).max()) < self.config.settle_tolerance
        if (near and speed < self.config.settle_speed) or waited_s > self.config.settle_limit_s:
            self._move = self._last_q = None
            return False
        return True

    def _follow(self, stamp_ns, dt_s):
        """Command of the move under way."""
        t_s = 1e-9 * (stamp_ns - self._move_ns)
        self._followed_s = t_s + dt_s
        self._set_point, q_dot = self._move.position(t_s), self._move.velocity(t_s, dt_s)
        by_name = self._kinematics.by_name
        if self.status not in _MOVING_STATUSES:
            self.status, self._text = Status.SERVOING, "moving"
        record = self._record(stamp_ns, self._text, q_dot, self._set_point)
        return Command(stamp_ns, by_name(self._set_point), by_name(q_dot)), record

    def _rest_until_held(self, stamp_ns):
        self._twist = np.zeros(6)
        record = self._record(stamp_ns, "holding", self._zeros, self._nans)
        return Command(stamp_ns, {}, dict(self._no_velocity)), record

    # --- common -------------------------------------------------------------------------------------------------

    def _clear(self, stamp_ns, set_point):
        self._text = ""
        self._start_ns, self._last_ns, self._below_ns = stamp_ns, None, None
        self._move, self._move_ns, self._followed_s = None, 0, 0.0
        self._last_q, self._set_point = None, set_point
        self._forget()
        self._q = self._nans

    def _forget(self):
        self._s = self._e = (nan,) * len(self._features)
        self._twist, self._manipulability, self._cond_l = np.zeros(6), nan, nan

    def _rest(self, stamp_ns, status, text):
        """Zero velocity. The record of CONVERGED keeps s and e; every other one has nothing to show."""
        if status not in _FINAL:
            self._below_ns = None
            self._forget()
        self._twist = np.zeros(6)
        self.status, self._text = status, text
        if self._move is None:
            return Command(stamp_ns, {}, dict(self._no_velocity)), self._record(stamp_ns, text, self._zeros, self._nans)
        # A move is broken off where the integrated set-point now is; the next look starts from there.
        t_s = min(1e-9 * (stamp_ns - self._move_ns), self._followed_s)
        self._set_point = self._move.position(t_s)
        self._move = self._last_q = None
        record = self._record(stamp_ns, text, self._zeros, self._set_point)
        return Command(stamp_ns, self._kinematics.by_name(self._set_point), dict(self._no_velocity)), record

    def _record(self, stamp_ns, text, q_dot, set_point):
        return ServoRecord(
            stamp_ns, self.status, text, "servo", self.status == Status.CONVERGED, self._features.names,
            np.array(self._s), self._s_star, np.array(self._e), self._twist, self._kinematics.joint_names, self._q,
            q_dot, set_point, self._manipulability, self._cond_l,
        )  # fmt: skip
