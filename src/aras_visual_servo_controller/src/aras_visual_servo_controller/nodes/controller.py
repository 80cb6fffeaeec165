"""Node `controller`: answers every image with one command. This file holds ROS wiring only. The session and the
core of aras_visual_servo decide the answer.

Threads: rospy calls back from one thread per connection, and one worker thread of this node runs goals, preempts and
the watchdog. All of them take `_lock` first and the action server's lock second. The callbacks of the action server
already hold its lock when they are called, so they only put work into the worker's queue.
"""

import queue
import threading
import time
import traceback
import warnings
from typing import Any, Callable

import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger, TriggerResponse

from aras_visual_servo import ArasError, ParameterError, Reference, ServoRecord, Session, StampPairer, Status
from aras_visual_servo.processes import check_signals
from aras_visual_servo_msgs.msg import ServoState, SimStatus, VisualServoAction, VisualServoFeedback, VisualServoResult
from aras_visual_servo_msgs.srv import PauseAt, PauseAtRequest, SetReference, SetReferenceRequest, Teach, TeachResponse
from ..real.float_commands import SetPointIntegrator
from . import conversions as convert
from .calls import ActionServer, call_service
from .null_space_topic import NullSpaceTopic
from .parameters import ControllerSetup, Parameters
from .pixel_camera import PixelCamera

LONGEST_PAUSE_S = 1e4     # simulated time after the end of a goal
WORKER_PERIOD_S = 0.05    # wall time; watchdog
STATUS_PERIOD_S = 0.2     # wall time; actionlib's status topic
CLOCK_LAG_NS = 500000000  # simulated time by which the clock may come later than images; more is a clock set back
HELD_S = 0.5              # wall time; a simulator that holds for longer when this node starts waits for a lost answer
STATE_QUEUE = 1000        # messages that wait for a slow listener; sim/step draws images without waiting for it
EXIT_STOPPED, EXIT_PARAMETERS = 0, 2


class ControllerNode:
    """The node. It raises ParameterError, which lists every fault of the parameters."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._work = queue.Queue()  # not SimpleQueue: interrupted by a slow signal handler, its get waits forever
        self._read_parameters()
        self._pairer = StampPairer()
        self._joints = convert.JointReader(self._kinematics.joint_names)
        self._preempted, self._lacking = False, ""  # why no joint state can be paired, where that is known
        self._pause_after_ns = 0  # after the end of the goal; 0: the simulator goes on
        self._frame_id = ""
        self._feedback_wall_s = self._status_wall_s = time.monotonic()
        self._feedback_phase = ""
        self._time_restarts = 0
        # (stamp at which the simulator holds or -1, wall time since when); None once the first image was answered.
        self._held = None
        self._restore_reference()
        self._advertise()

    # --- set-up -------------------------------------------------------------------------------------------------

    def _read_parameters(self):
        setup = ControllerSetup(self._teach_camera)
        self._kinematics, self._servo, self._sequence = setup.kinematics, setup.servo, setup.sequence
        self._feedback_period_s = 1.0 / setup.feedback_rate_hz
        self._float_publishers = {joint: rospy.Publisher(name + "/command", Float64, queue_size=10, tcp_nodelay=True)
                                  for joint, name in setup.controllers.items()}
        limits = setup.servo.config
        self._session = Session(setup.sequence, limits.input_timeout_s, limits.time_limit_s)
        self._integrator = SetPointIntegrator(setup.kinematics.joint_names, setup.kinematics.lower,
                                              setup.kinematics.upper, round(limits.input_timeout_s * 1e9))

    def _restore_reference(self):
        """Take over the reference that an earlier controller node left on the parameter server when it ended."""
        stored = rospy.get_param("~taught_reference", None)
        if stored is None:
            return
        try:
            self._servo.set_reference(Reference.from_dict(stored))
            rospy.loginfo("took over the reference taught before")
        except ArasError as error:
            rospy.logwarn("the reference on the parameter server cannot be used: %s", error)

    def _store_reference(self):
        """Keep the taught reference on the parameter server, for a controller node that is started after this one."""
        rospy.set_param("~taught_reference", self._servo.reference.to_dict())

    def _connect_arm(self):
        """Topics between this node and the arm: those of the simulator."""
        with warnings.catch_warnings():
            # No queue: rospy then sends from the calling thread, and the answer does not wait for another to wake up.
            warnings.simplefilter("ignore", SyntaxWarning)
            self._command_publisher = rospy.Publisher("joint_command", JointState, queue_size=None, tcp_nodelay=True)
        self._status_subscriber = rospy.Subscriber("sim/status", SimStatus, self._on_sim_status)

    def _advertise(self):
        self._state_publisher = rospy.Publisher("servo_state", ServoState, queue_size=STATE_QUEUE, tcp_nodelay=True)
        self._bars = NullSpaceTopic(self._kinematics, self._servo)
        # The worker publishes the status. actionlib's timer runs on simulated time, too often when that goes fast.
        rospy.set_param("~actionlib_status_frequency", 0.0)
        self._server = ActionServer("servo", VisualServoAction)
        self._server.register_goal_callback(lambda: self._work.put(self._accept_goal))
        self._server.register_preempt_callback(lambda: self._work.put(self._preempt))
        self._pause_at = rospy.ServiceProxy("sim/pause_at", PauseAt)
        self._connect_arm()
        self._server.start()
        rospy.Service("teach", Teach, self._on_teach)
        rospy.Service("stop", Trigger, self._on_stop)
        rospy.Service("reconfigure", Trigger, self._on_reconfigure)
        rospy.Subscriber("joint_states", convert.LazyJointState, self._on_joints, tcp_nodelay=True)
        source, self._camera = self._servo.source, PixelCamera()
        if source.from_elsewhere:
            rospy.Subscriber("camera/camera_info", CameraInfo, self._camera.set_info)
        rospy.Subscriber(source.topic, convert.message_class(source.message), self._on_features, tcp_nodelay=True)

    # --- one image, one answer ----------------------------------------------------------------------------------

    def _on_joints(self, message):
        with self._lock:
            stamp_ns = message.stamp_ns
            joints = message if self._joints.is_whole(message) else self._merged(message)
            if joints is None:
                return
            self._lacking = ""
            self._answer_all(stamp_ns, self._pairer.add_joints(stamp_ns, joints))
            if self._float_publishers:
                for joint, set_point in self._integrator.advance(stamp_ns).items():
                    self._float_publishers[joint].publish(set_point)

    def _merged(self, message):
        """(n,) positions of this stamp, from this message and others; None while some have yet to come."""
        try:
            return self._joints.merged(message.unpack(), 0.0)
        except ArasError as error:
            self._lacking = f"; {error}"
            rospy.logwarn_throttle(1.0, "%s", error)
            return None

    def _on_features(self, message):
        with self._lock:
            stamp_ns = convert.stamp_ns(message.header)
            features = self._servo.source.read(message, self._camera, self._servo.reference)
            self._answer_all(stamp_ns, self._pairer.add_features(stamp_ns, features))

    def _answer_all(self, stamp_ns, pairs):
        """Answer the pairs that a message of this stamp has completed. It may have shown that time went back."""
        if self._pairer.restarts != self._time_restarts:
            self._time_restarts = self._pairer.restarts
            # An image that is no later than this message was answered already in the new time.
            if not (self._session.active and 0 <= self._session.last_ns <= stamp_ns):
                self._restart_time()
        for pair in pairs:
            self._answer(*pair)

    def _restart_time(self):
        """Start anew, since time went back. A goal that has seen no image yet belongs to the new time and goes on."""
        rospy.loginfo("time went back: starting anew")  # after a reset of the simulator
        self._integrator.reset()
        if not self._session.unseen:
            self._stop("time went back")
        self._session.restart_time()
        self._server.look_at_time()

    def _answer(self, stamp_ns, features, joints):
        """Answers one image: sends the command first, then the record of the look. Never raises."""
        self._frame_id = features.header.frame_id
        session = self._session
        try:
            seen, q, refusal = self._seen(features, joints)
            command, record = session.answer(stamp_ns, seen, q, convert.now_ns(), time.monotonic(), refusal)
            if session.active and self._sequence.done:
                self._pause_simulator(stamp_ns)
            self._send(command)
            if record.status == Status.STALE_INPUT:
                rospy.logwarn_throttle(1.0, record.status_text)
            self._publish_state(record)
            if self._sequence.teach_stamp_ns == stamp_ns:
                self._store_reference()
            if session.active and self._sequence.done:
                session.active = False
                self._finish(record)
        except Exception as error:  # after any error at all the arm has to stop and the node has to go on
            rospy.logerr("image %.3f s: %s\n%s", stamp_ns * 1e-9, error, traceback.format_exc())
            self._fault(stamp_ns, f"{type(error).__name__}: {error}")

    def _seen(self, features, joints):
        """(features, (n,) joint positions or None, why the image must not be used or "") of an image."""
        if joints is not None and not isinstance(joints, np.ndarray):
            joints = self._joints.positions(joints.unpack())
        return features, joints, ""

    def _pause_simulator(self, stamp_ns):
        """Where the goal asked for it, tell the simulator when to pause; in lockstep it waits for our command now."""
        if not self._pause_after_ns:
            return
        try:
            response = self._pause_at(PauseAtRequest(convert.to_time(stamp_ns + self._pause_after_ns)))
            if not response.success:
                rospy.logwarn("sim/pause_at: %s", response.message)
        except rospy.ServiceException as error:  # no simulator, or it has ended
            rospy.logwarn("the goal asks for a pause after its end: %s", error)

    def _fault(self, stamp_ns, reason):
        """Stop the arm and end the goal with status FAULT."""
        try:
            was_active = self._session.active
            command, record = self._session.end(stamp_ns, reason, Status.FAULT)
            self._send(command)
            self._publish_state(record or ServoRecord(stamp_ns, Status.FAULT, reason))
            if was_active:
                self._finish(record)
        except Exception as error:
            rospy.logerr("the arm could not be told to stop: %s\n%s", error, traceback.format_exc())

    def _send(self, command):
        message = convert.command_message(command)
        if self._float_publishers:
            if message.name and self._session.seen is not None:
                self._integrator.command(command, self._session.seen.q)
            message = convert.acknowledgement(command.stamp_ns)
        self._command_publisher.publish(message)

    def _publish_state(self, record):
        message = convert.state_message(record, self._frame_id)
        self._state_publisher.publish(message)
        self._bars.show(record, self._frame_id)
        now_s = time.monotonic()
        if record.phase != self._feedback_phase or now_s - self._feedback_wall_s >= self._feedback_period_s:
            if self._session.active:
                self._feedback_wall_s, self._feedback_phase = now_s, record.phase
                self._server.publish_feedback(VisualServoFeedback(message))

    def _finish(self, record):
        """Report the end of the goal: the last state as feedback, then the result."""
        self._feedback_phase = ""
        self._server.publish_feedback(VisualServoFeedback(convert.state_message(record, self._frame_id)))
        converged, status, reason, e, duration_s = self._session.outcome(record)
        reason = self._told(status, reason)
        result = VisualServoResult(converged=bool(converged), status=int(status), reason=reason,
                                   feature_names=list(record.feature_names), e=[float(value) for value in e],
                                   duration_s=float(duration_s))
        rospy.loginfo("servo: %s, %s", Status(status).name, reason)
        report = self._server.set_aborted
        if converged or status in (Status.SETTLED, Status.STOPPED_BY_RULE):
            report = self._server.set_succeeded
        elif self._preempted:
            report = self._server.set_preempted
        report(result, reason)

    def _told(self, status, text):
        """The reason of a status, with what the arm adds to it."""
        return text

    # --- goals, services, watchdog (worker and service threads) -------------------------------------------------

    def spin(self) -> None:
        """Work until shutdown."""
        while not rospy.is_shutdown():
            try:
                task = self._work.get(timeout=WORKER_PERIOD_S)
            except queue.Empty:
                task = None
            try:
                with self._lock:
                    if task is not None:
                        task()
                    self._watch()
            except Exception:  # a publisher that the shutdown closed, or a bug of this node: neither may end the node
                if not rospy.is_shutdown():
                    rospy.logerr(traceback.format_exc())

    def _accept_goal(self):
        goal = self._server.accept_new_goal() if self._server.is_new_goal_available() else None
        if goal is None:
            return
        if self._session.active:  # the action server has told the client of the old goal
            self._send(self._session.end(convert.now_ns(), "another goal came")[0])
        if self._session.last_ns - convert.now_ns() > CLOCK_LAG_NS:
            # Without this the first image of the new time could be paired with joints of the old one.
            self._pairer.clear()
            self._restart_time()
        self._preempted = False
        try:
            self._check_ready()
            self._pause_after_ns = self._pause_after(goal.pause_after_s)
            self._session.begin(goal.reference, goal.law, goal.gains_per_s, goal.thresholds, goal.time_limit_s,
                                convert.now_ns(), time.monotonic())
        except ParameterError as error:
            rospy.logerr("goal refused:\n%s", error)
            reason = "; ".join(error.faults)
            self._server.set_aborted(VisualServoResult(status=int(Status.FAULT), reason=reason), reason)
            return
        self._begin_lockstep()
        rospy.loginfo("goal accepted: %s", goal.reference)

    @staticmethod
    def _pause_after(pause_after_s):
        """In ns. Raises ParameterError when it is negative, not finite or longer than a pause can be asked for."""
        if not 0.0 <= pause_after_s <= LONGEST_PAUSE_S:
            raise ParameterError(f"pause_after_s: found {pause_after_s:g}, allowed 0 to {LONGEST_PAUSE_S:g} s")
        return round(pause_after_s * 1e9)

    def _check_ready(self):
        """Raises ParameterError when the arm cannot take a goal now; the simulator's always can."""

    def _begin_lockstep(self):
        """In lockstep the simulator waits for our answers from the first message on. This one has no stamp, so that it
        does not count as an answer to any image, and not as one of the time before a reset that this node may not have
        heard of yet."""
        self._command_publisher.publish(convert.acknowledgement(0))

    def _preempt(self):
        if self._session.active and self._server.is_preempt_requested() and not self._server.is_new_goal_available():
            self._preempted = True
            self._stop("preempted")

    def _stop(self, reason):
        """Stop the arm and end the goal, between two images; without a goal the arm is told to stand still."""
        command, record = self._session.end(convert.now_ns(), reason)
        self._send(command)
        if record is not None:
            self._publish_state(record)
            self._finish(record)

    def _on_stop(self, request):
        with self._lock:
            was_active = self._session.active
            self._stop(f"stopped by {request._connection_header.get('callerid', 'a service call')}")
            return TriggerResponse(True, "stopped" if was_active else "there was no goal; the arm stands still")

    def _on_reconfigure(self, _request):
        """Read the section `servo` again and go on with it, also in the middle of a goal."""
        with self._lock:
            parameters = Parameters()
            try:
                section = parameters.section("servo")
                parameters.check()
                servo = self._servo.retuned(section)
            except ArasError as error:
                return TriggerResponse(False, str(error))
            self._servo = servo
            self._sequence.use(servo)
            self._bars.use(servo)
            return TriggerResponse(True, "the servo goes on with the settings of now")

    def _on_teach(self, request):
        with self._lock:
            try:
                stamp_ns = self._session.teach(request.z_star_m or None)
                self._store_reference()
            except (ArasError, rospy.ROSException, rospy.ServiceException) as error:
                return TeachResponse(False, str(error), rospy.Time())
            return TeachResponse(True, "this view is the goal", convert.to_time(stamp_ns))

    def _teach_camera(self, stamp_ns, z_star_m):
        """Make the image of this stamp the camera node's reference, however many have come since.

        Raises: ParameterError: the camera node refused.  rospy.ROSException, ServiceException: it does not answer.
        """
        if self._servo.source.from_elsewhere:
            return  # no camera node makes these features
        if stamp_ns == 0:
            raise ParameterError("camera/set_reference: the image of time 0 cannot be asked for (a stamp of 0 means "
                                 "none), teach a later one")
        call_service("camera/set_reference", SetReference,
                     SetReferenceRequest(z_star_m=z_star_m, stamp=convert.to_time(stamp_ns)))

    def _watch(self):
        wall_s, now_ns = time.monotonic(), convert.now_ns()
        if wall_s - self._status_wall_s > STATUS_PERIOD_S:
            self._status_wall_s = wall_s
            self._server.look_at_time()
            self._server.action_server.publish_status()
        if self._held is not None:
            self._release_simulator(wall_s)
        was_stale = self._session.stale
        answer = self._session.watch(now_ns, wall_s)
        if answer is None:
            return
        command, record = answer
        record.status_text += self._lacking
        if command is not None:
            self._send(command)
        if not was_stale:
            rospy.logwarn(record.status_text)
        self._publish_state(record)
        if not self._session.active:
            self._finish(record)

    def _on_sim_status(self, message):
        """Note whether the simulator waits for an answer that an earlier controller node, which has ended, owes it.

        After this node has answered its first image that cannot be, and the subscription is dropped.
        """
        with self._lock:
            if self._session.frame >= 0:
                self._held = None
                self._work.put(self._status_subscriber.unregister)
                return
            stamp_ns = convert.stamp_ns(message.header) if message.holding else -1
            if self._held is None or self._held[0] != stamp_ns:
                self._held = (stamp_ns, time.monotonic())

    def _release_simulator(self, wall_s):
        """Answer in the place of an earlier controller node, if the simulator has waited for HELD_S."""
        stamp_ns, since_s = self._held
        if self._session.frame < 0 and stamp_ns >= 0 and wall_s - since_s > HELD_S:
            rospy.logwarn("the simulator waits at %.3f s for an answer that an earlier controller did not send: "
                          "answered in its place", stamp_ns * 1e-9)
            self._held = (-1, wall_s)
            self._command_publisher.publish(convert.acknowledgement(stamp_ns))


def main(make: Callable[[], Any] = ControllerNode) -> int:
    """Entry of node controller. Args: make: class of the node. Returns 0 after a shutdown, 2 for bad parameters."""
    rospy.init_node("controller", disable_signals=True)  # its handler shuts down from within whatever holds a lock
    check_signals()
    try:
        node = make()
    except ParameterError as error:
        rospy.logfatal("bad parameters:\n%s", error)
        return EXIT_PARAMETERS
    node.spin()
    return EXIT_STOPPED
