"""A run that is changed while it goes on: simulator, camera and servo in this process, one image at a time.

    run = LiveRun(load_scenario("experiment_1"))
    run.do(Start())                  # what a page asks for, live/messages.py
    while True:
        run.advance(16_000_000)      # to the next image, or 16 ms of simulated time, whatever comes first

No threads and no wall time: live/runner.py lets it go on at the wanted speed.
"""

import copy
import math
from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from aras_visual_servo import ExperimentSequence, ParameterError, RecordBuilder, Scenario, Servo, ServoLoop, spatial
from .editor import LawEditor
from .lesson import LESSONS, LessonInHand, lessons
from .messages import Start
from .page_run import QUIET, PageRun
from .settings import acts_at_once, changed, put


def with_rest(scenario: Scenario) -> Scenario:
    """Returns a scenario whose arm rests soon where it cannot follow the target, unless it says otherwise."""
    if "out_of_reach" in scenario.servo or scenario.servo["mode"] != "continuous":
        return scenario
    return changed(scenario, {"servo.out_of_reach": {}})


class LiveRun(PageRun):
    """The backend in this process. Its image is valid until the next one. Raises the errors of `ServoLoop`.

    Args: edit: whether pages may write a law.
    """

    def __init__(self, scenario: Scenario, edit: bool = False) -> None:
        super().__init__(with_rest(scenario))
        if edit:
            self.editor = LawEditor(self._use_law, self._with_law)
        self._lesson: Optional[LessonInHand] = None
        self._build(None)

    def _build(self, sim: Any) -> None:
        self.loop = loop = ServoLoop(self.scenario, sim=sim)
        self.renew(loop.kinematics, loop.servo, loop.camera_info, loop._target)
        self._built_sim = self.scenario.sim
        if self._lesson is not None:
            self._lesson.break_off()

    # --- what stands there --------------------------------------------------------------------------------------

    @property
    def time_ns(self) -> int:
        """Returns the simulated time [ns]."""
        return self.loop.sim.time_ns

    @property
    def phase(self) -> str:
        return self.loop.sequence.phase

    @property
    def frame(self) -> int:
        """Returns the index of the last image."""
        return self.loop.frame

    def joints(self) -> np.ndarray:
        """Returns the joint positions now, (n,), in the order of the kinematics."""
        q, order = self.loop.sim.joint_positions, self.loop._order
        return q if order is None else q[order]

    def camera_pose(self) -> np.ndarray:
        """Returns X_WC, (4, 4), now."""
        return self.loop.sim.camera_pose(self.loop.camera)

    def target_pose(self) -> Optional[np.ndarray]:
        """Returns X_WT, (4, 4), now; None in a scene without target."""
        return self.loop.target_pose()

    def advance(self, most_ns: int) -> bool:
        """Goes on to the next image and answers it, or for about `most_ns` of simulated time if that is shorter.

        Returns: whether an image was answered.
        """
        loop, sim = self.loop, self.loop.sim
        due_ns = sim.next_image_ns(loop.camera) - sim.time_ns
        if due_ns > most_ns + sim.period_ns:
            sim.step(max(1, most_ns // sim.period_ns))
            return False
        self.used = self.scenario
        record, self.features, self.image = loop.step()
        self.record, q, X_WT = record, loop.seen.q, loop.seen_target_pose()
        self.X_WC = loop.camera_pose()
        self.images += 1
        if record.phase == "teach" or loop.sequence.teach_stamp_ns == record.stamp_ns:
            self.keep_goal(self.X_WC)
        if self._lesson is not None:
            self._lesson.take(record, self.X_WC)
        if self.editor is not None:
            self.editor.follow(self.servo.config.law, record, self.phase == "servo")
        if self.phase in QUIET:
            self.drive_by_hand(record.stamp_ns)
        if self.begin_again(record, X_WT, self.follow and self.goal is not None):
            self._begin(True)
        else:
            e = self.servo.errors(loop.seen.features) if record.phase in QUIET else None
            self.record = self.of_now(record, q, X_WT, e)
        return True

    def _begin(self, servo_only: bool) -> None:
        self.hand.let_go()
        if not servo_only:
            self.loop.follow_anew()
        self.starts += 1
        self.loop.start(servo_only=servo_only)

    def command(self, positions: Dict[str, float], stamp_ns: int) -> None:
        """Gives joints set-points by name [m or rad]."""
        self.loop.sim.set_command(position=positions, velocity=dict.fromkeys(positions, 0.0), stamp_ns=stamp_ns)

    # --- what a page asks for -----------------------------------------------------------------------------------

    def do_start(self, request: Any) -> None:
        if request.reference == "taught" and self.servo.reference is None:
            raise ParameterError("start.reference: found taught, but no goal is taught; press Teach here first")
        self._use_written_law()
        if request.reference == "experiment":
            self.loop.sequence = self._sequence(self.servo, self.scenario)
        self._begin(request.reference == "taught")

    def do_again(self, _request: Any) -> None:
        if self.servo.reference is None:
            raise ParameterError("again: found no taught goal; press Run all or Teach here first")
        self._use_written_law()
        self.loop.sequence = self._sequence(self.servo, self.scenario)
        self.hand.let_go()
        self.loop.follow_anew()  # whatever made the last servo lose the target may have left another object to follow
        self.starts += 1
        self.loop.start(again=True)

    def do_stop(self, _request: Any) -> None:
        self.hand.let_go()
        if self.phase not in QUIET:
            command, _ = self.loop.sequence.stop(self.time_ns, "stopped from the page")
            self.loop.sim.set_command(position=command.position, velocity=command.velocity)

    def teach(self, z_star_m: Optional[float]) -> Dict[str, float]:
        """Makes the view of the last image the goal. Args: z_star_m: depth of the target; None: the true one."""
        if self.features is None:
            raise ParameterError("teach: found no image yet; wait for the first one")
        z_star_m = z_star_m or self._depth()
        self.loop.teach_here(z_star_m)
        self.keep_goal(self.X_WC)
        return {"z_star_m": z_star_m}

    def _depth(self) -> float:
        """Depth along the optical axis of the target's plane; the experiment's where the two do not meet [m]."""
        X_WT = self.target_pose()
        depth_m = math.nan if X_WT is None else spatial.plane_depth(self.X_WC, X_WT)
        return float(self.scenario.experiment["z_star_m"]) if math.isnan(depth_m) else depth_m

    def do_reset(self, _request: Any) -> None:
        self._build(self.loop.sim if self._built_sim == self.scenario.sim else None)

    # --- lessons ------------------------------------------------------------------------------------------------

    def lessons(self) -> List[Dict[str, Any]]:
        return [lesson.about() for lesson in lessons()]

    def state(self) -> Dict[str, Any]:
        """Returns what moves, for JSON; and how a lesson in hand and the editor stand, as `lesson` and `editor`."""
        state = super().state()
        if self.editor is not None:
            state["editor"] = self.editor.state(self.servo.config.law)
        return state if self._lesson is None else {**state, "lesson": self._lesson.state()}

    def do_lesson(self, request: Any) -> None:
        before = self.scenario if self._lesson is None else self._lesson.before
        if request.name is None:
            self._lesson = None
            self._begin_anew(before)
            return
        lesson = LESSONS.find(request.name, "lesson.name")()
        self._begin_anew(lesson.setting())
        self._lesson = LessonInHand(lesson, before)
        self._run_lesson()

    def do_try_lesson(self, request: Any) -> None:
        if self._lesson is None:
            raise ParameterError("try_lesson: found no active lesson; press Set the scene first")
        self._lesson.check(request.change, request.answer)
        self._begin_anew(self._lesson.lesson.setting(request.change))
        self._run_lesson(request.change, request.answer)

    def _run_lesson(self, change: str = "", answer: str = "") -> None:
        """Runs what has been built, and records it for the lesson in hand."""
        assert self._lesson is not None
        builder = RecordBuilder(self.scenario.name, self.kinematics.joint_names, self.scenario.as_dict(),
                                self.servo.feature_names)
        self._lesson.begin(builder, change, answer)
        self.do_start(Start())

    # --- a law that is written in the page ----------------------------------------------------------------------

    def do_write_law(self, request: Any) -> Dict[str, Any]:
        if self.editor is None:
            return super().do_write_law(request)
        answer = self.editor.write(request.text)
        self.version += 1
        return answer

    def _use_written_law(self) -> None:
        if self.editor is not None:
            self.editor.begin(self.servo.config.law)

    def _with_law(self, name: str) -> Tuple[Scenario, Servo]:
        """Returns scenario and servo as they stand, with another law. ArasError: it cannot servo with them."""
        values: Dict[str, Any] = {"servo.law": name}
        try:
            scenario = changed(self.scenario, values)
        except ParameterError:  # an earlier text under this name may have had other settings
            if name not in self.scenario.servo:
                raise
            scenario = changed(self.scenario, {**values, f"servo.{name}": None})
        return scenario, self.servo.retuned(scenario.servo)

    def _use_law(self, name: str) -> None:
        self.scenario, self.servo = self._with_law(name)
        self.loop.use(self.servo)
        self.version += 1

    def do_save(self, request: Any) -> Dict[str, Any]:
        answer, law = super().do_save(request), self.servo.config.law
        if self.editor is not None and self.editor.has(law):
            answer["yaml"] = (f"# Its law was written in the page: save the text as {law}.py beside this file, and run "
                              f"it with --plugins {law}.\n{answer['yaml']}")
        return answer

    # --- settings -----------------------------------------------------------------------------------------------

    def do_set(self, request: Any) -> Dict[str, Any]:
        scenario, loop, servo = changed(self.scenario, request.values), self.loop, None
        if request.reset:
            self._begin_anew(scenario)
            return {"waiting": []}
        if scenario.servo != self.scenario.servo:
            servo = self.servo.retuned(scenario.servo)
        at_once = {path for path in request.values if acts_at_once(path)}
        if any(path.startswith("experiment.") for path in at_once) and self.phase in QUIET:
            self._sequence(servo or self.servo, scenario)  # refuses what no arm can do
        seen = {path for path in at_once if path.startswith("sim.")}
        if seen:
            self._see(seen, request.values)
        self.scenario = scenario
        if servo is not None:
            self.servo = servo
            loop.use(servo)
        self.waiting |= set(request.values) - at_once
        if {"servo.features", "servo.law"} & set(request.values):
            self.version += 1
        return {"waiting": sorted(set(request.values) - at_once)}

    def _begin_anew(self, scenario):
        """Builds the run of this scenario; as before if that fails."""
        before, self.scenario = self.scenario, scenario
        try:
            self._build(None)
        except Exception:
            self.scenario = before
            raise

    def _sequence(self, servo, scenario):
        return ExperimentSequence(self.kinematics, servo, scenario.experiment, self.loop._teach_camera)

    def _see(self, paths, values):
        """Give the simulator these settings of its cameras and lights; what waits for a reset goes on waiting."""
        built = copy.deepcopy(self._built_sim)
        document = {"sim": built}
        for path in paths:
            put(document, path, copy.deepcopy(values[path]))
        if any(path.startswith("sim.cameras.") for path in paths):
            self.loop.sim.set_cameras(built)
        if any(path.startswith("sim.scene.") for path in paths):
            self.loop.sim.set_lighting(built)
        self._built_sim = built

    def place_target(self, position_m: List[float], q_xyzw: List[float]) -> None:
        """Puts the target somewhere in the world [m]; q_xyzw is a unit quaternion."""
        self.loop.sim.set_model_pose(self.target, position_m, q_xyzw)

    def move_target(self, motion: Optional[Dict[str, Any]]) -> None:
        """Gives the target a motion, as in a scenario; None: it stays."""
        self.loop.sim.set_model_motion(self.target, motion)
