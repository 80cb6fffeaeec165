"""The simulator plays a real arm, in one process: jittered clocks, joint states that do not belong to an image, images
that come late or never, and a driver that takes a command every few milliseconds. Seeded, without wall time.

    run = RoughRun(load_scenario("experiment_1", ...), Roughness(joint_rate_hz=50.0, image_late_s=(0.02, 0.15)))
    run.experiment()        # (RunRecord-like final pose errors, the last record)
"""

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from aras_visual_servo import make_form, RealSettings, ServoLoop, Session
from aras_visual_servo.spatial import inverse, rotation_vector
from aras_visual_servo_controller.real.arm_link import ArmLink
from aras_visual_servo_controller.real.prediction import predicted

MS = 1_000_000


@dataclass(frozen=True)
class Roughness:
    """How rough the arm is. Times in s; stddev of Gaussian jitter."""

    joint_rate_hz: float = 500.0
    joint_late_s: float = 0.002
    joint_jitter_s: float = 0.001
    image_late_s: Tuple[float, float] = (0.02, 0.15)
    image_jitter_s: float = 0.002
    image_stamped_late_s: float = 0.0
    lost: float = 0.1
    command_period_s: float = 0.008
    seed: int = 1


class Driver:
    """What the driver of the arm does with the messages of a form, every command period."""

    def __init__(self, sim, joint_names, controller_of):
        self._sim, self._names, self._joint_of = sim, joint_names, {c: j for j, c in controller_of.items()}
        self._point = self._at = None

    def take(self, messages):
        for message in messages:
            topic, fields = message.topic[:-len("/command")], message.fields
            if message.kind.endswith("JointTrajectory"):
                (point,) = fields["points"]
                self._point = dict(zip(fields["joint_names"], point["positions"])), point["time_from_start_s"]
            elif message.kind.endswith("MultiArray"):
                self._command(dict(zip(self._names, fields["data"])))
            else:
                self._command({self._joint_of[topic]: fields["data"]})

    def tick(self, period_s):
        """A trajectory is followed: a straight way to its point, a part of it in each period."""
        if self._point is None:
            return
        goal, left_s = self._point
        part = min(1.0, period_s / left_s)
        self._at = self._at or dict(zip(self._sim.joint_names, self._sim.joint_positions.tolist()))
        self._at.update({name: self._at[name] + part * (goal[name] - self._at[name]) for name in goal})
        self._point = (goal, max(period_s, left_s - period_s))
        self._sim.set_command(position={name: self._at[name] for name in goal}, stamp_ns=self._sim.time_ns)

    def _command(self, values):
        kind = {self.kind: values}
        self._sim.set_command(stamp_ns=self._sim.time_ns, **kind)

    kind = "position"


class RoughRun:
    """One run of a scenario's experiment on a rough arm.

    Attributes: events: list of (t_s, text) of refusals and stops.  records: every `ServoRecord`.  now_ns.
    """

    def __init__(self, scenario, roughness, **real):
        self.loop = ServoLoop(scenario)
        self.loop.sequence.holds = False
        self.sim, kinematics = self.loop.sim, self.loop.kinematics
        settings = {"command_period_s": roughness.command_period_s, "controller": "arm", **real}
        self.settings = RealSettings.from_dict(settings, kinematics.joint_names)
        timeout_s = self.loop.servo.config.input_timeout_s
        self.session = Session(self.loop.sequence, timeout_s, self.loop.servo.config.time_limit_s)
        self.link, self.form = ArmLink(kinematics, self.settings, timeout_s), make_form(self.settings)
        names = {name: self.settings.joint_controllers.get(name, f"{name}_controller")
                 for name in kinematics.joint_names}
        self.driver = Driver(self.sim, kinematics.joint_names, names)
        self.driver.kind = "velocity" if self.settings.command == "velocity" else "position"
        self.rough, self._random = roughness, np.random.default_rng(roughness.seed)
        self._mail, self._posted = [], 0  # (when, number, what to do)
        self._last = {"image": 0, "joints": 0}
        self.records, self.events, self.points, self.timings, self.unfit = [], [], [], [], None
        self.deadman = lambda t_ns: True
        self.joints_come = lambda t_ns: True
        self._true = []  # (time, joint positions) of every physics period

    def truth(self, time_ns):
        """(n,) joint positions that the arm really had at a time."""
        first_ns, _ = self._true[0]
        return self._true[round((time_ns - first_ns) / self.sim.period_ns)][1]

    @property
    def now_ns(self):
        return self.sim.time_ns

    def _post(self, late_s, what, kind):
        """Messages of one topic keep their order."""
        at_ns = max(self.now_ns + round(max(0.0, late_s) * 1e9), self._last[kind])
        self._last[kind] = at_ns
        self._mail.append((at_ns, self._posted, what))
        self._posted += 1

    def advance(self):
        """One physics period."""
        sim, rough, now = self.sim, self.rough, self.now_ns + self.sim.period_ns
        image = None
        if sim.next_image_ns(self.loop.camera) <= now:
            sim.step_to_image(self.loop.camera)
            self.loop._frame = frame = sim.frame(self.loop.camera)
            image = np.array(frame.image)
        else:
            sim.step(1)
        now = self.now_ns
        self._true.append((now, self._positions()))
        if image is not None and self._random.random() >= rough.lost:
            jitter_s = self._random.normal(rough.image_stamped_late_s, rough.image_jitter_s)
            stamp_ns = now + round(jitter_s * 1e9)
            self._post(self._random.uniform(*rough.image_late_s), lambda: self._image(stamp_ns, image), "image")
        period_ns = round(1e9 / rough.joint_rate_hz)
        if now // period_ns > (now - sim.period_ns) // period_ns and self.joints_come(now):
            q, jitter_s = self._positions(), self._random.normal(0.0, rough.joint_jitter_s)
            joints_ns = now + round(jitter_s * 1e9)
            self._post(rough.joint_late_s, lambda: self.link.joints(joints_ns, q, self.now_ns), "joints")
        due = sorted((mail for mail in self._mail if mail[0] <= now), key=lambda mail: mail[:2])
        if due:
            self._mail = [mail for mail in self._mail if mail[0] > now]
            for _, _, what in due:
                what()
            self._answer()
        command_ns = round(rough.command_period_s * 1e9)
        if now // command_ns > (now - sim.period_ns) // command_ns:
            self._tick()

    def _positions(self):
        q = self.sim.joint_positions
        return np.array(q if self.loop._order is None else q[self.loop._order])

    def _image(self, stamp_ns, image):
        _, seen = self.loop._see(image, stamp_ns)
        self.link.image(stamp_ns, self.loop.servo.source.kept(seen), self.now_ns)

    def _answer(self):
        for sight in self.link.sights(self.now_ns):
            if self.settings.predict and self.loop.sequence.phase == "servo":
                sight = self.link.predict(sight, self.now_ns, self.loop.servo.goal.plane_at, predicted)
            command, record = self.session.answer(sight.stamp_ns, sight.features, sight.q, self.now_ns,
                                                  self.now_ns * 1e-9, sight.refusal)
            if sight.refusal:
                self.events.append((self.now_ns * 1e-9, record.status_text))
            self.records.append(record)
            self.timings.append(sight.timing)
            self.link.take(command, self.now_ns)
            if self.session.active and self.loop.sequence.done:
                self.session.active = False
                self.link.end(self.now_ns)

    def _tick(self):
        now = self.now_ns
        if self.deadman(now) is not None:
            self.link.deadman(self.deadman(now), now)
        tick = self.link.tick(now)
        reason = tick.unfit.reason if tick.unfit else ""
        if tick.unfit and tick.unfit.ends and self.session.active:
            self.records.append(self.session.end(now, reason)[1])
            self.link.end(now)
        answer = self.session.watch(now, now * 1e-9)
        if answer is not None and answer[0] is not None:
            self.link.take(answer[0], now)
            self.records.append(answer[1])
        if tick.point is not None:
            self.points.append((now, tick.point.position.copy(), np.array(tick.point.velocity), tick.point.resting))
            self.driver.take(self.form.messages(tick.point))
        self.driver.tick(self.rough.command_period_s)

    def begin(self, reference="experiment"):
        for _ in range(100):  # joint states and images come before the first goal
            self.advance()
        self.session.begin(reference, "", (), (), 0.0, self.now_ns, self.now_ns * 1e-9)

    def until(self, condition, limit_s=120.0):
        """Advance until a condition holds. Returns whether it did within the limit of simulated time."""
        end_ns = self.now_ns + round(limit_s * 1e9)
        while self.now_ns < end_ns:
            if condition():
                return True
            self.advance()
        return False

    def experiment(self, closing_s=0.5):
        """To goal, teach, to start, servo. Returns the final errors: (x_mm, y_mm, z_mm), angle_deg."""
        self.begin()
        taught = []

        def done():
            if self.loop.sequence.teach_stamp_ns is not None and not taught:
                taught.append(self.sim.camera_pose(self.loop.camera))
            return not self.session.active

        assert self.until(done)
        end_ns = self.now_ns + round(closing_s * 1e9)
        while self.now_ns < end_ns:
            self.advance()
        if not taught:
            return None
        X_GC = inverse(taught[0]) @ self.sim.camera_pose(self.loop.camera)
        return 1e3 * X_GC[:3, 3], float(np.degrees(np.linalg.norm(rotation_vector(X_GC[:3, :3]))))
