"""The whole servo loop in one process: simulator, moments, sequence. No ROS; results do not depend on wall time.

The nodes call the same objects in the same order, and in lockstep they give the same bytes (tests/ros).
"""

import time
from typing import TYPE_CHECKING, Any, Callable, Iterator, NamedTuple, Optional, Tuple

import numpy as np

from ..features.sources.base import source_named
from ..ground.errors import ParameterError
from ..ground.types import Observation, Reference, ServoRecord, Status
from ..servo.servo import Servo
from .cell import SimulatedCell
from .record import RecordBuilder, RunRecord
from .sequence import ExperimentSequence

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario
    from aras_visual_servo_sim import Simulation

#: Simulated time for which a run goes on after its end, with the arm at rest [s]. Over ROS the simulator cannot be
#: paused at once, and a run over ROS and one in process must end at the same tick to have the same run hash.
CLOSING_S = 2.0
#: Simulated time after which `run` gives up on an experiment that does not end by itself [s].
DEFAULT_LIMIT_S = 300.0
PROGRESS_ROWS = 30
#: Source whose features are in the record and drawn into the video, also when the servo works on another source.
SHOWN = "moments"
#: A goal that takes more images than this to teach has noisy images. It is not kept but taught again in each run.
KEPT_IMAGES = 2


class TaughtGoal(NamedTuple):
    """The state of a loop right after it has taught its goal. `ServoLoop.begin_again` goes on from it.

    Attributes:
        state: of the simulator.  reference: of the servo.  z_star_m: depth of the target in this view [m].
        answers: arguments of `RecordBuilder.add_answer` for each image: (record, X_WC, features, image, X_WT).
    """

    state: bytes
    reference: Optional[Reference]
    z_star_m: Optional[float]
    answers: tuple


class ServoLoop(SimulatedCell):
    """Simulator, moment extractor and experiment in one process; arguments and errors are those of `SimulatedCell`.

    >>> loop = ServoLoop(load_scenario("experiment_1"))
    >>> record = loop.run()

    In one step the simulator advances to the next image and renders it, the extractor computes its features, and the
    sequence answers with a command. The simulator applies the command from the state that the image shows.

    Attributes:
        extractor: makes the moments that the record shows.
        servo_extractor: makes the features that the servo works on; where these are moments, it is `extractor`.
        frame: index of the image answered last, -1 before the first.
        seen: the last answered `Observation`, None before the first.
    """

    def __init__(self, scenario: "Scenario", camera: Optional[str] = None, sim: Optional["Simulation"] = None) -> None:
        super().__init__(scenario, camera, sim)
        self._believed = scenario.believed_camera_info(self.camera_info)
        self.servo = Servo(self.kinematics, scenario.servo)
        self._sources = source_named(SHOWN), self.servo.source
        self._want_depth = [source.wants_depth(scenario.vision) for source in self._sources]
        self.extractor: Any = None
        self.servo_extractor: Any = None
        self._renew_extractors()
        self._begin(scenario.experiment)

    def _renew_extractors(self):
        """Makes an extractor for each source. One that was used before is cleared and used again, if its source can."""
        def renewed(source, used):
            return used and source.renewed(used) or source.extractor(self._believed, self.scenario.vision)

        shown, servoed_on = self._sources
        self.extractor = renewed(shown, self.extractor)
        self.servo_extractor = self.extractor if servoed_on is shown else renewed(servoed_on, self.servo_extractor)

    def _begin(self, experiment: Any) -> None:
        self.sequence = ExperimentSequence(self.kinematics, self.servo, experiment, self._teach_camera)
        self.frame, self.seen = -1, None  # type: int, Any
        self._placed_ns = 0
        self._taught = (None, [])  # by `teach`: depth of the target, and its first answers, as in `TaughtGoal`
        self._frame = None

    def begin_again(self, scenario: "Scenario", goal: Optional[TaughtGoal] = None) -> None:
        """Becomes a loop of another scenario, which differs in `experiment` alone.

        Simulator, servo and extractors are used again, and the other sections are not read again. The bytes are those
        of a new loop.

        Args: goal: a `TaughtGoal` of this loop, of a scenario that differs in the start alone: begin where it had been
            taught, as if the arm were placed there and it were taught again.
        Raises: ParameterError: faults of the section `experiment`.  StateError (the simulator's): the goal is
            that of another simulator.
        """
        self.scenario = scenario
        if goal is None:
            experiment = scenario.experiment
            self.sim.reset()
        else:
            experiment = self.sequence.config.with_start(scenario.experiment["start"], self.kinematics)
            self.sim.restore_state(goal.state)
        self._renew_extractors()
        self._begin(experiment)
        if goal is not None:
            self._take_over(goal)

    def _teach_camera(self, stamp_ns, z_star_m):
        """Makes the image of this stamp the one that features are relative to: camera/set_reference without ROS."""
        from aras_visual_servo_camera import DegenerateFeature
        self.servo_extractor.teach(stamp_ns, z_star_m)
        if self.extractor is not self.servo_extractor:
            try:
                self.extractor.teach(stamp_ns, z_star_m)
            except DegenerateFeature:
                pass  # a texture may have no usable moments, and the servo does not need them

    def _see(self, image, stamp_ns):
        """(moments, features that the servo works on) of the image."""
        of_shown = of_servo = ()
        if any(self._want_depth):
            depth = (self.sim.render_depth(self.camera),)
            of_shown, of_servo = (depth if wanted else () for wanted in self._want_depth)
        features = self.extractor.process(image, stamp_ns, *of_shown)
        if self.extractor is self.servo_extractor:
            return features, features
        return features, self.servo_extractor.process(image, stamp_ns, *of_servo)

    def taught_goal(self) -> Optional[TaughtGoal]:
        """Returns the goal of a loop that has just taught it by `teach`, and has done nothing else but `place`.

        None where it cannot be kept: features that use depth images, and goals that take many images to teach.
        """
        z_star_m, answers = self._taught
        if any(self._want_depth) or not 0 < len(answers) <= KEPT_IMAGES:
            return None
        return TaughtGoal(self.sim.save_state(), self.servo.reference, z_star_m, tuple(answers))

    def _take_over(self, goal):
        """Bring extractors and servo to where they were when this goal had been taught."""
        for self.frame, (record, _, _, image, _) in enumerate(goal.answers):
            self._see(image, record.stamp_ns)
            if self.frame == 0:
                self._teach_camera(record.stamp_ns, goal.z_star_m)
        if self.servo.reference is not goal.reference:
            self.servo.set_reference(goal.reference)

    def teach(self, z_star_m: float) -> Iterator[Tuple[Any, ...]]:
        """Makes the next images the reference, as many as their noise asks for, outside an experiment.

        Args:
            z_star_m: depth of the target in this view [m].
        Yields:
            (record, X_WC, features, image, X_WT) of each of these images, the arguments of `RecordBuilder.add_answer`;
            the phase of the record is "teach", and the image is overwritten when the next one is taken.
        Raises:
            ParameterError: the target is not fit for a reference in this view.
        """
        taught, self._taught = False, (z_star_m, answers := [])
        while not taught:
            stamp_ns, image, q = self.take()
            features, seen = self._see(image, stamp_ns)
            self.frame += 1
            if self.servo.why_lost(seen):
                raise ParameterError("target not in view at the goal")
            taught = self.sequence.teach_more(stamp_ns, seen, q, z_star_m)
            self.sim.set_command({}, self.sequence.hold(Observation(stamp_ns, seen, q)).velocity, None, stamp_ns)
            record = ServoRecord(stamp_ns, Status.IDLE, "taught", "teach", joint_names=self.kinematics.joint_names, q=q,
                                 set_point=np.full(len(q), np.nan))
            answer = record, self.camera_pose(), features, image, self.moving_target_pose()
            if len(answers) <= KEPT_IMAGES:
                answers.append((*answer[:3], np.array(image), answer[4]))
            yield answer

    def teach_goal(self) -> None:
        """Puts the arm at the scenario's goal and makes its view the reference. Raises what `teach` raises."""
        config = self.sequence.config
        self.place(self.kinematics.by_name(self.scenario.goal_posture(self.kinematics)), config.settle_s)
        for _ in self.teach(config.z_star_m):
            pass

    def look(self) -> Any:
        """Takes one image and answers nothing. Returns the features that the servo works on."""
        stamp_ns, image, _ = self.take()
        return self._see(image, stamp_ns)[1]

    def use(self, servo: Servo) -> None:
        """Goes on with another servo, of the same kinematics and source of features."""
        self.servo = servo
        self.sequence.use(servo)

    def teach_here(self, z_star_m: float) -> None:
        """Makes the view of the image answered last the goal. Args and errors: those of `ExperimentSequence.teach`."""
        if self.seen is None:
            raise ParameterError("teach: no image has come yet")
        self.sequence.teach(self.seen.stamp_ns, self.seen.features, self.seen.q, z_star_m)

    def start(self, servo_only: bool = False, again: bool = False) -> None:
        """Begins the experiment with the next image. Args and errors: those of `ExperimentSequence.start`."""
        self.sequence.start(servo_only, again)

    def follow_anew(self) -> None:
        """Forgets which object the extractors followed in earlier images. The reference stays."""
        for extractor in (self.extractor, self.servo_extractor):
            if hasattr(extractor, "forget_previous"):  # other features follow nothing
                extractor.forget_previous()

    def step(self) -> Tuple[ServoRecord, Any, np.ndarray]:
        """Takes one image and answers it.

        Returns:
            (record, features, image): features are the extractor's moments, image is overwritten by the next step.
        """
        stamp_ns, image, q = self.take()
        features, seen = self._see(image, stamp_ns)
        self.frame += 1
        self.seen = Observation(stamp_ns, seen, q, self.frame)
        command, record = self.sequence.step(self.seen)
        self.sim.set_command(command.position, command.velocity, None, stamp_ns)
        return record, features, image

    def run(self, progress: Optional[Callable[[float, str], None]] = None, limit_s: float = DEFAULT_LIMIT_S,
            closing_s: float = CLOSING_S, keep_images: bool = False) -> RunRecord:
        """Runs the experiment from here to its end.

        Args:
            progress: called about once a simulated second with (t_s, phase), or None.
            limit_s: simulated time after which to give up [s].  closing_s: simulated time to go on after the end [s].
            keep_images: keep every image of the servo phase in the record, for a video.
        Returns: the record, one row per image.
        """
        builder = RecordBuilder(self.scenario.name, self.kinematics.joint_names, settings=self.scenario.as_dict(),
                                keep_images=keep_images, feature_names=self.servo.feature_names)
        started_s = time.perf_counter()
        self.start()
        record = self._row(builder, progress)
        while not self.sequence.done and record.stamp_ns < limit_s * 1e9:
            record = self._row(builder, progress)
        last_ns = record.stamp_ns
        if self.sequence.done:
            end_ns = record.stamp_ns + round(closing_s * 1e9)
            while self.sim.next_image_ns(self.camera) <= end_ns:  # drawn for the run hash only
                last_ns, _, q = self.take()
                self.frame += 1
                command, _ = self.sequence.step(Observation(last_ns, None, q, self.frame))
                self.sim.set_command(command.position, command.velocity, None, last_ns)
                self._tell(progress, last_ns, record.phase)
            self.sim.step(max(0, (end_ns - self.sim.time_ns) // self.sim.period_ns))
        else:
            builder.note(f"given up after {limit_s:g} s of simulated time in phase {record.phase}")
        wall_s = time.perf_counter() - started_s
        for warning in filter(lambda text: "renderer coverage does not draw" in text, self.sim.warnings):
            builder.note(warning)  # warnings about the URDF are not specific to this run
        return builder.finish(run_hash=self.sim.run_hash, wall_s=wall_s, camera_info=self.camera_info,
                              real_time_factor=1e-9 * (last_ns - builder.begin_ns) / wall_s,
                              X_WT=self.target_pose(), opengl=self.sim.opengl)

    def _row(self, builder, progress):
        record, features, image = self.step()
        builder.add_answer(record, self.camera_pose(), features, image, self.moving_target_pose())
        self._tell(progress, record.stamp_ns, record.phase)
        return record

    def _tell(self, progress, stamp_ns, phase):
        if progress is not None and self.frame % PROGRESS_ROWS == 0:
            progress(stamp_ns * 1e-9, phase)
