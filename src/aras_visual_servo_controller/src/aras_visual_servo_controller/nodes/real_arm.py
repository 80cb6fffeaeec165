"""Node `controller` of a real arm (scripts/nodes/real_controller), which is no simulator in lockstep: any joint states,
images and command topics.

`real/arm_link.py` decides the motion of the arm. This file is ROS wiring. A thread in addition to those of
`ControllerNode` sends the commands every `real.command_period_s` of ROS time, and checks whether the arm must rest.
"""

import threading
import traceback
from dataclasses import replace

import rospy
import yaml
from std_msgs.msg import Bool, String

from aras_visual_servo import ArasError, ParameterError, RealSettings, ServoRecord, SetPoint, Status, make_form
from aras_visual_servo_msgs.msg import InputTiming
from ..real.arm_link import ArmLink
from ..real.prediction import predicted
from . import conversions as convert
from .controller import ControllerNode, main as run_node
from .parameters import Parameters

SHOW_LATENCY_S = 10.0  # ROS time between two lines of the log
#: Statuses whose text also tells what slows or stops the arm.
SLOWED = (Status.SERVOING, Status.OUT_OF_REACH, Status.TIMED_OUT)


class RealControllerNode(ControllerNode):
    """The node. It raises ParameterError, which lists every fault of the parameters."""

    def _read_parameters(self):
        super()._read_parameters()
        self._sequence.holds = False  # its own controllers do, and others may drive it when a goal has ended
        parameters = Parameters()
        section = parameters.section("real", required=False)
        parameters.check()
        settings = self._settings = RealSettings.from_dict(section, self._kinematics.joint_names)
        if self._float_publishers:
            raise ParameterError("command_interface: found float64, allowed with a real arm: joint_command; set the "
                                 "message type by real.command")
        if settings.predict and self._servo.source.name != "moments":
            raise ParameterError(f"real.predict: found true with features of {self._servo.source.name}, allowed with "
                                 "features of moments and points")
        self._link = ArmLink(self._kinematics, settings, self._servo.config.input_timeout_s)
        output, robot = self._servo.config.output, parameters.section("robot")
        if output == "twist" and robot.get("target_link"):
            raise ParameterError("servo.output: found twist with robot.target_link, allowed with a camera on the arm")
        self._twist_frame_id = robot[{"base": "base_link", "camera": "tip_link"}[settings.twist_frame]]
        self._form, self._publishers = make_form(settings, output), {}
        self._unfit = self._slowed = ""
        self._blocked, self._answered, self._refused = False, 0, 0

    def _connect_arm(self):
        zeros = [0.0] * len(self._kinematics.joint_names)
        for message in self._form.messages(SetPoint(0, self._kinematics.joint_names, zeros, zeros, True)):
            self._publishers[message.topic] = rospy.Publisher(message.topic, convert.message_class(message.kind),
                                                              queue_size=10, tcp_nodelay=True)
        if rospy.has_param("scenario"):  # so that a bag holds the configuration of its run
            self._scenario_publisher = rospy.Publisher("scenario", String, queue_size=1, latch=True)
            self._scenario_publisher.publish(yaml.safe_dump(rospy.get_param("scenario"), sort_keys=False))
        self._timing_publisher = rospy.Publisher("input_timing", InputTiming, queue_size=200)
        rospy.Subscriber("deadman", Bool, self._on_deadman, tcp_nodelay=True)
        threading.Thread(target=self._command_loop, name="commands", daemon=True).start()

    # --- inputs from the arm --------------------------------------------------------------------------------

    def _on_joints(self, message):
        with self._lock:
            try:
                message = message.unpack()
                q = self._joints.known_positions(message)
                if q is not None and self._link.joints(convert.stamp_ns(message.header), q, convert.now_ns()):
                    self._answer_ready()
            except ArasError as error:
                rospy.logwarn_throttle(1.0, "%s", error)

    def _on_features(self, message):
        with self._lock:
            features = self._servo.source.read(message, self._camera, self._servo.reference)
            self._link.image(convert.stamp_ns(message.header), features, convert.now_ns())
            self._answer_ready()

    def _on_deadman(self, message):
        with self._lock:
            self._link.deadman(message.data, convert.now_ns())

    def _answer_ready(self):
        for sight in self._link.sights(convert.now_ns()):
            self._answer(sight.stamp_ns, sight.features, sight)

    def _seen(self, features, joints):
        sight = joints
        if self._settings.predict and self._sequence.phase == "servo" and not self._servo.why_lost(features):
            sight = self._link.predict(sight, convert.now_ns(), self._servo.goal.plane_at, predicted)
        if sight.refusal:
            self._refused += 1
        else:
            self._answered += 1
        self._show_timing(sight)
        return sight.features, sight.q, sight.refusal

    def _show_timing(self, sight):
        image, joints = self._link.image_latency.summary(), self._link.joint_latency.summary()
        message = InputTiming(
            used=not sight.refusal, refusal=sight.refusal, image_age_s=sight.timing.image_age_s,
            joint_gap_s=sight.timing.gap_s, extrapolation_s=sight.timing.extrapolation_s,
            predicted_s=sight.timing.predicted_s, image_latency_mean_s=image.mean_s, image_latency_min_s=image.least_s,
            image_latency_max_s=image.most_s, joint_latency_mean_s=joints.mean_s, joint_latency_max_s=joints.most_s,
            answered=self._answered, refused=self._refused)
        message.header.stamp = convert.to_time(sight.stamp_ns)
        self._timing_publisher.publish(message)
        rospy.loginfo_throttle(SHOW_LATENCY_S, "%s; %s", image.text("images"), joints.text("joint states"))

    # --- commands to the arm -----------------------------------------------------------------------------------

    def _send(self, command):
        self._link.take(command, convert.now_ns())

    def _begin_lockstep(self):
        """There is none."""

    def _check_ready(self):
        unfit = self._link.unfit(convert.now_ns())
        if unfit is not None:
            raise ParameterError(f"the arm must rest: {unfit.reason}")

    def _stop(self, reason):
        super()._stop(reason)
        self._link.end(convert.now_ns())

    def _finish(self, record):
        self._link.end(convert.now_ns())
        super()._finish(record)

    def _publish_state(self, record):
        status = Status.JOINT_LIMIT if self._blocked and record.status == Status.SERVOING else record.status
        text = self._told(record.status, record.status_text)
        super()._publish_state(replace(record, status=status, status_text=text))

    def _told(self, status, text):
        return f"{text}; {self._slowed}" if self._slowed and status in SLOWED else text

    def _command_loop(self):
        """Send a command in every period, until shutdown. ROS time may be set back, and then the loop goes on."""
        rate = rospy.Rate(1.0 / self._settings.command_period_s, reset=True)
        while not rospy.is_shutdown():
            try:
                rate.sleep()
            except rospy.ROSInterruptException:
                return
            with self._lock:
                try:
                    self._tick(convert.now_ns())
                except Exception as error:
                    if rospy.is_shutdown():
                        return
                    self._link.rest()
                    rospy.logerr("command: %s\n%s", error, traceback.format_exc())
                    self._fault(convert.now_ns(), f"{type(error).__name__}: {error}")

    def _tick(self, now_ns):
        self._answer_ready()
        tick = self._link.tick(now_ns)
        self._slowed, self._blocked = tick.slowed, tick.blocked
        if tick.point is not None:
            for message in self._form.messages(tick.point._replace(frame_id=self._twist_frame_id)):
                self._publishers[message.topic].publish(convert.form_message(message))
        self._heed(tick.unfit, now_ns)
        if not self._session.stale:
            self._watch()

    def _heed(self, unfit, now_ns):
        """Tell why the arm must rest, once for each reason, and end the goal where the reason says so."""
        kind = "" if unfit is None else unfit.reason.split(" for ")[0]
        known, self._unfit = self._unfit, kind
        if unfit is None or kind == known:
            return
        rospy.logwarn("the arm rests: %s", unfit.reason)
        if unfit.jumped:
            self._stop(unfit.reason)
            self._link.clear()
            self._session.restart_time()
            self._server.look_at_time()
        elif not self._session.active:
            self._publish_state(ServoRecord(now_ns, Status.IDLE, f"the arm rests: {unfit.reason}"))
        elif unfit.ends:
            self._stop(unfit.reason)
        else:
            self._publish_state(self._session.hold(now_ns, unfit.reason)[1])


def main() -> int:
    """Entry of node real_controller. Returns the exit code: 0 after a shutdown, 2 for bad parameters."""
    return run_node(RealControllerNode)
