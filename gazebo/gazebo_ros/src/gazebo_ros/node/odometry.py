"""Where wheels have carried a base."""
import math
import typing

import numpy
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from nav_msgs.msg import Odometry

from ..world.poses import matrix_of
from .convert import pose_message, stamped


class WheelOdometry:
    """Adds up the turns of two wheels, or of two sides.

    Attributes:
        separation_m, left_radius_m, right_radius_m.
        x_m, y_m, yaw_rad: where the base is, from where it began.
    """

    def __init__(self, separation_m: float, left_radius_m: float, right_radius_m: float) -> None:
        self.separation_m, self.left_radius_m, self.right_radius_m = separation_m, left_radius_m, right_radius_m
        self._turned = None
        self.x_m = self.y_m = self.yaw_rad = 0.0

    def update(self, left_rad: float, right_rad: float) -> None:
        """Takes the angles that the wheels have turned by since any time."""
        before, self._turned = self._turned or (left_rad, right_rad), (left_rad, right_rad)
        left = self.left_radius_m * (left_rad - before[0])
        right = self.right_radius_m * (right_rad - before[1])
        turn = (right - left) / self.separation_m
        middle = self.yaw_rad + 0.5 * turn
        self.x_m += 0.5 * (left + right) * math.cos(middle)
        self.y_m += 0.5 * (left + right) * math.sin(middle)
        self.yaw_rad += turn

    def pose(self) -> numpy.ndarray:
        """(4, 4)."""
        half = 0.5 * self.yaw_rad
        return matrix_of((self.x_m, self.y_m, 0.0), (0.0, 0.0, math.sin(half), math.cos(half)), "odometry")

    def velocity(self, left_rad_s: float, right_rad_s: float) -> typing.Tuple[float, float, float]:
        """Forward [m/s], sideways [m/s] and turn [rad/s] of the base."""
        left, right = self.left_radius_m * left_rad_s, self.right_radius_m * right_rad_s
        return 0.5 * (left + right), 0.0, (right - left) / self.separation_m


def odometry_message(now_ns: int, frame: str, base_frame: str, pose: numpy.ndarray, velocity: typing.Sequence[float],
                     pose_variances: typing.Sequence[float],
                     twist_variances: typing.Sequence[float] = (0.0,) * 6) -> Odometry:
    """nav_msgs/Odometry of a pose (4, 4) and of forward, sideways and turn; variances x, y, z, roll, pitch, yaw."""
    message = stamped(Odometry, now_ns, frame, child_frame_id=base_frame)
    message.pose.pose = pose_message(pose)
    for k in range(6):
        message.pose.covariance[7 * k], message.twist.covariance[7 * k] = pose_variances[k], twist_variances[k]
    message.twist.twist.linear = Vector3(float(velocity[0]), float(velocity[1]), 0.0)
    message.twist.twist.angular.z = float(velocity[2])
    return message


def transform_message(header: typing.Any, child: str, pose: typing.Any) -> TransformStamped:
    """geometry_msgs/TransformStamped of a geometry_msgs/Pose."""
    place = Vector3(pose.position.x, pose.position.y, pose.position.z)
    return TransformStamped(header, child, Transform(place, pose.orientation))
