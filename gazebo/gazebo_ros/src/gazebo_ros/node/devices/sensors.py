"""Sensors that publish one topic: inertial measurement units, force-torque sensors of joints, lasers."""
import typing

import numpy
from geometry_msgs.msg import Vector3, WrenchStamped
from sensor_msgs.msg import Imu as ImuMessage
from sensor_msgs.msg import LaserScan
from std_srvs.srv import Empty, EmptyResponse

from ...world.devices import ForceTorque, Imu, Laser, directions_of, resampled
from ...world.model import Model
from ...world.poses import quaternion_of
from ...world.world import World
from ..convert import stamped
from .outlet import DeviceOutlet, Noise, serves


class SensorOutlet(DeviceOutlet):
    """Publishes measured(now_ns), a message of the class `kind`, while it has subscribers."""

    kind: typing.Any = None  #: class of the message

    def open(self) -> None:
        self._noise = Noise(self.device.topic, self.device.noise)
        self._messages = self.advertise(self.device.topic, self.kind)

    def measured(self, now_ns: int) -> typing.Any:
        """Returns the message of a time."""
        raise NotImplementedError

    def send(self, now_ns: int) -> None:
        self._messages.publish(self.measured(now_ns))


@serves(ForceTorque)
class ForceTorqueOutlet(SensorOutlet):
    """Returns the wrench of the child on its parent, in the child's axes, about the joint's origin."""

    kind = WrenchStamped

    def measured(self, now_ns: int) -> WrenchStamped:
        values = self._noise(self.simulation.joint_wrench(self.device.joint), now_ns)
        message = stamped(WrenchStamped, now_ns, self.model.description.children[self.device.joint])
        message.wrench.force = Vector3(*map(float, values[:3]))
        message.wrench.torque = Vector3(*map(float, values[3:]))
        return message


@serves(Imu)
class ImuOutlet(SensorOutlet):
    """The specific force has gravity in it: a sensor at rest measures 9.81 m/s^2 upwards."""

    kind = ImuMessage

    def open(self) -> None:
        super().open()
        if self.device.service:
            self.serve(self.device.service, Empty, lambda _: EmptyResponse())

    def measured(self, now_ns: int) -> ImuMessage:
        pose = self.model.link_pose(self.device.link)
        force = self.simulation.link_acceleration(self.device.link)[:3] - pose[:3, :3].T @ self.model.gravity_m_s2
        turning = self.simulation.link_twist(self.device.link)[3:]
        noisy = self._noise((*turning, *force), now_ns)
        message = stamped(ImuMessage, now_ns, self.device.frame)
        for part, values in ((message.orientation, quaternion_of(pose)),
                             (message.angular_velocity, noisy[:3]), (message.linear_acceleration, noisy[3:])):
            for axis, value in zip("xyzw", values):
                setattr(part, axis, float(value))
        variance = self.device.noise ** 2
        for covariance in ("orientation", "angular_velocity", "linear_acceleration"):
            setattr(message, covariance + "_covariance", [variance, 0, 0, 0, variance, 0, 0, 0, variance])
        return message


class RaysOutlet(SensorOutlet):
    """Of sensors that look along rays."""

    def open(self) -> None:
        super().open()
        self.directions = directions_of(self.device.horizontal, self.device.vertical)

    def scan(self) -> typing.Tuple[numpy.ndarray, numpy.ndarray]:
        """Returns the current measurement, without noise."""
        return scan(self.world, self.model, self.device, self.directions)


@serves(Laser)
class LaserOutlet(RaysOutlet):
    """Distances from where the sensor is at the stamp; infinite where nothing is within the range."""

    kind = LaserScan

    def measured(self, now_ns: int) -> LaserScan:
        device, turns = self.device, self.device.horizontal
        ranges, retros = self.scan()
        noisy = self._noise(ranges + device.noise_mean, now_ns)
        seen = numpy.isfinite(ranges)
        ranges[seen] = numpy.clip(noisy[seen], device.range_min_m, device.range_max_m)
        return stamped(LaserScan, now_ns, device.frame, angle_min=turns.lowest, angle_max=turns.highest,
                       angle_increment=(turns.highest - turns.lowest) / max(1, turns.count - 1),
                       range_min=device.range_min_m, range_max=device.range_max_m, ranges=ranges.tolist(),
                       intensities=retros.tolist())


def scan(world: World, model: Model, device: Laser,
         directions: numpy.ndarray) -> typing.Tuple[numpy.ndarray, numpy.ndarray]:
    """Returns the current scan, without noise: ranges, infinite without a hit, and intensities."""
    ranges, retros = world.cast_rays(model.link_pose(device.link) @ device.X_LS, directions, device.range_min_m,
                                     device.range_max_m, device.sees_visuals)
    ranges = resampled(numpy.minimum(ranges, device.range_max_m), device.horizontal, device.vertical)
    ranges[ranges >= device.range_max_m] = numpy.inf
    return ranges, resampled(retros, device.horizontal, device.vertical)
