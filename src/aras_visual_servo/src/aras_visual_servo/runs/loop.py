"""The whole servo loop in one process: simulator, moments, sequence. No ROS; results do not depend on wall time.

The nodes call the same objects in the same order, and in lockstep they give the same bytes (tests/ros).
"""

import time
from typing import NamedTuple

import numpy as np

from ..ground.errors import ParameterError
from ..ground.images import in_rgb
from ..arm.robot import kinematics_of
from .record import RecordBuilder
from ..config.files import package_paths
from ..features.sources import source_named
from .sequence import ExperimentSequence
from ..servo.servo import Servo
from ..ground.types import Observation, Reference, ServoRecord, Status

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
        answers: tuple of what `RecordBuilder.add_answer` is told of each image: (record, X_WC, features, image, X_WT).
    """

    state: bytes
    reference: Reference
    z_star_m: float
    answers: tuple


class ServoLoop:
    """Simulator, moment extractor and experiment in one process.

    >>> loop = ServoLoop(load_scenario("experiment_1"))
    >>> record = loop.run()

    In one step the simulator advances to the next image and renders it, the extractor computes its features, and the
    sequence answers with a command. The simulator applies the command from the state that the image shows.

    Args:
        scenario: a `Scenario`.
        camera: name of the camera; None: the first of the scenario.
        sim: a Simulation made of the same robot, controllers and `sim` section, which is reset and used again; None: a
            new one is made, which takes as long as a second of simulated time. Either way the bytes are the same.
    Raises:
        ParameterError, ModelError and the errors of simulator and extractor: what is wrong with the scenario.

    Attributes:
        sim, extractor, kinematics, servo, sequence: the parts.  extractor: makes the moments that the record shows.
        servo_extractor: makes the features that the servo works on; where these are moments, it is `extractor`.
        frame: index of the image answered last, -1 before the first.
        eye_to_hand: whether the arm carries the target, and the camera stands still.
        seen: the last answered `Observation`, None before the first.
    """

    def __init__(self, scenario, camera=None, sim=None):
        from aras_visual_servo_sim import Simulation  # C++: not needed to import this

        self.scenario, urdf = scenario, scenario.urdf_xml()
        cameras = scenario.sim.get("cameras") or [{"name": "camera"}]
        self.camera = camera or cameras[0]["name"]
        if sim is None:
            sim = Simulation(urdf, scenario.sim, scenario.controllers(), package_paths())
        else:
            sim.reset()
        self.sim = sim
        self.camera_info = self.sim.camera_info(self.camera)
        self._encoding = self.sim.camera_encoding(self.camera)
        self._believed = scenario.believed_camera_info(self.camera_info)
        self.kinematics = kinematics_of(urdf, scenario.robot)
        self.eye_to_hand = scenario.robot.get("target_link") is not None
        self.servo = Servo(self.kinematics, scenario.servo)
        self._sources = source_named(SHOWN), self.servo.source
        self._want_depth = [source.wants_depth(scenario.vision) for source in self._sources]
        self.extractor = self.servo_extractor = None
        self._renew_extractors()
        target = next(iter(scenario.sim.get("scene", {}).get("models", [])), None)
        self._target = target and target["name"]
        self._target_moves = target is not None and not {"motion", "attached_to"}.isdisjoint(target)
        names = list(self.sim.joint_names)
        missing = [name for name in self.kinematics.joint_names if name not in names]
        if missing:
            raise ParameterError(f"robot: the simulator has no joint {', '.join(missing)}, it has {', '.join(names)}")
        order = [names.index(name) for name in self.kinematics.joint_names]
        self._order = None if order == list(range(len(names))) else order
        self._begin(scenario.experiment)

    def _renew_extractors(self):
        """Make an extractor for each source. One that was used before is cleared and used again, if its source can."""
        def renewed(source, used):
            return used and source.renewed(used) or source.extractor(self._believed, self.scenario.vision)

        shown, servoed_on = self._sources
        self.extractor = renewed(shown, self.extractor)
        self.servo_extractor = self.extractor if servoed_on is shown else renewed(servoed_on, self.servo_extractor)

    def _begin(self, experiment):
        self.sequence = ExperimentSequence(self.kinematics, self.servo, experiment, self._teach_camera)
        self.frame, self.seen = -1, None
        self._placed_ns = 0
        self._taught = (None, [])  # by `teach`: depth of the target, and its first answers, as in `TaughtGoal`
        self._frame = None  # taken last: image, joints, poses of camera and models at its stamp

    def begin_again(self, scenario, goal=None):
        """Be a loop of another scenario, which differs in `experiment` alone, as if it had been made of it.

        Simulator, servo and extractors are used again, and the other sections are not read again. The bytes are those
        of a new loop.

        Args: goal: a `TaughtGoal` of this loop, of a scenario that differs in the start alone: begin where it had been
            taught, as if the arm were placed there and it were taught again.
        Raises: ParameterError: what is wrong with the section `experiment`.  StateError (the simulator's): the goal is
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
        """Make the image of this stamp the one that features are relative to: camera/set_reference without ROS."""
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

    def place(self, joints, settle_s=0.0):
        """Put the arm at joint positions at once instead of driving it there.

        Args:
            joints: dict of joint name -> position [m, rad]; the others stay.
            settle_s: simulated time in which the arm comes to rest under gravity and friction, with these positions as
                set-points [s].
        """
        self.sim.set_joint_positions(joints)
        self.sim.step(round(settle_s * 1e9 / self.sim.period_ns))
        self._placed_ns = self.sim.time_ns

    def taught_goal(self):
        """`TaughtGoal` of a loop that has just taught its goal by `teach`, and has done nothing else but `place`.

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

    def teach(self, z_star_m):
        """Make the next images the reference, as many as their noise asks for, outside an experiment.

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
            stamp_ns, image, q = self._take()
            features, seen = self._see(image, stamp_ns)
            self.frame += 1
            if self.servo.why_lost(seen):
                raise ParameterError("target not in view at the goal")
            taught = self.sequence.teach_more(stamp_ns, seen, q, z_star_m)
            record = ServoRecord(stamp_ns, Status.IDLE, "taught", "teach", joint_names=self.kinematics.joint_names, q=q,
                                 set_point=np.full(len(q), np.nan))
            answer = record, self.camera_pose(), features, image, self.moving_target_pose()
            if len(answers) <= KEPT_IMAGES:
                answers.append((*answer[:3], np.array(image), answer[4]))
            yield answer

    def use(self, servo):
        """Go on with another servo, of the same kinematics and source of features."""
        self.servo = servo
        self.sequence.use(servo)

    def teach_here(self, z_star_m):
        """Make the view of the image answered last the goal. Args and errors: those of `ExperimentSequence.teach`."""
        if self.seen is None:
            raise ParameterError("teach: no image has come yet")
        self.sequence.teach(self.seen.stamp_ns, self.seen.features, self.seen.q, z_star_m)

    def start(self, servo_only=False):
        """Begin the experiment with the next image; servo_only: servo to the reference taught last."""
        self.sequence.start(servo_only=servo_only)

    def step(self):
        """One image.

        Returns:
            (record, features, image): ServoRecord, the extractor's features (moments), and the image, a view that the
            next step overwrites.
        """
        stamp_ns, image, q = self._take()
        features, seen = self._see(image, stamp_ns)
        self.frame += 1
        self.seen = Observation(stamp_ns, seen, q, self.frame)
        command, record = self.sequence.step(self.seen)
        self.sim.set_command(command.position, command.velocity, None, stamp_ns)
        return record, features, image

    def _take(self):
        """Take the next image that was not on its way while the arm was put elsewhere.

        Returns: (stamp_ns, image, q), q (n,) the joint positions that it shows, in the order of the kinematics.
        """
        stamp_ns = self.sim.step_to_image(self.camera)
        while stamp_ns < self._placed_ns:
            stamp_ns = self.sim.step_to_image(self.camera)
        frame = self._frame = self.sim.frame(self.camera)
        q = frame.joint_positions
        image = in_rgb(frame.image, self._encoding)
        return stamp_ns, image, q if self._order is None else q[self._order]

    def camera_pose(self):
        """X_WC, (4, 4), of the instant that the image answered last shows."""
        return self._frame.camera_pose

    def run(self, progress=None, limit_s=DEFAULT_LIMIT_S, closing_s=CLOSING_S, keep_images=False):
        """Run the experiment from here to its end.

        Args:
            progress: called about once a simulated second with (t_s, phase), or None.
            limit_s: simulated time after which to give up [s].  closing_s: simulated time to go on after the end [s].
            keep_images: keep every image of the servo phase in the record, for a video.
        Returns:
            RunRecord, one row per image.
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
            while self.sim.next_image_ns(self.camera) <= end_ns:  # drawn for the run hash; nobody asks what they show
                last_ns, _, _ = self._take()
                self.frame += 1
                self._tell(progress, last_ns, record.phase)
            self.sim.step(max(0, (end_ns - self.sim.time_ns) // self.sim.period_ns))
        else:
            builder.note(f"given up after {limit_s:g} s of simulated time in phase {record.phase}")
        wall_s = time.perf_counter() - started_s
        for warning in filter(lambda text: "renderer coverage does not draw" in text, self.sim.warnings):
            builder.note(warning)  # what it says of the URDF is no news of this run
        return builder.finish(run_hash=self.sim.run_hash, wall_s=wall_s, camera_info=self.camera_info,
                              real_time_factor=1e-9 * (last_ns - builder.begin_ns) / wall_s,
                              X_WT=self.target_pose(), opengl=self.sim.opengl)

    def moving_target_pose(self):
        """X_WT, (4, 4), at the last image, of a target that moves; None of one that rests."""
        return self.seen_target_pose() if self._target_moves else None

    def seen_target_pose(self):
        """X_WT, (4, 4), of the target at the last image; None in a scene without one."""
        return self._target and self._frame.model_poses[self._target]

    def target_pose(self):
        """X_WT, (4, 4), of the target now; None in a scene without one."""
        return self._target and self.sim.model_pose(self._target)

    def _row(self, builder, progress):
        record, features, image = self.step()
        builder.add_answer(record, self.camera_pose(), features, image, self.moving_target_pose())
        self._tell(progress, record.stamp_ns, record.phase)
        return record

    def _tell(self, progress, stamp_ns, phase):
        if progress is not None and self.frame % PROGRESS_ROWS == 0:
            progress(stamp_ns * 1e-9, phase)
