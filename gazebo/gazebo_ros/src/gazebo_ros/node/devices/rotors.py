"""The motors of RotorS and the odometry of its robots."""
import typing

import rospy
from nav_msgs.msg import Odometry
from std_msgs.msg import Float32

from ...world.plugins.rotors import RotorMotor, RotorsOdometry
from ...world.poses import rotated
from ..convert import pose_message, stamped, twist_message
from .outlet import DeviceOutlet, serves


def actuators_message() -> typing.Optional[type]:
    """Returns the class mav_msgs/Actuators, None: the package is not there."""
    try:
        from mav_msgs.msg import Actuators
    except ImportError:
        return None
    return Actuators


@serves(RotorMotor)
class RotorMotorOutlet(DeviceOutlet):
    def open(self) -> None:
        self._wanted_rad_s = self._speed_rad_s = 0.0
        self._speeds = self.advertise(self.device.speed_topic, Float32)
        kind = actuators_message()
        if kind is None:
            rospy.logwarn("motor of joint '%s': found no package mav_msgs, so it takes no commands" %
                          self.device.joint)
            return
        for topic in self.device.topics:
            self.listen(topic, kind, self._command)

    def _command(self, message: typing.Any) -> None:
        if self.device.number < len(message.angular_velocities):
            self._wanted_rad_s = float(message.angular_velocities[self.device.number])

    def wanted(self) -> bool:
        return True

    def time_reset(self, now_ns: int) -> None:
        self._wanted_rad_s = self._speed_rad_s = 0.0
        super().time_reset(now_ns)

    def send(self, now_ns: int) -> None:
        device = self.device
        self._speed_rad_s = device.speed(self._speed_rad_s, self._wanted_rad_s, 1.0 / self.rate_hz)
        self.model.thrust(device.link, device.wrench(self.model, self._speed_rad_s))
        self.model.turn_wheels(device, (device.turn * self._speed_rad_s / device.slowdown,))
        self._speeds.publish(Float32(self._speed_rad_s))


@serves(RotorsOdometry)
class RotorsOdometryOutlet(DeviceOutlet):
    def open(self) -> None:
        self._messages = self.advertise(self.device.topic, Odometry)

    def send(self, now_ns: int) -> None:
        pose = self.model.link_pose(self.device.link)
        message = stamped(Odometry, now_ns, self.device.frame, child_frame_id=self.device.child_frame)
        message.pose.pose = pose_message(pose)
        message.twist.twist = twist_message(rotated(pose.T, self.model.link_twist(self.device.link)))
        self._messages.publish(message)
