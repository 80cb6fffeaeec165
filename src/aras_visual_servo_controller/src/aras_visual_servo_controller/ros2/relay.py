"""Node `ros2_relay`: the ROS 1 side of the relay. It finds what the graph offers, and starts and feeds the ROS 2 side.

The connections of topics are handed to the ROS 2 side (`tcpros.py`), so that their messages do not pass through here.
Threads: `_read` serves the ROS 2 side, and the main thread looks at the graph.
"""

import io
import json
import os
import re
import socket
import threading
import time
import warnings
from typing import Any, Dict, List, Optional

import actionlib
import numpy as np
import roslib.message
import rospy
from actionlib_msgs.msg import GoalStatus
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty, Trigger

from aras_visual_servo import ArasError, Command, ParameterError, kinematics_of
from aras_visual_servo.processes import check_signals
from aras_visual_servo_msgs.msg import VisualServoAction
from aras_visual_servo_msgs.srv import PauseAt, SetJointPositions, SetReference, SetTargetPose, Step, Teach
from ..nodes import conversions as convert
from . import environment, wire
from .channel import CALL, CONTROL, Channel
from .tcpros import Handover, Publication, Subscription
from .twist import TwistToJoints

LOOK_PERIOD_S = 0.5    # wall time between looks at the graph
START_TIMEOUT_S = 30.0  # wall time for the ROS 2 side to start
CONNECT_TIMEOUT_S, CONNECT_PERIOD_S = 5.0, 0.1  # wall time for connections of topics that a ROS 2 node just began with
#: Topics outside of the namespace that are relayed too.
OUTSIDE = ("/clock", "/tf", "/tf_static")
#: ROS 1 keeps the last message of these for late listeners, and so does ROS 2.
KEPT = ("/tf_static", "scenario", "sim/status")
#: Names in the namespace that ROS 2 nodes may publish on.
INPUTS = re.compile(r"joint_command|.*/command|(.*/)?cmd_vel")
TWIST, TWIST_TYPE = "camera_twist", "geometry_msgs/TwistStamped"
SERVICES = {"teach": Teach, "stop": Trigger, "reconfigure": Trigger, "camera/set_reference": SetReference,
            "sim/pause": Empty, "sim/unpause": Empty, "sim/reset": Empty, "sim/step": Step, "sim/pause_at": PauseAt,
            "sim/set_joint_positions": SetJointPositions, "sim/set_target_pose": SetTargetPose}
ACTION = "servo"
EXIT_STOPPED, EXIT_PARAMETERS, EXIT_BROKEN = 0, 2, 3


class RelayError(ArasError):
    """The relay cannot go on."""


class _Twist:
    """Twists of the camera, answered with joint commands."""

    def __init__(self, kinematics: Any) -> None:
        self._class = roslib.message.get_message_class(TWIST_TYPE)
        self._from_cdr = wire.from_cdr(self._class)
        self._joints = convert.JointReader(kinematics.joint_names)
        self._to_joints = TwistToJoints(kinematics)
        self._publisher = _publisher("joint_command", JointState)
        self._subscriber = None

    def _on_joints(self, message):
        self._to_joints.add(convert.stamp_ns(message.header), self._joints.positions(message))

    def listen(self, on: bool) -> None:
        """A ROS 2 node began or ended to publish twists: only then the joint positions of images are needed."""
        if on and self._subscriber is None:
            self._subscriber = rospy.Subscriber("image_joint_states", JointState, self._on_joints, tcp_nodelay=True)
        elif not on and self._subscriber is not None:
            self._subscriber.unregister()
            self._subscriber = None

    def take(self, data: bytes) -> None:
        """Commands what a TwistStamped asks for."""
        message = self._class().deserialize(self._from_cdr(data, 0))
        v, w, stamp_ns = message.twist.linear, message.twist.angular, convert.stamp_ns(message.header)
        velocities = self._to_joints.velocities(stamp_ns, np.array([v.x, v.y, v.z, w.x, w.y, w.z]))
        if velocities is None:
            rospy.logwarn_throttle(5.0, "%s: the twist of %.3f s was not used: it must be finite and carry the stamp "
                                   "of an image", TWIST, stamp_ns * 1e-9)
        # Without velocities this answers the image, for which a simulator in lockstep waits, and moves nothing.
        self._publisher.publish(convert.command_message(Command(stamp_ns, velocity=velocities or {})))


class _Service:
    """A service of ROS 1 that ROS 2 nodes call. Each call has a thread, because a service may wait for commands."""

    def __init__(self, relay: "Relay", number: int, name: str, kind: Any) -> None:
        self._send, self._number, self._kind, self._relay = relay.channel.send, number, kind, relay
        self._call = rospy.ServiceProxy(name, kind)
        self._from_cdr, self._to_cdr = wire.from_cdr(kind._request_class), wire.to_cdr(kind._response_class)

    def take(self, data: bytes) -> None:
        """Calls the service and sends the answer."""
        threading.Thread(target=self._serve, args=(data,), daemon=True).start()

    def _serve(self, data):
        response = self._kind._response_class()
        try:
            request = self._kind._request_class().deserialize(self._from_cdr(data[CALL.size:], 0))
            self._relay.connect()
            response = self._call(request)
        except (rospy.ServiceException, ArasError) as error:
            rospy.logwarn("%s: %s", self._call.resolved_name, error)
            for name in ("message", "status_message"):
                if hasattr(response, name):
                    setattr(response, name, str(error))
        self._send(self._number, data[:CALL.size] + self._to_cdr(_bytes_of(response), 0))


class _Action:
    """The action of ROS 1, for goals of ROS 2 nodes."""

    def __init__(self, relay: "Relay", number: int, name: str, action: Any) -> None:
        self._send, self._number = relay.channel.send, number
        self._client = actionlib.ActionClient(name, action)
        made = action()
        self._goal_class = type(made.action_goal.goal)
        self._from_cdr = wire.from_cdr(self._goal_class)
        self._feedback_to_cdr = wire.to_cdr(type(made.action_feedback.feedback))
        self._result_class = type(made.action_result.result)
        self._result_to_cdr = wire.to_cdr(self._result_class)
        self._handles: Dict[bytes, Any] = {}

    def take(self, data: bytes) -> None:
        """Sends a goal, or cancels one: then there is its number only."""
        call = data[:CALL.size]
        if len(data) == CALL.size:
            if call in self._handles:
                self._handles[call].cancel()
            return
        goal = self._goal_class().deserialize(self._from_cdr(data[CALL.size:], 0))
        threading.Thread(target=self._begin, args=(call, goal), daemon=True).start()

    def _begin(self, call, goal):
        self._client.wait_for_server()
        self._handles[call] = self._client.send_goal(
            goal, lambda handle: self._on_change(call, handle), lambda _, message: self._tell(
                call, 0, self._feedback_to_cdr(_bytes_of(message), 0)))

    def _on_change(self, call, handle):
        if handle.get_comm_state() == actionlib.CommState.DONE:
            self._handles.pop(call, None)
            result = handle.get_result() or self._result_class()
            self._tell(call, handle.get_terminal_state() or GoalStatus.ABORTED,
                       self._result_to_cdr(_bytes_of(result), 0))

    def _tell(self, call, status, data):
        self._send(self._number, call + bytes([status]) + data)


class Relay:
    """Starts the ROS 2 side and keeps it fed.

    Raises: ArasError: there is no ROS 2 environment, it is not whole or not of this version, or the ROS 2 side did not
        start.  ParameterError: another ROS 2 is in the shell, or the robot's parameters are wrong.
    """

    def __init__(self) -> None:
        environment.check_shell(os.environ)
        folder = environment.find_environment()
        ours, theirs = socket.socketpair()
        give, get = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        name = rospy.get_name().strip("/").replace("/", "_")
        program = os.path.join(os.path.dirname(__file__), "door.py")
        sockets = [theirs.fileno(), get.fileno()]
        self._process = environment.start([program, *map(str, sockets), name], os.environ, sockets, folder)
        theirs.close()
        get.close()
        self.channel, self.handover = Channel(ours), Handover(give)
        self._ready, self._told = threading.Event(), threading.Event()
        self._fields: Dict[str, Optional[List[List[str]]]] = {}
        self._entries: Dict[int, Any] = {}
        self._names: Dict[str, int] = {}
        threading.Thread(target=self._read, daemon=True).start()
        if not self._ready.wait(START_TIMEOUT_S) or self._process.poll() is not None:
            self._process.kill()
            raise RelayError(f"the ROS 2 side did not start: {folder}/bin/python ended or hangs; "
                             f"run {environment.INSTALL}")
        self._twist = self._kinematics()

    def _kinematics(self):
        """Kinematics for twists of the camera; None where there is no robot with a camera."""
        key = rospy.search_param("robot_description")
        robot = rospy.get_param("scenario/robot", None)
        return kinematics_of(rospy.get_param(key), robot) if key and robot else None

    def connect(self) -> None:
        """Waits until messages come of all topics with subscribers, up to CONNECT_TIMEOUT_S.

        So a ROS 2 node that listens and then starts time misses no message.
        """
        deadline = time.monotonic() + CONNECT_TIMEOUT_S
        waited = False
        while time.monotonic() < deadline and not all(
                entry.connected for entry in list(self._entries.values()) if isinstance(entry, Subscription)):
            waited = True
            time.sleep(CONNECT_PERIOD_S)
        if waited:
            time.sleep(CONNECT_PERIOD_S)  # a connection counts slightly before the publisher sends on it

    # --- from the ROS 2 side --------------------------------------------------------------------------------------

    def _read(self):
        for number, data in self.channel.frames():
            if number == CONTROL:
                told = json.loads(data)
                if told["do"] == "ready":
                    self._ready.set()
                elif told["do"] == "types":
                    self._fields.update(told["fields"])
                    self._told.set()
                elif told["do"] == "lost":
                    self._entries[told["number"]].lost(told["peer"])
                elif told["do"] == "warn":
                    rospy.logwarn("from ROS 2: %s", told["text"])
                else:
                    self._entries[told["number"]].listen(told["on"])
            else:
                try:
                    self._entries[number].take(data)
                except (ArasError, rospy.ROSException) as error:
                    rospy.logwarn("from ROS 2: %s", error)
        if not rospy.is_shutdown():
            rospy.logfatal("the ROS 2 side has ended")
            rospy.signal_shutdown("the ROS 2 side has ended")
        for waited in (self._ready, self._told):
            waited.set()

    # --- what the graph offers ------------------------------------------------------------------------------------

    def spin(self) -> None:
        """Looks at the graph until shutdown. Raises RelayError: a type differs between the two sides."""
        try:
            while not rospy.is_shutdown():
                self._look()
                time.sleep(LOOK_PERIOD_S)
        except BrokenPipeError:
            raise RelayError("the ROS 2 side has ended") from None
        finally:
            self._process.terminate()
            self._process.wait()

    def _look(self):
        namespace = rospy.get_namespace()
        master = rospy.get_master()
        for entry in list(self._entries.values()):
            if isinstance(entry, Subscription):
                entry.update()
        published, subscribed, services = master.getSystemState()[2]
        types = dict(master.getTopicTypes()[2])
        outside = [rospy.resolve_name(topic) for topic in OUTSIDE]
        inputs, outputs = [], []
        for topic, nodes in sorted({**dict(subscribed), **dict(published)}.items()):
            name, kind = topic[len(namespace):], types.get(topic, "*")
            if topic in self._names or kind == "*" or not (topic.startswith(namespace) or topic in outside):
                continue
            if topic.startswith(namespace) and INPUTS.fullmatch(name):
                inputs.append((topic, kind))
            elif set(dict(published).get(topic, ())) - {rospy.get_name()}:
                outputs.append((topic, kind))
        if self._twist is not None and rospy.resolve_name(TWIST) not in self._names:
            inputs.append((rospy.resolve_name(TWIST), TWIST_TYPE))
        self._learn([kind for _, kind in (*inputs, *outputs)])
        kept = {rospy.resolve_name(topic) for topic in KEPT}
        for topic, kind in outputs:
            if self._usable(kind):
                number = self._enter(topic)
                self._entries[number] = Subscription(self.handover, number, topic)
                self.channel.tell(do="out", number=number, topic=topic, type=kind, kept=topic in kept,
                                  layout=wire.layout_of(roslib.message.get_message_class(kind)))
        for topic, kind in inputs:
            if self._usable(kind):
                number = self._enter(topic)
                if topic == rospy.resolve_name(TWIST):
                    self._entries[number], layout = _Twist(self._twist), None
                else:
                    message = roslib.message.get_message_class(kind)
                    self._entries[number] = Publication(self.handover, number, _publisher(topic, message))
                    layout = wire.layout_of(message)
                self.channel.tell(do="into", number=number, topic=topic, type=kind, layout=layout)
        offered = {name for name, _ in services}
        for name, kind in SERVICES.items():
            full = rospy.resolve_name(name)
            if full in offered and full not in self._names:
                number = self._enter(full)
                self._entries[number] = _Service(self, number, full, kind)
                self.channel.tell(do="service", number=number, name=full, type=kind._type)
        full = rospy.resolve_name(ACTION)
        if full not in self._names and full + "/status" in dict(published):
            number = self._enter(full)
            self._entries[number] = _Action(self, number, full, VisualServoAction)
            self.channel.tell(do="action", number=number, name=full, type=VisualServoAction._type[:-len("Action")])

    def _enter(self, name):
        self._names[name] = len(self._names) + 1
        return self._names[name]

    def _learn(self, kinds):
        """Asks the ROS 2 side for the fields of types, and of the types within them, that were not asked for."""
        wanted = {inner for kind in kinds for inner in _within(kind)} - set(self._fields)
        if wanted:
            self._told.clear()
            self.channel.tell(do="types", names=sorted(wanted))
            if not self._told.wait(START_TIMEOUT_S) or not wanted <= set(self._fields):
                raise RelayError("the ROS 2 side does not answer")

    def _usable(self, kind):
        """Whether ROS 2 has this type and all within it. Raises RelayError: it has another definition of one."""
        for inner in _within(kind):
            if self._fields[inner] is None:
                return False
            found = list(map(tuple, self._fields[inner]))
            wanted = wire.fields_of(roslib.message.get_message_class(inner))
            if inner != "std_msgs/Header" and found != wanted:
                raise RelayError(f"{inner}: ROS 2's definition is another one; run {environment.INSTALL}")
        return True


def _within(kind):
    """Names of a message type and of all types that it holds."""
    found = roslib.message.get_message_class(kind)
    if found is None:
        return set()
    names = {found._type}
    for slot in found._slot_types:
        base = slot.partition("[")[0]
        if "/" in base or base == "Header":
            names |= _within("std_msgs/Header" if base == "Header" else base)
    return names


def _publisher(topic, kind):
    with warnings.catch_warnings():
        # No queue: the message is sent from the calling thread.
        warnings.simplefilter("ignore", SyntaxWarning)
        return rospy.Publisher(topic, kind, queue_size=None, tcp_nodelay=True)


def _bytes_of(message):
    """ROS 1 bytes."""
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def main() -> int:
    """Entry of node ros2_relay. Returns the exit code: 0 after a shutdown, 2 bad input, 3 could not run."""
    rospy.init_node("ros2_relay", disable_signals=True)
    check_signals()
    try:
        Relay().spin()
    except ParameterError as error:
        rospy.logfatal("ros2_relay:\n%s", error)
        return EXIT_PARAMETERS
    except ArasError as error:
        rospy.logfatal("ros2_relay: %s", error)
        return EXIT_BROKEN
    return EXIT_STOPPED
