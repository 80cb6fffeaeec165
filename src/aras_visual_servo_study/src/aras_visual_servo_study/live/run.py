"""A run that is changed while it goes on: simulator, camera and servo in this process, one image at a time.

    run = LiveRun(load_scenario("experiment_1"))
    run.do(Start())                  # what a page asks for, live/messages.py
    while True:
        run.advance(16_000_000)      # to the next image, or 16 ms of simulated time, whatever comes first

No threads and no wall time: live/runner.py lets it go on at the speed that somebody wants.
"""

import copy
import math

import numpy as np

from aras_visual_servo import ExperimentSequence, ParameterError, ServoLoop, Status
from .about import about, marks_of, row, rounded, saved
from .following import Following
from .hand import Hand
from .settings import acts_at_once, changed, put
from .view.scene import pose_numbers

QUIET = ("idle", "done")


class LiveRun:
    """One run, and everything that a page may do to it.

    Attributes:
        scenario: as it stands now.  loop: `ServoLoop` in use.  record: `ServoRecord` of the last image, or None.
        image: of the last image, valid until the next.  goal: (image, marks, pose numbers) of the taught view, or None.
        version: grows whenever `about` would say something else.  images: how many were answered so far.
    Raises: ParameterError and the errors of `ServoLoop`.
    """

    def __init__(self, scenario):
        self.scenario, self.version, self.images = scenario, 0, 0
        # A target that the arm carries moves with every motion of the arm: nobody has to follow it.
        self._follow, self._waiting = scenario.robot.get("target_link") is None, set()
        self._marked, self._marks = -1, None  # image whose marks were made last, and these
        self._build(None)

    def _build(self, sim):
        loop = ServoLoop(self.scenario, sim=sim)
        self.loop, self._hand = loop, Hand(loop.kinematics)
        self.record = self.image = self.features = self.goal = None
        self._following = Following()
        self._built_sim, self._waiting = self.scenario.sim, set()
        self.version += 1

    # --- time ---------------------------------------------------------------------------------------------------

    @property
    def time_ns(self):
        """Simulated time [ns]."""
        return self.loop.sim.time_ns

    def advance(self, most_ns):
        """Go on to the next image and answer it, or for about `most_ns` of simulated time if that is shorter.

        Returns: whether an image was answered.
        """
        sim = self.loop.sim
        due_ns = sim.next_image_ns(self.loop.camera) - sim.time_ns
        if due_ns > most_ns + sim.period_ns:
            sim.step(max(1, most_ns // sim.period_ns))
            return False
        self.record, self.features, self.image = self.loop.step()
        self.images += 1
        if self.record.phase == "teach" or self.loop.sequence.teach_stamp_ns == self.record.stamp_ns:
            self._keep_goal()
        if self.loop.sequence.phase in QUIET:
            self._hand.drive(self.loop, self.record.stamp_ns)
        X_WT, follow = self.loop.seen_target_pose(), self._follow and self.goal is not None
        if X_WT is not None and self._following.answered(self.record.phase, self.record.status, X_WT, follow):
            self._begin(True)
        return True

    def _begin(self, servo_only):
        self._hand.let_go()
        self.loop.start(servo_only=servo_only)

    def _keep_goal(self):
        self.goal = np.array(self.image), self.marks(), pose_numbers(self.loop.camera_pose())

    # --- what stands there --------------------------------------------------------------------------------------

    def about(self):
        """What a page has to know before anything moves, and again when `version` has grown: for JSON."""
        loop = self.loop
        at_C = loop.sim.camera_pose(loop.camera)[:3, 3]
        return {**about(self.scenario, loop.kinematics, loop.camera_info, loop.servo, at_C, loop.target_pose(),
                        loop._target), "version": self.version, **self.standing()}

    def standing(self):
        """The part of `about` that changes with every setting: values of the scenario, and which wait for a reset."""
        return {"values": self.scenario.as_dict(), "waiting": sorted(self._waiting)}

    def row(self, real_time_factor):
        """The numbers of the last image that curves show (`row_names`), None where one does not exist."""
        return row(self.record, self.loop.seen.q, real_time_factor, self.loop.camera_pose()[:3, 3], self.marks())

    def state(self):
        """What moves: for JSON."""
        sim, sequence, record = self.loop.sim, self.loop.sequence, self.record
        q = sim.joint_positions
        order = self.loop._order
        status = Status.IDLE if record is None else record.status
        return {"t": round(sim.time_s, 4), "q": [rounded(x) for x in (q if order is None else q[order])],
                "camera": pose_numbers(sim.camera_pose(self.loop.camera)),
                "target": pose_numbers(self.loop.target_pose()),
                "status": status.name, "text": record.status_text if record else "", "phase": sequence.phase,
                "taught": self.goal is not None, "frame": self.loop.frame, "follow": self._follow}

    def marks(self):
        """What is drawn into the last image, see `marks_of`."""
        if self._marked != self.images:
            self._marked, self._marks = self.images, marks_of(self.features, self.loop.camera_info)
        return self._marks

    # --- what a page asks for -----------------------------------------------------------------------------------

    def do(self, request):
        """Answer a request of live/messages.py but those about wall time: dict for the page, {} if there is no more
        to say than that it is done.

        Raises: ArasError: it cannot be done; nothing has changed.
        """
        return getattr(self, "do_" + request.do)(request) or {}

    def do_start(self, request):
        if request.reference == "taught" and self.loop.servo.reference is None:
            raise ParameterError("start: found the reference taught, but nothing was taught yet; teach this view first")
        loop = self.loop
        if request.reference == "experiment":
            loop.sequence = self._sequence(loop.servo, self.scenario)
        self._begin(request.reference == "taught")

    def do_stop(self, _request):
        self._hand.let_go()
        loop = self.loop
        if loop.sequence.phase in QUIET:
            return
        command, _ = loop.sequence.stop(loop.sim.time_ns, "stopped from the page")
        loop.sim.set_command(position=command.position, velocity=command.velocity)

    def do_teach(self, request):
        loop = self.loop
        if loop.sequence.phase not in QUIET:
            raise ParameterError(f"teach: found the run in phase {loop.sequence.phase}, allowed when it is stopped")
        if self.features is None:
            raise ParameterError("teach: no image has come yet")
        z_star_m = request.z_star_m or self._depth()
        loop.teach_here(z_star_m)
        self._keep_goal()
        self._following.taught()
        return {"z_star_m": z_star_m}

    def _depth(self):
        """Depth along the optical axis of the target's plane; the experiment's where the two do not meet [m]."""
        X_WC, X_WT = self.loop.camera_pose(), self.loop.target_pose()
        if X_WT is not None:
            normal, towards = X_WT[:3, 2], X_WC[:3, 2]
            along = float(normal @ towards)
            depth = float(normal @ (X_WT[:3, 3] - X_WC[:3, 3])) / along if abs(along) > 1e-3 else 0.0
            if depth > 0.0:
                return depth
        return float(self.scenario.experiment["z_star_m"])

    def do_reset(self, _request):
        same = self._built_sim == self.scenario.sim
        self._build(self.loop.sim if same else None)

    def do_follow(self, request):
        self._follow = request.follow

    def do_set(self, request):
        scenario = changed(self.scenario, request.values)
        loop, servo = self.loop, None
        if scenario.servo != self.scenario.servo:
            servo = loop.servo.retuned(scenario.servo)
        at_once = {path for path in request.values if acts_at_once(path)}
        if any(path.startswith("experiment.") for path in at_once) and loop.sequence.phase in QUIET:
            self._sequence(servo or loop.servo, scenario)  # refuses what no arm can do
        seen = {path for path in at_once if path.startswith("sim.")}
        if seen:
            self._see(seen, request.values)
        self.scenario = scenario
        if servo is not None:
            loop.use(servo)
        self._waiting |= set(request.values) - at_once
        if {"servo.features", "servo.law"} & set(request.values):
            self.version += 1
        return {"waiting": sorted(set(request.values) - at_once)}

    def _sequence(self, servo, scenario):
        return ExperimentSequence(self.loop.kinematics, servo, scenario.experiment, self.loop._teach_camera)

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

    def do_place_target(self, request):
        if self.loop._target is None:
            raise ParameterError("place_target: the scene has no target")
        length = math.sqrt(sum(x * x for x in request.q_xyzw))
        if not 0.99 < length < 1.01:
            raise ParameterError(f"place_target.q_xyzw: found a length of {length:.4g}, allowed 1")
        q_xyzw = [x / length for x in request.q_xyzw]
        self.loop.sim.set_model_pose(self.loop._target, list(request.position_m), q_xyzw)

    def do_move_target(self, request):
        if self.loop._target is None:
            raise ParameterError("move_target: the scene has no target")
        self.loop.sim.set_model_motion(self.loop._target, request.motion)

    def do_joint(self, request):
        if self.loop.sequence.phase not in QUIET:
            raise ParameterError(f"joint: found the run in phase {self.loop.sequence.phase}, allowed when it is "
                                 "stopped")
        self._hand.hold(request.name, request.position, self.loop)

    def do_save(self, request):
        """What stands there as a scenario file."""
        names = self.loop.kinematics.joint_names
        start = dict(zip(names, self.state()["q"])) if request.start_here else None
        return {"yaml": saved(self.scenario, request.name, self.loop.target_pose(), self.loop._target, start)}
