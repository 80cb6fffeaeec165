"""Inertial measurement units: sensor_msgs/Imu."""
import rospy
from sensor_msgs.msg import Imu as ImuMessage
from std_srvs.srv import Empty, EmptyResponse

from ...world.devices import Imu
from ...world.poses import quaternion_of
from ..convert import stamp
from .outlet import Noise, Outlet, serves


@serves(Imu)
class ImuOutlet(Outlet):
    """The specific force has gravity in it: a sensor at rest measures 9.81 m/s^2 upwards."""

    def open(self):
        self._noise = Noise(self.device.topic, self.device.noise)
        self._messages = self.advertise(self.device.topic, ImuMessage)
        if self.device.service:
            self.ends_with(rospy.Service(self.device.service, Empty, lambda _: EmptyResponse()).shutdown)

    def wanted(self):
        return self._messages.get_num_connections() > 0

    def send(self, now_ns):
        pose = self.model.link_pose(self.device.link)
        gravity = self.model.gravity_m_s2
        force = self.simulation.link_acceleration(self.device.link)[:3] - pose[:3, :3].T @ gravity
        turning = self.simulation.link_twist(self.device.link)[3:]
        noisy = self._noise((*turning, *force), now_ns)
        message = ImuMessage()
        message.header.stamp, message.header.frame_id = stamp(now_ns), self.device.frame
        for part, values in ((message.orientation, quaternion_of(pose)),
                             (message.angular_velocity, noisy[:3]), (message.linear_acceleration, noisy[3:])):
            for axis, value in zip("xyzw", values):
                setattr(part, axis, float(value))
        variance = self.device.noise ** 2
        for covariance in ("orientation", "angular_velocity", "linear_acceleration"):
            setattr(message, covariance + "_covariance", [variance, 0, 0, 0, variance, 0, 0, 0, variance])
        self._messages.publish(message)
