"""Bases that follow a twist besides those on two wheels: four wheels, a base that slides, a body that flies."""
import math
import typing

import numpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from ...world.plugins.planar_move import PlanarMove
from ...world.plugins.rotors import VelocityFlight
from ...world.plugins.skid_steer import SkidSteer
from ..odometry import odometry_message, transform_message
from ..outlet import Beat
from .outlet import DeviceOutlet, serves

FAR = 1e12  #: variance of quantities unknown to odometry


class CommandedOutlet(DeviceOutlet):
    """Follows the last geometry_msgs/Twist on a topic.

    Attributes: told: linear (3,) [m/s] and angular (3,) [rad/s], None: nothing was told yet.
    """

    told = None

    def follow(self, topic: str) -> None:
        """Listens to the commands."""
        self.listen(topic, Twist, self._command)

    def _command(self, message: typing.Any) -> None:
        parts = [[getattr(part, axis) for axis in "xyz"] for part in (message.linear, message.angular)]
        self.told = numpy.asarray(parts) if all(map(math.isfinite, sum(parts, []))) else numpy.zeros((2, 3))

    def wanted(self) -> bool:
        return True

    def time_reset(self, now_ns: int) -> None:
        self.told = None
        super().time_reset(now_ns)


class BaseOutlet(CommandedOutlet):
    """A base on the ground, which tells its odometry."""

    def open(self) -> None:
        self.follow(self.device.command_topic)
        self._odometry = self.advertise(self.device.odometry_topic, Odometry)
        self._transforms = self.advertise("/tf", TFMessage)

    def send_odometry(self, now_ns: int, variances: typing.Sequence[float], transforms: bool) -> None:
        """Sends the true pose, and the twist in the heading of the base."""
        device, pose, twist = self.device, self.model.pose(), self.model.twist()
        yaw = math.atan2(pose[1, 0], pose[0, 0])
        velocity = (math.cos(yaw) * twist[0] + math.sin(yaw) * twist[1],
                    math.cos(yaw) * twist[1] - math.sin(yaw) * twist[0], twist[5])
        message = odometry_message(now_ns, device.odometry_frame, device.base_frame, pose, velocity, variances,
                                   variances)
        self._odometry.publish(message)
        if transforms:
            self._transforms.publish([transform_message(message.header, device.base_frame, message.pose.pose)])


@serves(SkidSteer)
class SkidSteerOutlet(BaseOutlet):
    def send(self, now_ns: int) -> None:
        x, y, yaw = self.device.variances
        self.send_odometry(now_ns, (x, y, FAR, FAR, FAR, yaw), self.device.publishes_tf)
        if self.told is not None:
            self.model.turn_wheels(self.device, self.device.speeds(self.told[0, 0], self.told[1, 2]))


@serves(PlanarMove)
class PlanarMoveOutlet(BaseOutlet):
    def begin(self, now_ns: int) -> None:
        super().begin(now_ns)
        self._told_of = Beat(self.device.odometry_rate_hz or self.rate_hz, now_ns)

    def send(self, now_ns: int) -> None:
        if self.told is not None:
            self.device.move(self.model, self.told[0, 0], self.told[0, 1], self.told[1, 2])
        if self._told_of.due(now_ns):
            self.send_odometry(now_ns, (0.001, 0.001, FAR, FAR, FAR, 0.001), True)


@serves(VelocityFlight)
class VelocityFlightOutlet(CommandedOutlet):
    """Flies from the first command on; before it the body lies where it is."""

    def open(self) -> None:
        self.follow(self.device.topic)

    def send(self, now_ns: int) -> None:
        if self.told is not None:
            self.device.fly(self.model, self.told[0], self.told[1, 2], 1.0 / self.rate_hz)
