"""The experiment as a state machine: one `Observation` per image in, one `Command` per image out.

    idle -> to_goal -> settle_goal -> teach -> to_start -> settle_start -> servo -> done      start()
    idle -> servo -> done                                                                     start(servo_only=True)
    idle -> to_start -> settle_start -> servo -> done                                         start(again=True)

In to_goal and to_start the joints follow quintic trajectories. settle_* lasts at least settle_s, and then until the
joints rest. teach lasts two images or more, whose mean view becomes the reference. In servo, `Servo` answers until it
has finished. The image that ends a phase is already answered in the next phase. The answers depend on the observations
alone, so that a run in process and one over ROS give the same bytes.
"""

from dataclasses import dataclass, replace
from math import inf, isfinite, nan
from typing import Any, Callable, Mapping, Optional, Tuple

import numpy as np

from ..config.plugins import code_place, described
from ..servo.servo import Servo
from ..arm.kinematics import RobotKinematics
from ..ground.errors import ArasError, ParameterError
from ..arm.trajectory import JointTrajectory
from ..ground.types import Command, JointPositions, Observation, ServoRecord, Status
from .settings import ExperimentSettings
from .teaching import Teaching


#: While the goal is taught and after the end the joints are held where they are: each velocity is this times the way
#: back [1/s]. Set-points that stand still would not do, since the integrators of joint controllers go on working off
#: friction.
HOLD_PER_S = 2.0
#: A joint that is farther than this from where it is held is moved from outside, and is released [m, rad].
STRAY = 0.005
#: Ends after which that is done.
HELD = (Status.CONVERGED, Status.SETTLED, Status.STOPPED_BY_RULE)


@dataclass
class SequenceResult:
    """How an experiment ended: the result of VisualServo.action."""

    converged: bool
    status: Status
    reason: str
    e: np.ndarray  # (k,) final feature error, NaN when never servoed
    duration_s: float  # simulated seconds of servoing


class ExperimentSequence:
    """Runs the scenario's experiment.

    Attributes:
        kinematics, servo: as given.  phase: one of types.PHASES.  result: `SequenceResult`, None until done.
        holds: whether the joints are held by velocities while a goal is taught and after the end; an arm whose own
            controllers hold it needs none.
        teach_stamp_ns: stamp of the image that was taught, or None.  servo_stamp_ns: that of the first servo image.
    """

    def __init__(self, kinematics: RobotKinematics, servo: Servo, config: Mapping,
                 teach_camera: Callable[[int, float], None]) -> None:
        """Set up.

        Args:
            kinematics: `Kinematics`.  servo: `Servo`.  config: the scenario's section `experiment` (dict), or
                `ExperimentSettings` of it.
            teach_camera: called as teach_camera(stamp_ns, z_star_m) when a view is taught. From then on features are
                relative to the image of this stamp. Over ROS this is the service camera/set_reference, in process
                `teach` of the extractors. An exception that it raises ends the experiment with status FAULT.
        Raises: ParameterError.
        """
        self.config = (config if isinstance(config, ExperimentSettings)
                       else ExperimentSettings.from_dict(config, kinematics))
        self.kinematics, self.servo, self._teach_camera = kinematics, servo, teach_camera
        self._no_velocity = dict.fromkeys(kinematics.joint_names, 0.0)
        self._n, self.holds = len(kinematics.joint_names), True
        self._nans, self._no_features = np.full(self._n, nan), np.full(len(servo.feature_names), nan)
        self._reset("idle")

    def _reset(self, phase):
        self.phase = phase
        self.result: Optional[SequenceResult] = None
        self.teach_stamp_ns = self.servo_stamp_ns = None
        self._last_ns = self._since_ns = self._trajectory = self._set_point = self._before_q = self._last_q = None
        self._teaching = self._held_q = None
        self._e = self._no_features
        self._dt_s = self.config.image_period_s

    def use(self, servo: Servo) -> None:
        """Goes on with another servo, which has the goal of the one before it (`Servo.retuned`)."""
        self.servo, self._e = servo, np.full(len(servo.feature_names), nan)

    @property
    def done(self) -> bool:
        """True once `result` is there."""
        return self.phase == "done"

    def start(self, servo_only: bool = False, again: bool = False) -> None:
        """Begins with the next step.

        Args: servo_only: from here, to the reference taught last.  again: to the same reference, from the start.
        Raises: ParameterError: one of the two without a reference.
        """
        if (servo_only or again) and self.servo.reference is None:
            raise ParameterError("servo: no reference, teach one first")
        self._reset("settle_start" if servo_only else "to_start" if again else "to_goal")
        self._servo_only = servo_only

    def teach(self, stamp_ns: int, features: Any, q: JointPositions, z_star_m: Optional[float] = None) -> None:
        """Makes the image of this stamp the goal of the servo, and the reference of the camera's features.

        Args: features, q: of this image.  z_star_m: depth of the target in it [m]; None: the experiment's.
        Raises: ParameterError: the view is not fit to be a reference; and the errors of `teach_camera`.
        """
        self._begin_teaching(stamp_ns, features, q, z_star_m)
        self._teaching = None

    def teach_more(self, stamp_ns: int, features: Any, q: JointPositions, z_star_m: Optional[float] = None) -> bool:
        """As `teach`, from several images in turn. Returns True when the goal is taught; until then, call it again."""
        if self._teaching is None:
            self._begin_teaching(stamp_ns, features, q, z_star_m)
            self._held_q = self.kinematics.vector(q)
        else:
            self._teaching.add(features, q)
        if not self._teaching.done:
            return False
        self.servo.set_reference(self._teaching.reference)
        self._teaching = self._held_q = None
        return True

    def _begin_teaching(self, stamp_ns, features, q, z_star_m):
        z_star_m = self.config.z_star_m if z_star_m is None else z_star_m
        self._teaching = Teaching(self.servo, stamp_ns, features, q, z_star_m, self.config.teach_images,
                                  self.config.still)
        self._teach_camera(stamp_ns, z_star_m)
        self.servo.set_reference(self._teaching.reference)

    def step(self, observation: Observation) -> Tuple[Command, ServoRecord]:
        """Answers to one image. Idle and done: an empty command (pure acknowledgement, set-points hold); after the
        servo has arrived, velocities that hold the joints where they were (`HOLD_PER_S`)."""
        stamp_ns = observation.stamp_ns
        if self.phase in ("idle", "done"):
            text = self.phase if self.result is None else self.result.reason
            return self.hold(observation), self._record(stamp_ns, self._nans, text)
        if self._last_ns is not None and stamp_ns > self._last_ns:
            self._dt_s = 1e-9 * (stamp_ns - self._last_ns)
        try:
            q = self.kinematics.vector(observation.q)
            if q.shape != (self._n,) or not isfinite(sum(q.tolist())):
                raise ParameterError(f"joint positions {q} are not {self._n} finite numbers")
            self._last_ns, self._before_q, self._last_q = stamp_ns, self._last_q, q
            return self._advance(observation, q)
        except ArasError as error:
            return self._end(stamp_ns, Status.FAULT, f"{self.phase}: {error}")

    def hold(self, observation: Observation) -> Command:
        """Velocities that hold the joints where they were in the first image of a view that is being taught, or in that
        with which the servo arrived; an empty command where there is neither."""
        if self._held_q is None or not self.holds:
            return Command(observation.stamp_ns)
        q = self.kinematics.vector(observation.q)
        if q.shape != (self._n,) or not isfinite(sum(q.tolist())):
            return Command(observation.stamp_ns, velocity=dict(self._no_velocity))
        way = self.kinematics.way(q, self._held_q)
        if np.abs(way).max() > STRAY:
            self._held_q = None
            return Command(observation.stamp_ns, velocity=dict(self._no_velocity))
        q_dot = HOLD_PER_S * way
        return Command(observation.stamp_ns, velocity=self.kinematics.by_name(q_dot))

    def stop(self, stamp_ns: int, reason: str = "stopped") -> Tuple[Command, ServoRecord]:
        """Ends now with status STOPPED; the command returned stops the arm."""
        self._held_q = None
        if self.phase == "servo":
            self.servo.stop(stamp_ns, reason)
        return self._end(stamp_ns, Status.STOPPED, reason)

    # --- phases -------------------------------------------------------------------------------------------------

    def _advance(self, observation, q):
        if self.phase == "servo":
            return self._servo_step(observation, q)
        stamp_ns = observation.stamp_ns
        if self.phase in ("to_goal", "to_start"):
            if self._trajectory is None:
                self._plan(stamp_ns, q, (self.config.goal if self.phase == "to_goal" else self.config.start).joints)
            if stamp_ns - self._since_ns < 1e9 * self._trajectory.duration_s:
                return self._follow(stamp_ns)
            self.phase = self.phase.replace("to_", "settle_")
            self._since_ns = stamp_ns
        settling = self.phase in ("settle_goal", "settle_start") and self._trajectory is not None
        if settling:
            if not self._settled(stamp_ns):
                return self._follow(stamp_ns)
            held = self._held_joint(q)
            if held:
                return self._end(stamp_ns, Status.FAULT, f"{self.phase}: {held}")
        if self.phase in ("settle_goal", "teach"):
            return self._teach(observation, q)
        if self.phase == "settle_start":
            if self.servo.why_lost(observation.features):
                where = "where servoing starts" if self._servo_only else "at the start"
                return self._end(stamp_ns, Status.TARGET_LOST, f"target not in view {where}")
            self.phase, self.servo_stamp_ns = "servo", stamp_ns
            self.servo.start(stamp_ns, self._set_point)
        return self._servo_step(observation, q)

    def _plan(self, stamp_ns, q, joints):
        begin = q if self._set_point is None else self._set_point
        end = self.kinematics.vector({**self.kinematics.by_name(begin), **joints})
        velocity = self.config.speed_part * self.kinematics.velocity
        self._trajectory = JointTrajectory(self.kinematics, begin, end, velocity, self.config.acceleration)
        self._since_ns = self._begin_ns = stamp_ns

    def _follow(self, stamp_ns):
        t_s = 1e-9 * (stamp_ns - self._begin_ns)
        self._set_point, q_dot = self._trajectory.step(t_s, self._dt_s)
        by_name = self.kinematics.by_name
        return Command(stamp_ns, by_name(self._set_point), by_name(q_dot)), self._record(stamp_ns, q_dot, self.phase)

    def _settled(self, stamp_ns):
        waited_s = 1e-9 * (stamp_ns - self._since_ns) - self.config.settle_s
        return waited_s >= 0.0 and (waited_s >= self.config.settle_limit_s or self._speed() < self.config.settle_speed)

    def _speed(self):
        """Of the fastest joint between the last two images [m/s or rad/s], inf before there were two."""
        if self._before_q is None:
            return inf
        return float(np.abs(self.kinematics.way(self._before_q, self._last_q)).max()) / self._dt_s

    def _held_joint(self, q):
        """Returns a text that names the joint farthest from its end position; "" if all arrived."""
        off = np.abs(self.kinematics.way(self._trajectory.position(inf), q))
        joint = int(off.argmax())
        if off[joint] <= self.config.arrived_within:
            return ""
        name, end = self.kinematics.joint_names[joint], self._trajectory.position(inf)[joint]
        return f"joint '{name}' was sent to {end:.4g} and rests at {q[joint]:.4g}, allowed within " \
               f"{self.config.arrived_within:g}: check for an obstacle or too little effort"

    def _teach(self, observation, q):
        stamp_ns = observation.stamp_ns
        self.phase = "teach"
        first = self._teaching is None
        if first and self.servo.why_lost(observation.features):
            return self._end(stamp_ns, Status.TARGET_LOST, "target not in view at the goal")
        try:
            taught = self.teach_more(stamp_ns, observation.features, q)
        except Exception as error:  # the callback may be a service call: whatever it raises is the reason
            return self._end(stamp_ns, Status.FAULT, f"teach: {described(error) if code_place(error) else error}")
        if first:
            self.teach_stamp_ns = stamp_ns
        if not self.holds:
            answer = self._follow(stamp_ns)
        else:
            command = Command(stamp_ns, velocity=dict(self._no_velocity)) if taught else self.hold(observation)
            answer = command, self._record(stamp_ns, self.kinematics.vector(command.velocity), "teach")
        if taught:
            self.phase, self._trajectory = "to_start", None
        return answer

    def _servo_step(self, observation, q):
        command, record = self.servo.step(observation, self._dt_s, q)
        if isfinite(sum(record.e.tolist())):
            self._e = record.e
        if not self.servo.finished:
            return command, record
        _, last = self._end(observation.stamp_ns, record.status, record.status_text)
        if record.status in HELD:
            self._held_q = q
        return command, replace(record, phase=last.phase)

    def _end(self, stamp_ns, status, reason):
        since = stamp_ns if self.servo_stamp_ns is None else self.servo_stamp_ns
        self.result = SequenceResult(status == Status.CONVERGED, status, reason, self._e, 1e-9 * (stamp_ns - since))
        self.phase = "done"
        position = {}
        if self._trajectory is not None and self._set_point is not None and self.servo_stamp_ns is None:
            # The trajectory ends at the set-point that it has now.
            self._set_point = self._trajectory.position(1e-9 * (stamp_ns - self._begin_ns))
            position = self.kinematics.by_name(self._set_point)
        return Command(stamp_ns, position, dict(self._no_velocity)), self._record(stamp_ns, np.zeros(self._n), reason)

    def _record(self, stamp_ns, q_dot, text):
        status = Status.IDLE if self.result is None else self.result.status
        q = self._nans if self._last_q is None else self._last_q
        set_point = self._nans if self._set_point is None else self._set_point
        none = self._no_features
        return ServoRecord(
            stamp_ns, status, text, self.phase, status == Status.CONVERGED, self.servo.feature_names, none, none,
            self._e, joint_names=self.kinematics.joint_names, q=q, q_dot=q_dot, set_point=set_point,
        )  # fmt: skip
