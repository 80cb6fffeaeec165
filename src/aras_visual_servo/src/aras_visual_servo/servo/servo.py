"""The servo: one observation in, one joint command and one record out. No ROS, no wall time, no random numbers.

    servo = Servo(kinematics, scenario["servo"])
    servo.teach(features, q, z_star_m)           # this view, the target z_star_m away, is the goal
    servo.start(stamp_ns)                        # or start(stamp_ns, set_point=q_last_commanded)
    command, record = servo.step(Observation(stamp_ns, features, q), dt_s)
    ... until servo.finished

The four default features say nothing about tilt, and 0.006 degrees of it look like 0.05 mm at 0.5 m. So the optical
axis is held at its taught direction from the measured joint positions: w_xy turns it there at tilt_gain_per_s. Features
that see tilt (`FeatureSet.sees_tilt`) turn it themselves.

Nothing moves on data that is missing, not valid, late or not finite: zero velocity, and a status that says why.
"""

from dataclasses import replace
from math import expm1, inf, isfinite, nan
from typing import Mapping, Optional, Tuple

import numpy as np

from ..arm.motion import ArmMotion
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError
from .creep import CreepCompensation
from .feature_filter import FeatureFilter
from .feed_forward import TargetMotion
from ..features.base import FeatureSet, View
from ..features.sources import Source, source_named
from ..laws.base import make_law
from ..laws.look import Arm, Look
from .look_then_move import LookThenMove
from .lost_target import LostTarget
from .settings import ServoSettings
from .stop_rule import GoalPose, StopRule
from ..ground.types import FINAL, Command, Observation, Reference, ServoRecord, Status
from .visibility import keep_in_view
from .why import Hindrance, displaced_target

_MOVING_STATUSES = (Status.SERVOING, Status.JOINT_LIMIT, Status.NEAR_SINGULARITY)


class Servo:
    """Drives the camera to the taught view.

    Attributes:
        settings: `ServoSettings` of the scenario.  config: those in use (`configure`).  reference: `Reference` or None.
        status: `Status` of the last step.
        finished: only start() moves again (CONVERGED, STOPPED_BY_RULE, TIMED_OUT, STOPPED or FAULT).
    """

    def __init__(self, kinematics, config: Mapping):
        """Args: kinematics: `Kinematics`. config: the scenario's section `servo` (dict), or the `settings` of another
        servo of these joints. Raises ParameterError."""
        names = kinematics.joint_names
        self._kinematics = kinematics
        self.settings = self.config = (config if isinstance(config, ServoSettings)
                                       else ServoSettings.from_dict(config, names))
        self._features = FeatureSet(self.config.features, self.config.settings, self.config.source)
        self._source = source_named(self._features.source)
        self._arm = ArmMotion(kinematics, self.config, self._features.sees_tilt)
        self._moves = LookThenMove(kinematics, self._arm, self.config)
        self._lost = LostTarget(kinematics, self._arm, self.config.on_lost, self.config.lost_target)
        forward = self.config.feed_forward
        self._target_motion = None if forward is None else TargetMotion(forward, self._features)
        symmetric = self.config.symmetric_target
        self._filter = self.config.filter and FeatureFilter(self.config.filter, self._features, symmetric)
        self.reference: Optional[Reference] = None
        self._law, self._stop, self._goal_pose = self._make_law(), self._make_stop_rule(), None
        self._hindrance, self._displaced = Hindrance(), ""
        self._creep = CreepCompensation(self.config.creep_rate_per_s)
        self._creeps = not (self.config.creep_rate_per_s == 0.0 or self.follows)
        self._no_velocity = dict.fromkeys(names, 0.0)
        self._zeros, self._nans = np.zeros(len(names)), np.full(len(names), nan)
        self._s_star, self._X_CgB = np.full(len(self._features), nan), None
        self.status = Status.IDLE
        self._clear(0, None)

    @property
    def finished(self) -> bool:
        """True when only start() moves again."""
        return self.status in FINAL

    @property
    def feature_names(self) -> Tuple[str, ...]:
        """Names of s, s_star and e."""
        return self._features.names

    @property
    def source(self) -> Source:
        """Where the features come from."""
        return self._source

    def why_lost(self, features) -> str:
        """Why the servo cannot use these features (None: there are none), in words; an empty text if it can."""
        return "no image" if features is None else self._source.why_lost(features)

    def split(self, q, q_dot):
        """((n,), (n,)): what of the joint velocities q_dot at q moves the camera, and what is null-space motion."""
        return self._arm.split(q, q_dot)

    def _make_law(self):
        return make_law(self.config.law, self.config.gains_per_s, self.config)

    def _make_stop_rule(self):
        config = self.config
        images = 1 if self.reference is None else self.reference.images
        return StopRule(self._features.names, config.thresholds, config.hold_s, config.stop, self.follows, images)

    def configure(self, law="", gains_per_s=(), thresholds=(), time_limit_s=0.0) -> None:
        """Override the scenario's values from the next start on; empty or 0 takes the scenario's. ParameterError."""
        self.config = self.settings.with_overrides(law, gains_per_s, thresholds, time_limit_s)

    def retuned(self, config: Mapping) -> "Servo":
        """A servo with other settings that goes on where this one is: same goal, same time limit, same state.

        Args: config: the scenario's section `servo` (dict). Raises: ParameterError: a fault of it, or the goal was
        taught for features that do not tell what the new ones need.
        """
        servo = Servo(self._kinematics, config)
        if self.reference is None:
            return servo
        if servo.source is not self._source:
            raise ParameterError(f"features: found {', '.join(servo.feature_names)}, which another source makes; "
                                 "allowed before the next reset: features of the source that the goal was taught with")
        reference = self.reference
        if servo.feature_names != self.feature_names:
            reference = replace(reference, s_star=np.array(servo._features.values(View(reference.view)), dtype=float))
        servo.set_reference(reference)
        if self.status != Status.IDLE:
            servo.start(self._start_ns)
            servo.status, servo._text = self.status, self._text
        return servo

    def teach(self, features, q, z_star_m) -> Reference:
        """Make a view the goal. Args and errors: those of `as_reference`."""
        self.set_reference(self.as_reference(features, q, z_star_m))
        return self.reference

    def as_reference(self, features, q, z_star_m) -> Reference:
        """The `Reference` that a view would give as the goal. The servo's own goal stays as it is.

        Args:
            features: of the view, whatever reference they have themselves.  q: joint positions there.
            z_star_m: depth of the target in this view, > 0 [m].
        Raises: ParameterError: the features are not fit for it.
        """
        text, q = self.why_lost(features), self._kinematics.vector(q)
        if not (isfinite(z_star_m) and z_star_m > 0.0):
            raise ParameterError(f"z_star_m of the view to teach: found {z_star_m}, allowed > 0")
        try:
            taught = None if text else self._source.taught(features, z_star_m, self.config.target_normal_C)
            s_star = np.array([nan] if text else self._features.values(View(taught.features)))
        except DegenerateFeature as error:
            raise ParameterError(f"the view to teach: {error}") from error
        if not (np.isfinite(s_star).all() and np.isfinite(q).all()):
            raise ParameterError(f"the view to teach has no valid features of the target: {text or 'not finite'}")
        axis_B = self._kinematics.pose(q)[:3, 2].copy()
        return Reference(s_star, axis_B, self._kinematics.by_name(q), taught.view, taught.plane_C)

    @property
    def follows(self) -> bool:
        """Whether the goal may move."""
        return self.config.track or self._target_motion is not None

    def joint_vector(self, q) -> np.ndarray:
        """(n,) of joint positions, by name or an array."""
        return self._kinematics.vector(q)

    def goal_errors(self, views):
        """How several views of the goal differ from the first: (n, k) errors, (n, 6) poses they stand for or None."""
        values = [self._features.values(View(view)) for view in views]
        errors = np.array([self._features.error(s, values[0], self.config.symmetric_target) for s in values])
        poses = [self._goal_pose.of(e, None) for e in errors]
        return errors, None if poses[0] is None else np.array(poses)

    def averaged(self, first, views, q) -> Reference:
        """The mean `Reference` of several views of one goal: the first, others relative to it; q: (n,) their mean."""
        view = self._source.mean(views)
        s_star = np.array(self._features.values(View(view)))
        axis_B = self._kinematics.pose(q)[:3, 2].copy()
        return Reference(s_star, axis_B, self._kinematics.by_name(q), view, first.plane_C, len(views))

    def set_reference(self, reference: Reference) -> None:
        """Use a reference taught before."""
        self._law.reset(reference)
        self._goal_pose = GoalPose(self._features, reference, self.config.point_depth)
        self._s_star = np.array(reference.s_star, dtype=float)
        if self._target_motion is not None:
            self._target_motion.set_reference(reference)
        self._arm.set_reference(reference)
        posture = self._arm.posture
        self._X_CgB = None if posture is None else np.linalg.inv(self._kinematics.pose(posture))
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
        self._stop = self._make_stop_rule()
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

    def step(self, observation: Observation, dt_s: float, q=None) -> Tuple[Command, ServoRecord]:
        """Answer to one image.

        Args: observation: at this image. dt_s: time to the next image, through which the command holds [s].
            q: (n,) its joint positions, from a caller that has already found them finite; nobody changes them any more.
        """
        stamp_ns, features = observation.stamp_ns, observation.features
        if self.status == Status.IDLE:
            return Command(stamp_ns), self._record(stamp_ns, "not started", self._zeros, self._nans)
        if self.finished:
            return self._rest(stamp_ns, self.status, self._text)
        if q is None:
            q, self._q = self._kinematics.vector(observation.q), self._nans
            if q.shape != self._zeros.shape or not isfinite(sum(q.tolist())):
                return self._rest(stamp_ns, Status.FAULT,
                                  f"joint positions {q} are not {len(self._zeros)} finite numbers")
        self._q = q
        gap_s = nan if self._last_ns is None else 1e-9 * (stamp_ns - self._last_ns)
        if gap_s <= 0.0 or not 0.0 < dt_s < inf:
            return self._rest(stamp_ns, Status.STALE_INPUT, f"stamp advanced by {gap_s} s, period {dt_s} s")
        self._last_ns = stamp_ns
        if stamp_ns - self._start_ns >= 1e9 * self.config.time_limit_s:
            if self.config.track and self._below_ns is not None:
                return self._rest(stamp_ns, Status.CONVERGED, "followed to the end, every error below its threshold")
            reasons = [self._stop.why_not(), self._hindrance.words(stamp_ns), self._displaced]
            return self._rest(stamp_ns, Status.TIMED_OUT,
                              f"not converged after {self.config.time_limit_s} s: {'; '.join(filter(None, reasons))}")
        foresees = self._filter is not None and self._filter.foresees(stamp_ns) and gap_s <= self.config.input_timeout_s
        if features is None and foresees:
            return self._servo(stamp_ns, None, q, dt_s)
        if gap_s > self.config.input_timeout_s or features is None:
            text = "no image" if features is None else f"no image for {gap_s:.3f} s"
            return self._rest(stamp_ns, Status.STALE_INPUT, text)
        if self._moves.under_way and self._moves.goes_on(stamp_ns, q, gap_s):
            return self._follow(stamp_ns, dt_s)
        text = self._source.why_lost(features)
        if text and foresees:
            return self._servo(stamp_ns, None, q, dt_s)
        if text:
            return self._without_target(stamp_ns, q, dt_s, text)
        if not self._lost.found(stamp_ns):
            return self._without_target(stamp_ns, q, dt_s, "", visible=True)
        return self._servo(stamp_ns, features, q, dt_s)

    def _servo(self, stamp_ns, features, q, dt_s):
        """One look at valid features; at None where the filter has to foresee them."""
        look_then_move, law, X_BC = self.config.mode == "look_then_move", self._law, self._kinematics.pose(q)
        tracker, seen = self._filter, features is not None
        try:
            plane = self._plane(X_BC) if law.needs_plane or tracker is not None else None
            if tracker is not None:
                features = tracker.at(stamp_ns, X_BC, features, plane).features
            view = View(features, plane)
            X_CgC = self._displacement(X_BC) if law.needs_pose else None
            answer = law.step(Look(view, 0.0 if look_then_move else dt_s, X_CgC, self._applied, tracker))
            twist = answer.twist
        except NotFiniteError as error:
            return self._rest(stamp_ns, Status.FAULT, f"not finite: {error}")
        except DegenerateFeature as error:
            return self._without_target(stamp_ns, q, dt_s, str(error))
        except Exception as error:  # a law or feature of somebody else: the arm must stand still, whatever it raises
            return self._rest(stamp_ns, Status.FAULT, f"law '{law.name}': {type(error).__name__}: {error}")
        if getattr(twist, "shape", None) != (6,) or not isfinite(sum(twist.tolist())):
            return self._rest(stamp_ns, Status.FAULT, f"law '{law.name}' gave a twist that is not six finite numbers")
        self._applied, self._s, self._e, self._cond_l = twist, answer.s, answer.e, answer.condition
        self._e_shown = np.array(answer.e)
        if seen:
            self._lost.servoed(q, features)
        if self._lost.recoveries:
            twist = twist * self._lost.factor
        gain, target_C = self.config.tilt_gain_per_s, None
        if gain > 0.0 and not self._features.sees_tilt:
            target_C = features.xn, features.yn, features.an
        below, ended = self._judge(stamp_ns, X_BC, answer, target_C is not None) if seen else (False, None)
        if ended is not None:
            return ended
        self.status, self._text = Status.SERVOING, "servoing"
        if not seen:
            self._stop.clear()
            self._below_ns, self._displaced = None, ""
            self._text = f"servoing on foreseen features, target not seen for {tracker.unseen_s(stamp_ns):.2f} s"
        if self._displaced:
            self._text = f"servoing; {self._displaced}"
        close = self._stop.close
        if self._creeps and close and not look_then_move:
            if self._stop.resting and answer.settled:
                twist, target_C, self._text = np.zeros(6), None, "resting"
            if (calm := self._stop.calm(min(self._law.gains_per_s))) != 1.0:
                twist = twist * calm
            gain *= self._stop.calm(gain) if gain > 0.0 else 1.0
        if self._target_motion is not None:
            twist = twist + self._target_motion.twist(stamp_ns, X_BC, self._s, self._e)
        if look_then_move:
            return self._rest_until_held(stamp_ns) if below else self._plan(stamp_ns, q, X_BC, twist, target_C, dt_s)
        jacobian, inverse = self._arm.at(q)
        self._manipulability = inverse.manipulability
        if target_C is not None:
            twist = twist + self._arm.tilt(X_BC, inverse, -expm1(-gain * dt_s) / dt_s, target_C)
        if self.config.visibility is not None and seen:
            twist, bent = keep_in_view(self.config.visibility, features, twist)
            self._text = "servoing, kept in view" if bent else self._text
        if self._creeps and close:
            twist = twist + self._creep.correction(twist, X_BC, dt_s)
        else:
            self._creep.clear()
        if law.moves_joints:
            try:
                arm = Arm(**self._arm.as_seen(q, X_BC, twist, jacobian, inverse, dt_s))
                joints = law.joint_velocity(view, arm, twist)
            except DegenerateFeature as error:
                return self._without_target(stamp_ns, q, dt_s, str(error))
            except Exception as error:  # as above
                return self._rest(stamp_ns, Status.FAULT, f"law '{law.name}': {type(error).__name__}: {error}")
            q_dot, self._twist, status, text = self._arm.told(joints.q_dot, jacobian, joints.status, joints.text)
            self._text = text or self._text
        else:
            q_dot, self._twist, status, text = self._arm.joint_velocity(q, twist, jacobian, inverse, dt_s)
        if status is not None:
            self.status, self._text = status, text
            self._hindrance.seen(stamp_ns, text)
        self._applied = self._twist
        if tracker is not None:
            tracker.commanded(stamp_ns, self._twist)
        velocity = self._kinematics.by_name(q_dot)
        return Command(stamp_ns, {}, velocity), self._record(stamp_ns, self._text, q_dot, self._nans)

    def _judge(self, stamp_ns, X_BC, answer, holds_tilt):
        """Judge this image: (whether all errors are below their thresholds, the answer that ends the servo or None)."""
        tilt = self._arm.tilt_of(X_BC) if holds_tilt else None
        pose = answer.pose if answer.pose is not None else self._goal_pose.of(self._e_shown, tilt)
        of_law = answer.pose is not None
        arrived = self._stop.arrived(stamp_ns, self._e, tilt, pose, X_BC, of_law) and answer.settled
        published = self.config.stop.rule == "published"
        self._displaced = self._displaced_target(X_BC, pose) if self._stop.close else ""
        if published:
            below = answer.settled and all([abs(e) < most for e, most in zip(self._e, self.config.thresholds)])
        else:
            below = answer.settled and not self._stop.lacking
        if not below:
            self._below_ns = None
        elif self._below_ns is None:
            self._below_ns = stamp_ns
        if self.config.track or not below:
            return below, None
        if published and stamp_ns - self._below_ns >= 1e9 * self.config.hold_s:
            return below, self._arrive(stamp_ns, Status.STOPPED_BY_RULE, "stopped by the published rule")
        if arrived and not published:
            return below, self._arrive(stamp_ns, Status.CONVERGED, "features, tilt and pose within their thresholds")
        return below, None

    def _arrive(self, stamp_ns, status, text):
        return self._rest(stamp_ns, status, f"{text}; {self._displaced}" if self._displaced else text)

    def _displaced_target(self, X_BC, pose):
        """How far from where it was taught the target is found, in words: see `displaced_target`."""
        if self.follows or self._X_CgB is None or self.config.symmetric_target:
            return ""
        return displaced_target(self._displacement(X_BC), pose, self.config.stop)

    def _plane(self, X_BC):
        """(A, B, C) of the target, at rest, in the frame of a camera at X_BC: the taught one, moved there (T21)."""
        if self.reference.plane_C is None:
            raise ParameterError("the reference holds no plane: teach it again")
        X_CgC = self._displacement(X_BC)
        return (self.reference.plane_C @ X_CgC[:3, :3]) / (1.0 - self.reference.plane_C @ X_CgC[:3, 3])

    def plane_at(self, q):
        """(3,) plane (A, B, C) of the target, at rest, in the frame of the camera at joint positions q [1/m].

        Raises ParameterError: nothing was taught, or the reference does not tell where the target is.
        """
        if self.reference is None:
            raise ParameterError("servo: no reference, teach one first")
        return self._plane(self._kinematics.pose(self._kinematics.vector(q)))

    def _displacement(self, X_BC):
        """X_CgC, (4, 4): a camera pose by the kinematics, relative to the goal's."""
        if self._X_CgB is None:
            raise ParameterError("the reference holds no posture: teach it again")
        return self._X_CgB @ X_BC

    def _without_target(self, stamp_ns, q, dt_s, text, visible=False):
        """TARGET_LOST: the arm holds still, or does what `on_lost` says until the target is found again."""
        self._applied = None
        recovery = self._lost.step(stamp_ns, q, dt_s, visible)
        if recovery is None:
            return self._rest(stamp_ns, Status.TARGET_LOST, text)
        if recovery.gave_up:
            return self._rest(stamp_ns, Status.STOPPED, recovery.text)
        command, record = self._rest(stamp_ns, Status.TARGET_LOST, recovery.text)
        self._moves.shift(recovery.q_dot * dt_s)
        command.velocity = self._kinematics.by_name(recovery.q_dot)
        record.q_dot, record.twist = recovery.q_dot, recovery.twist
        return command, record

    # --- look then move -----------------------------------------------------------------------------------------

    def _plan(self, stamp_ns, q, X_BC, twist, target_C, dt_s):
        """Begin the move that one look asks for."""
        self._stop.clear()
        self._twist, self._manipulability, joint = self._moves.plan(stamp_ns, q, X_BC, twist, target_C)
        if joint is not None:
            self.status, self._text = Status.JOINT_LIMIT, f"joint '{joint}' at its limit"
            self._hindrance.seen(stamp_ns, self._text)
        return self._follow(stamp_ns, dt_s)

    def _follow(self, stamp_ns, dt_s):
        """Command of the move under way."""
        set_point, q_dot = self._moves.follow(stamp_ns, dt_s)
        by_name = self._kinematics.by_name
        if self.status not in _MOVING_STATUSES:
            self.status, self._text = Status.SERVOING, "moving"
        record = self._record(stamp_ns, self._text, q_dot, set_point)
        return Command(stamp_ns, by_name(set_point), by_name(q_dot)), record

    def _rest_until_held(self, stamp_ns):
        self._twist = np.zeros(6)
        record = self._record(stamp_ns, "holding", self._zeros, self._nans)
        return Command(stamp_ns, {}, dict(self._no_velocity)), record

    # --- common -------------------------------------------------------------------------------------------------

    def _clear(self, stamp_ns, set_point):
        self._text = self._displaced = ""
        self._hindrance.clear()
        self._start_ns, self._last_ns, self._below_ns = stamp_ns, None, None
        self._moves.clear(set_point)
        self._lost.clear()
        if self._target_motion is not None:
            self._target_motion.clear()
        if self._filter is not None:
            self._filter.clear()
        self._arm.rest()
        self._forget()
        self._q, self._applied = self._nans, None

    def _forget(self):
        self._stop.clear()
        self._creep.clear()
        self._s = self._e = (nan,) * len(self._features)
        self._e_shown = np.array(self._e)
        self._twist, self._manipulability, self._cond_l = np.zeros(6), nan, nan

    def _rest(self, stamp_ns, status, text):
        """Zero velocity. The record of CONVERGED keeps s and e; every other one has nothing to show."""
        if status not in FINAL:
            self._below_ns = None
            self._forget()
        self._twist, self._applied = np.zeros(6), None
        if self._filter is not None:
            self._filter.commanded(stamp_ns, self._twist)
        self._arm.rest()
        self.status, self._text = status, text
        if not self._moves.under_way:
            return Command(stamp_ns, {}, dict(self._no_velocity)), self._record(stamp_ns, text, self._zeros, self._nans)
        set_point = self._moves.break_off(stamp_ns)
        record = self._record(stamp_ns, text, self._zeros, set_point)
        return Command(stamp_ns, self._kinematics.by_name(set_point), dict(self._no_velocity)), record

    def _record(self, stamp_ns, text, q_dot, set_point):
        return ServoRecord(
            stamp_ns, self.status, text, "servo", self.status == Status.CONVERGED, self._features.names,
            np.array(self._s), self._s_star, self._e_shown, self._twist, self._kinematics.joint_names, self._q,
            q_dot, set_point, self._manipulability, self._cond_l, *self._stop.judged,
        )  # fmt: skip
