"""Messages of the world's values and back."""
import typing

import numpy
import rospy
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3
from std_msgs.msg import Header

from ..world.poses import matrix_of, quaternion_of


def stamp(time_ns: int) -> rospy.Time:
    return rospy.Time(time_ns // 1000000000, time_ns % 1000000000)


def stamped(kind: typing.Any, time_ns: int, frame: str = "", **fields: typing.Any) -> typing.Any:
    """A message of this class with a header."""
    return kind(header=Header(stamp=stamp(time_ns), frame_id=frame), **fields)


def pose_message(pose: numpy.ndarray) -> Pose:
    return Pose(Point(*map(float, pose[:3, 3])), Quaternion(*map(float, quaternion_of(pose))))


def twist_message(twist: typing.Sequence[float]) -> Twist:
    return Twist(Vector3(*map(float, twist[:3])), Vector3(*map(float, twist[3:])))


def pose_of(message: typing.Any, what: str) -> numpy.ndarray:
    """X (4, 4). Raises: BadValueError."""
    p, q = message.position, message.orientation
    return matrix_of((p.x, p.y, p.z), (q.x, q.y, q.z, q.w), what)


def twist_of(message: typing.Any) -> typing.Tuple[float, float, float, float, float, float]:
    """(6,) [v; w]."""
    return (message.linear.x, message.linear.y, message.linear.z,
            message.angular.x, message.angular.y, message.angular.z)
