"""The servo: one observation in, one joint command and one record out. No ROS, no wall time, no random numbers.

    servo = Servo(kinematics, scenario["servo"])
    servo.teach(features, q, z_star_m)           # this view, the target z_star_m away, is the goal
    servo.start(stamp_ns)                        # or start(stamp_ns, set_point=q_last_commanded)
    command, record = servo.step(Observation(stamp_ns, features, q), dt_s)
    ... until servo.finished

Each image passes through the stages that `pipeline.py` lists: gates first, which stop the arm on data that is missing,
invalid, late or not finite; then the stages that make the twist; then the arm. `stage.py` says what a stage is.
"""

from dataclasses import replace
from math import nan
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..arm.motion import ArmMotion
from ..config.plugins import described
from ..features.base import View
from ..features.sources.base import Source
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError
from ..ground.types import FINAL, Command, Observation, Reference, ServoRecord, Status
from ..laws.look import Answer
from .goal import Goal
from .pipeline import make_stages
from .settings import ServoSettings
from .stage import UNKNOWN, Tick


class Servo:
    """Drives the camera to the taught view.

    Attributes:
        settings: `ServoSettings` of the scenario.  config: those in use (`configure`).
        goal: `Goal`, which teaches views and holds the reference.
    """

    def __init__(self, kinematics: RobotKinematics, config: Union[Mapping, ServoSettings]) -> None:
        """Args: kinematics: `Kinematics`. config: the scenario's section `servo` (dict), or the `settings` of another
        servo of these joints. Raises ParameterError."""
        self.settings = self.config = (config if isinstance(config, ServoSettings)
                                       else ServoSettings.from_dict(config, kinematics.joint_names))
        self._kinematics, self.goal = kinematics, Goal(kinematics, self.config)
        self._arm = ArmMotion(kinematics, self.config, self.goal.features.sees_tilt)
        nothing, self._nans = (nan,) * len(self.goal.features), np.full(len(kinematics.joint_names), nan)
        self._no_answer, self._start_ns = Answer(np.zeros(6), nothing, nothing, nan, False), 0
        self._stages, self._lost, self._hindrance = make_stages(self.goal, self._arm, self.config, 0)
        self._tick = Tick(0, 0.0, None, self._nans, self._no_answer)

    @property
    def reference(self) -> Optional[Reference]:
        """The goal as taught, or None."""
        return self.goal.reference

    @property
    def status(self) -> Status:
        """`Status` of the last step."""
        return self._tick.status

    @property
    def finished(self) -> bool:
        """True when only start() moves again (CONVERGED, STOPPED_BY_RULE, TIMED_OUT, STOPPED or FAULT; OUT_OF_REACH
        after `servo.out_of_reach.rest_s`)."""
        return self.status in FINAL or self._tick.over

    @property
    def feature_names(self) -> Tuple[str, ...]:
        """Names of s, s_star and e."""
        return self.goal.features.names

    @property
    def source(self) -> Source:
        """Where the features come from."""
        return self.goal.source

    def why_lost(self, features: Optional[Any]) -> str:
        """Returns why the servo cannot use these features (None: there are none); an empty text if it can."""
        return self.goal.why_lost(features)

    def errors(self, features: Optional[Any]) -> np.ndarray:
        """Returns e of a view, (k,), without a step of the servo; NaN where the goal or the view does not tell it.

        Args: features: of the view; None: there are none.
        """
        goal = self.goal
        if goal.reference is not None and not self.why_lost(features):
            symmetric = getattr(features, "symmetric", False) or self.config.symmetric_target
            try:
                return np.array(goal.features.error(goal.features.values(View(features)), goal.s_star, symmetric))
            except DegenerateFeature:
                pass
        return np.full(len(goal.features), nan)

    def split(self, q: np.ndarray, q_dot: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Returns ((n,), (n,)): the parts of q_dot at q that move the camera, and that stay in the null space."""
        return self._arm.split(q, q_dot)

    def configure(self, law: str = "", gains_per_s: Sequence[float] = (), thresholds: Sequence[float] = (),
                  time_limit_s: float = 0.0) -> None:
        """Overrides the scenario's values from the next start on; empty or 0 takes the scenario's. ParameterError."""
        self.config = self.settings.with_overrides(law, gains_per_s, thresholds, time_limit_s)

    def retuned(self, config: Mapping) -> "Servo":
        """Returns a servo with other settings that goes on where this one is: same goal, time limit and state.

        Args: config: the scenario's section `servo` (dict). Raises: ParameterError: a fault of it, or the goal was
        taught for features that do not tell what the new ones need.
        """
        servo = Servo(self._kinematics, config)
        if self.reference is None:
            return servo
        if servo.source is not self.source:
            raise ParameterError(f"features: found {', '.join(servo.feature_names)}, which another source makes; "
                                 "allowed before the next reset: features of the source that the goal was taught with")
        reference = self.reference
        if servo.feature_names != self.feature_names:
            values = servo.goal.features.values(View(reference.view))
            reference = replace(reference, s_star=np.array(values, dtype=float))
        servo.set_reference(reference)
        if self.status != Status.IDLE:
            servo.start(self._start_ns)
            servo._tick = servo._tick.set(status=self.status, text=self._tick.text, over=self._tick.over)
        return servo

    def teach(self, features: Any, q: Any, z_star_m: float) -> Reference:
        """Makes a view the goal. Args and errors: those of `Goal.taught_by`."""
        reference = self.goal.taught_by(features, q, z_star_m)
        self.set_reference(reference)
        return reference

    def set_reference(self, reference: Reference) -> None:
        """Uses a reference taught before."""
        for stage in self._stages:
            stage.set_reference(reference)
        self.goal.set_reference(reference)
        self._arm.set_reference(reference)

    def start(self, stamp_ns: int, set_point: Any = None) -> None:
        """Begins servoing.

        Args: stamp_ns: start of the time limit. set_point: joint set-points last commanded, by name or as an array
        (look_then_move moves them; default: the positions measured at the first step).
        Raises: ParameterError without a reference.
        """
        if self.reference is None:
            raise ParameterError("servo: no reference, teach one first")
        self._start_ns, set_point = stamp_ns, None if set_point is None else self._kinematics.vector(set_point)
        made = make_stages(self.goal, self._arm, self.config, stamp_ns, set_point)
        self._stages, self._lost, self._hindrance = made
        for stage in self._stages:
            stage.set_reference(self.reference)
        self._arm.rest()
        self._tick = Tick(stamp_ns, 0.0, None, self._nans, self._no_answer, status=Status.SERVOING)

    def stop(self, stamp_ns: int, reason: str = "stopped") -> Tuple[Command, ServoRecord]:
        """Ends servoing: zero velocity, STOPPED."""
        return self._rest(self._tick.set(stamp_ns=stamp_ns, set_point=None).rest(Status.STOPPED, reason))

    def stale(self, stamp_ns: int, reason: str) -> Tuple[Command, ServoRecord]:
        """Watchdog: input is late. Zero velocity, STALE_INPUT; servoing goes on with the next step."""
        tick, over = self._tick.set(stamp_ns=stamp_ns, set_point=None), self.finished or self.status == Status.IDLE
        return self._rest(tick.rest(tick.status, tick.text) if over else tick.rest(Status.STALE_INPUT, reason))

    def step(self, observation: Observation, dt_s: float,
             q: Optional[np.ndarray] = None) -> Tuple[Command, ServoRecord]:
        """Answers one image.

        Args: observation: at this image. dt_s: time to the next image, through which the command holds [s].
            q: (n,) its joint positions, from a caller that has them as an array and never changes it.
        """
        if self.status == Status.IDLE:
            tick = self._tick.set(stamp_ns=observation.stamp_ns, text="not started")
            return Command(tick.stamp_ns), self._record(tick.rest(tick.status, tick.text))
        if self.finished:
            return self.stale(observation.stamp_ns, "")
        q = self._kinematics.vector(observation.q) if q is None else q
        tick = self._tick.next(observation, q, dt_s)
        try:
            for stage in self._stages:
                after = stage.apply(tick)
                decided, tick = after.q_dot is not None, after
                if decided:
                    break
        except DegenerateFeature as error:
            tick = self._lost.recover(tick, str(error))
        except NotFiniteError as error:
            tick = tick.rest(Status.FAULT, f"not finite: {error}")
        except (Exception, SystemExit) as error:  # a law, feature or stage of a plugin: the arm must stand still
            tick = tick.rest(Status.FAULT, f"{stage.title}: {described(error)}")
        return self._rest(tick) if tick.rests else self._answer(tick)

    def _rest(self, tick: Tick) -> Tuple[Command, ServoRecord]:
        """Stops the arm. Only the end of the servo keeps s and e; otherwise there is nothing to show."""
        self._arm.rest()
        for stage in self._stages:
            tick = stage.rest(tick)
        if tick.status not in FINAL and not tick.over:
            tick = tick.set(answer=self._no_answer, manipulability=nan, judged=UNKNOWN)
        return self._answer(tick)

    def _answer(self, tick: Tick) -> Tuple[Command, ServoRecord]:
        self._tick, by_name = self._hindrance.note(tick), self._kinematics.by_name
        position = {} if tick.set_point is None else by_name(tick.set_point)
        return Command(tick.stamp_ns, position, by_name(tick.q_dot)), self._record(tick)

    def _record(self, tick: Tick) -> ServoRecord:
        set_point = self._nans if tick.set_point is None else tick.set_point
        return ServoRecord(
            tick.stamp_ns, tick.status, tick.text, "servo", tick.status == Status.CONVERGED, self.feature_names,
            np.array(tick.answer.s), self.goal.s_star, np.array(tick.answer.e), tick.twist,
            self._kinematics.joint_names, tick.q, tick.q_dot, set_point, tick.manipulability, tick.answer.condition,
            *tick.judged,
        )  # fmt: skip
