"""Conversions between the core's data and ROS messages. Times are integer nanoseconds, joints are matched by name."""

import io
import math
import struct
import time
from typing import Any, Optional, Sequence

import numpy as np
import roslib.message
import rospy
from geometry_msgs.msg import Twist, Vector3
from sensor_msgs.msg import Image, JointState

from aras_visual_servo import Command, NotFiniteError, ParameterError, ServoRecord, ShapeError
from aras_visual_servo_msgs.msg import ServoState, VisualServoActionGoal

_SEQ_SECS_NSECS = struct.Struct("<3I")
_NS_PER_S = 1_000_000_000
_THREE_EMPTY_ARRAYS = 12  # bytes at the end of a JointState without positions, velocities and efforts
#: Joints that have been missing for so long are named.
MISSING_NS = _NS_PER_S


def stamp_ns(header: Any) -> int:
    """Stamp of a header [ns]."""
    return header.stamp.secs * _NS_PER_S + header.stamp.nsecs


def to_time(time_ns: int) -> rospy.Time:
    """rospy.Time of integer nanoseconds; negative ones become 0."""
    return rospy.Time(*divmod(max(int(time_ns), 0), _NS_PER_S))


def now_ns() -> int:
    """ROS time now [ns]; 0 before the first /clock message."""
    now = rospy.get_rostime()
    return now.secs * _NS_PER_S + now.nsecs


def message_class(name: str) -> Any:
    """Class of the message "package/Type". Raises ParameterError: there is no such message."""
    found = roslib.message.get_message_class(name)
    if found is None:
        raise ParameterError(f"message: found '{name}', allowed package/Type of a package that is built and sourced")
    return found


class LazyJointState(JointState):
    """A JointState that is unpacked only on demand, because only few of the joint states belong to an image."""

    def __init__(self) -> None:  # without the generated constructor, which would fill six unused fields
        self._data = b""

    def deserialize(self, data: bytes) -> "LazyJointState":
        self._data = data
        return self

    @property
    def stamp_ns(self) -> int:
        """Stamp, without unpacking the rest [ns]."""
        _, secs, nsecs = _SEQ_SECS_NSECS.unpack_from(self._data)
        return secs * _NS_PER_S + nsecs

    def begins_with(self, beginning: bytes) -> bool:
        """Whether frame and joint names, which follow the stamp, are these."""
        return self._data.startswith(beginning, _SEQ_SECS_NSECS.size)

    def beginning(self) -> bytes:
        """Frame and joint names, as `begins_with` takes them."""
        message, buffer = self.unpack(), io.BytesIO()
        JointState(header=message.header, name=message.name).serialize(buffer)
        return buffer.getvalue()[_SEQ_SECS_NSECS.size:-_THREE_EMPTY_ARRAYS]

    def unpack(self) -> JointState:
        """The whole message as a JointState."""
        return JointState().deserialize(self._data)


class JointReader:
    """Takes joint vectors in a fixed order out of JointState messages, whatever the order in the message.

    Drivers of a linear axis and an arm send messages of their own. `merged` makes whole joint vectors of them.
    """

    def __init__(self, joint_names: Sequence[str]) -> None:
        self._names = tuple(joint_names)
        self._order = {}
        self._whole = b"no message begins so"
        self._forget()

    def _forget(self):
        self._parts, self._met_ns, self._newest_ns = {}, None, -1

    def is_whole(self, message: LazyJointState) -> bool:
        """Whether a message names all joints. One that begins like the last whole one is not unpacked for that."""
        if not message.begins_with(self._whole):
            if not set(self._names) <= set(message.unpack().name):
                return False
            self._whole = message.beginning()
        return True

    def known_positions(self, message: Any) -> Optional[np.ndarray]:
        """(n,) positions, NaN for joints that the message does not name; None if it names none of them.

        Raises ShapeError: the message has another number of positions than of names.
        """
        index = {name: k for k, name in reversed(list(enumerate(message.name)))}
        if index.keys().isdisjoint(self._names):
            return None  # another part of the robot: a gripper, a base
        _check_positions(message)
        return np.array([message.position[index[name]] if name in index else math.nan for name in self._names])

    def merged(self, message: Any, apart_s: float) -> Optional[np.ndarray]:
        """(n,) positions, by name from this message and those before; None while others have yet to come.

        Args: apart_s: data older than this message by more than this time count as missing.
        Raises: ShapeError: joints have been missing for MISSING_NS, or the array has another length than names.
        """
        at_ns, q = stamp_ns(message.header), self.known_positions(message)
        if q is None:
            return None
        if at_ns < self._newest_ns - MISSING_NS:  # time was set back
            self._forget()
        self._newest_ns = max(at_ns, self._newest_ns)
        self._met_ns = at_ns if self._met_ns is None else self._met_ns
        self._parts.update((name, (at_ns, value)) for name, value in zip(self._names, q) if name in message.name)
        missing = [name for name in self._names if name not in self._parts
                   or abs(at_ns - self._parts[name][0]) > round(apart_s * 1e9)]
        if not missing:
            self._met_ns = at_ns
            return np.array([self._parts[name][1] for name in self._names])
        if at_ns - self._met_ns > MISSING_NS:
            raise ShapeError(f"joint_states: found {', '.join(message.name)}, missing {', '.join(missing)}"
                             + (f" within {apart_s:g} s" if apart_s else " of the same stamp"))
        return None

    def positions(self, message: Any) -> np.ndarray:
        """(n,) positions [m or rad]. Raises ShapeError: a joint is missing, or the array has another length than names.
        """
        key = tuple(message.name)
        order = self._order.get(key)
        if order is None:
            missing = [name for name in self._names if name not in key]
            if missing:
                raise ShapeError(f"joint_states: found {', '.join(key) or 'no joint'}, missing {', '.join(missing)}")
            self._order = {key: [key.index(name) for name in self._names]}
            order = self._order[key]
        _check_positions(message)
        return np.array([message.position[index] for index in order])


def _check_positions(message):
    if len(message.position) != len(message.name):
        raise ShapeError(f"joint_states: found {len(message.position)} positions, allowed {len(message.name)}")


def command_message(command: Command) -> JointState:
    """JointState of a `Command`.

    NaN stands for a position or velocity that the command does not give for a joint. A command without any is an
    acknowledgement.
    Raises: NotFiniteError: a position or velocity of the command is NaN or infinite; no part of it may be sent then.
    """
    message = JointState()
    message.header.stamp = to_time(command.stamp_ns)
    position, velocity = command.position, command.velocity
    for kind, values in (("position", position), ("velocity", velocity)):
        if not all(map(math.isfinite, values.values())):
            raise NotFiniteError(f"{kind} command {values}: allowed are finite numbers")
    if position:
        message.name = sorted(set(position) | set(velocity))
        message.position = [float(position.get(name, math.nan)) for name in message.name]
    else:
        message.name = list(velocity)
    if velocity:
        message.velocity = [float(velocity.get(name, math.nan)) for name in message.name]
    return message


def acknowledgement(time_ns: int) -> JointState:
    """JointState without joints: it answers the image of this stamp [ns] and commands nothing."""
    message = JointState()
    message.header.stamp = to_time(time_ns)
    return message


def goal_message(reference: str) -> VisualServoActionGoal:
    """VisualServoActionGoal with an id of its own. Args: reference: "experiment" or "taught"."""
    goal = VisualServoActionGoal()
    goal.goal_id.id = f"{rospy.get_name()}-{time.time_ns()}"
    goal.goal.reference = reference
    return goal


def picture_message(picture: np.ndarray, stamp_ns: int, frame_id: str) -> Image:
    """Image of a picture, (h, w, 3) uint8 RGB."""
    height, width, channels = picture.shape
    message = Image(height=height, width=width, encoding="rgb8", step=width * channels, data=picture.tobytes())
    message.header.stamp, message.header.frame_id = to_time(stamp_ns), frame_id
    return message


def form_message(message: Any) -> Any:
    """The ROS message of a `Message` of arm/real.py, whose fields are plain values."""
    made = message_class(message.kind)()
    for name, value in message.fields.items():
        if name == "header":
            made.header.stamp = to_time(value)
        elif name == "frame_id":
            made.header.frame_id = value
        elif name == "twist":
            made.twist = _twist(value)
        elif name == "points":
            made.points = [_trajectory_point(**point) for point in value]
        else:
            setattr(made, name, value)
    return made


def _trajectory_point(time_from_start_s, **values):
    from trajectory_msgs.msg import JointTrajectoryPoint  # here: only a real arm's driver may take trajectories
    return JointTrajectoryPoint(time_from_start=rospy.Duration.from_sec(time_from_start_s), **values)


def state_message(record: ServoRecord, frame_id: str) -> ServoState:
    """ServoState of a ServoRecord."""
    message = ServoState()
    message.header.stamp = to_time(record.stamp_ns)
    message.header.frame_id = frame_id
    message.status, message.converged = int(record.status), bool(record.converged)
    for name in ("status_text", "phase", "feature_names", "joint_names"):
        setattr(message, name, getattr(record, name))
    for name in ("s", "s_star", "e", "q", "q_dot", "set_point"):
        setattr(message, name, _plain(getattr(record, name)))
    for name in ("manipulability", "cond_l", "tilt_rad", "position_m", "rotation_rad"):
        setattr(message, name, float(getattr(record, name)))
    message.twist = _twist(_plain(record.twist))
    return message


def _twist(values):
    return Twist(Vector3(*values[:3]), Vector3(*values[3:]))


def _plain(array):
    return array.tolist() if isinstance(array, np.ndarray) else [float(value) for value in array]
