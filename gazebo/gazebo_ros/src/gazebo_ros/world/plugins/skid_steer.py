"""libgazebo_ros_skid_steer_drive.so: four wheels, those of a side turn as one."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

from ..devices import Device, flag, named, number, reads, text


@dataclasses.dataclass(frozen=True)
class SkidSteer(Device):
    """A base on two wheels a side. Lengths in m, torque in N m."""
    wheels: tuple             #: joints: left front, right front, left rear, right rear
    separation_m: float
    diameter_m: float
    torque_n_m: float
    rate_hz: float
    command_topic: str
    odometry_topic: str
    odometry_frame: str
    base_frame: str
    publishes_tf: bool
    variances: tuple          #: of x, y and yaw

    def joints(self) -> typing.Tuple[str, ...]:
        return self.wheels

    def motors(self) -> typing.Tuple[str, ...]:
        return self.wheels

    def speeds(self, forward_m_s: float, turn_rad_s: float) -> typing.Tuple[float, float, float, float]:
        """Returns the speeds of the wheels for a twist of the base [rad/s], in the order of `wheels`."""
        left, right = (2.0 * (forward_m_s + side * 0.5 * turn_rad_s * self.separation_m) / self.diameter_m
                       for side in (-1.0, 1.0))
        return left, right, left, right


@reads("libgazebo_ros_skid_steer_drive.so")
def skid_steer(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
               namespace: str) -> SkidSteer:
    """Reads the tag."""
    wheels = tuple(text(plugin, key + "Joint", default + "_joint") for key, default in (
        ("leftFront", "left_front"), ("rightFront", "right_front"), ("leftRear", "left_rear"),
        ("rightRear", "right_rear")))
    diameter = number(plugin, "wheelDiameter", 0.15)
    if not diameter > 0.0:
        raise ValueError("<wheelDiameter>: found %g, allowed is > 0 m" % diameter)
    return SkidSteer(
        wheels, number(plugin, "wheelSeparation", 0.4), diameter, number(plugin, "torque", 5.0),
        number(plugin, "updateRate", 100.0), named(namespace, text(plugin, "commandTopic", "cmd_vel")),
        named(namespace, text(plugin, "odometryTopic", "odom")), text(plugin, "odometryFrame", "odom"),
        text(plugin, "robotBaseFrame", "base_footprint"), flag(plugin, "broadcastTF"),
        tuple(number(plugin, "covariance_" + key, default) for key, default in
              (("x", 0.0001), ("y", 0.0001), ("yaw", 0.01))))
