"""libgazebo_ros_planar_move.so: a model that slides over the ground with a commanded twist."""
import dataclasses
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..devices import Device, named, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model


@dataclasses.dataclass(frozen=True)
class PlanarMove(Device):
    """A base that takes the velocity it is told, as if it had no wheels."""
    command_topic: str
    odometry_topic: str
    odometry_frame: str
    base_frame: str
    odometry_rate_hz: float
    rate_hz: float = 500.0    #: of new velocities: Gazebo sets them at every step, friction slows the base in between

    def move(self, model: "Model", forward_m_s: float, left_m_s: float, turn_rad_s: float) -> None:
        """Gives the base this twist in its own axes; that along z, and about x and y, stays what it is. Raises:
        ArasError: the model is fixed and has joints."""
        pose, twist = model.pose(), model.twist()
        yaw = math.atan2(pose[1, 0], pose[0, 0])
        twist[:2] = (math.cos(yaw) * forward_m_s - math.sin(yaw) * left_m_s,
                     math.sin(yaw) * forward_m_s + math.cos(yaw) * left_m_s)
        twist[3:] = numpy.array((0.0, 0.0, turn_rad_s))
        model.place(pose, twist)


@reads("libgazebo_ros_planar_move.so")
def planar_move(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                namespace: str) -> PlanarMove:
    """Reads the tag."""
    return PlanarMove(named(namespace, text(plugin, "commandTopic", "cmd_vel")),
                      named(namespace, text(plugin, "odometryTopic", "odom")), text(plugin, "odometryFrame", "odom"),
                      text(plugin, "robotBaseFrame", "base_footprint"),
                      number(plugin, "odometryRate", 20.0))
