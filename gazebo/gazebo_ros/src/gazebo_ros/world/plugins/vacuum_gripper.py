"""libgazebo_ros_vacuum_gripper.so: while it is on, holds links that come near to its link.

As in gazebo_ros_vacuum_gripper.cpp, a link of another model is near when its origin is within maxDistance of the
gripper's. Gazebo pulls it with a force and gives it the gripper's velocity at each step; here the two links become one
body until the gripper is off."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError

from ..devices import Device, named, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model
    from ..world import World


@dataclasses.dataclass(frozen=True)
class VacuumGripper(Device):
    """A gripper that sucks."""
    link: str
    topic: str                #: tells whether it holds anything
    services: tuple           #: full names of on and off
    max_distance_m: float
    rate_hz: float = 100.0

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)


class Suction:
    """A vacuum gripper. Attributes: on: whether it holds.  held: scoped names of the links that it holds."""

    def __init__(self, device: VacuumGripper, world: "World", model: "Model") -> None:
        self.on, self.held = False, []
        self._device, self._world, self._model = device, world, model

    def switch(self, on: bool) -> None:
        """Begins to suck, or lets everything go."""
        self.on = on
        if not on:
            for link in self.held:
                self._world.detach("%s::%s" % (self._model.name, self._device.link), link)
            self.held = []

    def update(self) -> bool:
        """Attaches the links that are near now. Returns whether it holds any."""
        own = "%s::%s" % (self._model.name, self._device.link)
        self.held = [link for link in self.held if self._world.is_attached(own, link)]
        if self.on:
            place = self._model.link_pose(self._device.link)[:3, 3]
            for model in list(self._world.models.values()):
                if model is self._model or model.description.fixed:
                    continue
                for link in model.links:
                    scoped = "%s::%s" % (model.name, link)
                    distance = numpy.linalg.norm(model.link_pose(link)[:3, 3] - place)
                    if scoped not in self.held and distance <= self._device.max_distance_m:
                        self._hold(own, scoped)
        return bool(self.held)

    def _hold(self, own: str, link: str) -> None:
        try:
            self._world.attach(own, link)
        except ArasError:
            return  # another gripper holds it to this link
        self.held.append(link)


@reads("libgazebo_ros_vacuum_gripper.so")
def vacuum_gripper(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                   namespace: str) -> VacuumGripper:
    """Reads the tag. maxForce and minDistance of the pull have no effect."""
    return VacuumGripper(text(plugin, "bodyName"), named(namespace, text(plugin, "topicName", "grasping")),
                         (named(namespace, "on"), named(namespace, "off")), number(plugin, "maxDistance", 0.05))
