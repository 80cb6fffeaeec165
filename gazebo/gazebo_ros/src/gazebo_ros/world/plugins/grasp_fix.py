"""libgazebo_grasp_fix.so: holds an object that the fingers of a hand press from two sides, so that it does not slip.

The keys, defaults and rules are those of gazebo_grasp_plugin (gazebo-pkgs of Jennifer Buehler). One object is held at a
time, by the palm."""
import dataclasses
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ArasError

from ..devices import Device, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model
    from ..world import World

Forces = typing.Dict[str, typing.Dict[str, numpy.ndarray]]  #: on each link, by each finger [N]
SMALLEST_RATIO = 0.3  #: of two forces that count as opposed, the smaller to the larger


@dataclasses.dataclass(frozen=True)
class GraspFix(Device):
    """A hand: its palm, and the links whose contacts count."""
    palm: str
    fingers: tuple
    angle_rad: float          #: forces with a larger angle between them are opposed
    rate_hz: float            #: of the looks at the contacts
    threshold: int            #: with more looks with a grip than this the object is held
    most: int                 #: looks that are counted
    release_m: float          #: a finger that moves away by this lets go

    def links(self) -> typing.Tuple[str, ...]:
        return (self.palm, *self.fingers)


class Grasp:
    """The simulated plugin. Attributes: held: dict of scoped link -> dict of finger -> its place in the object."""

    def __init__(self, device: GraspFix, world: "World", model: "Model") -> None:
        self._device, self._world, self._model = device, world, model
        self._counts, self.held = {}, {}

    def update(self) -> None:
        """Looks at the contacts once: counts, holds and lets go."""
        forces, device = self._forces(), self._device
        pressed = {link for link, fingers in forces.items() if self.is_gripped(fingers.values())}
        for link in pressed | set(self._counts):
            count = self._counts.get(link, 0) + (1 if link in pressed else -1)
            self._counts[link] = min(max(count, 0), device.most)
        for link in pressed:
            if self._counts[link] > device.threshold and not self.held:
                self._hold(link, forces[link])
        for link in set(self.held) - pressed:
            if self._counts.get(link, 0) <= device.threshold and self._opened(link):
                self.release(link)

    def release(self, link: str) -> None:
        """Lets an object go."""
        self.held.pop(link)
        self._counts.pop(link, None)
        self._world.detach(self._palm, link)

    @property
    def _palm(self) -> str:
        return "%s::%s" % (self._model.name, self._device.palm)

    def _forces(self) -> Forces:
        """dict of scoped link of another model -> dict of finger -> force on that link (3,) [N]."""
        found = {}
        for finger in self._device.fingers:
            for touch in self._world.touches(self._model.name, finger):
                model = touch.other.partition("::")[0]
                if model in self._world.models and not self._world.models[model].description.fixed and \
                        model != self._model.name:
                    sums = found.setdefault(touch.other, {})
                    sums[finger] = sums.get(finger, 0.0) - touch.force
        return found

    def is_gripped(self, forces: typing.Iterable[numpy.ndarray]) -> bool:
        """Whether two of these forces (3,) on an object press against each other."""
        forces = [force for force in forces if numpy.linalg.norm(force) > 0.0]
        for k, one in enumerate(forces):
            for other in forces[k + 1:]:
                sizes = numpy.linalg.norm(one), numpy.linalg.norm(other)
                angle = math.acos(float(numpy.clip(one @ other / (sizes[0] * sizes[1]), -1.0, 1.0)))
                if angle > self._device.angle_rad and min(sizes) > SMALLEST_RATIO * max(sizes):
                    return True
        return False

    def _hold(self, link: str, fingers: typing.Iterable[str]) -> None:
        try:
            self._world.attach(self._palm, link)
        except ArasError:
            return  # it is held already
        self.held[link] = {finger: self._place(link, finger) for finger in fingers}

    def _place(self, link: str, finger: str) -> numpy.ndarray:
        model, name = self._world.scoped(link)
        return (numpy.linalg.inv(model.link_pose(name)) @ self._model.link_pose(finger))[:3, 3]

    def _opened(self, link: str) -> bool:
        """Whether a finger that held the object has moved away from where it was."""
        return any(numpy.linalg.norm(self._place(link, finger) - place) > self._device.release_m
                   for finger, place in self.held[link].items())


@reads("libgazebo_grasp_fix.so", "libgazebo_ros_grasp_fix.so")
def grasp_fix(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
              _namespace: str) -> GraspFix:
    """Reads the tag, also of the older releases without <arm>; of several arms the first counts."""
    arm = plugin if plugin.find("arm") is None else plugin.find("arm")
    most = int(number(plugin, "max_grip_count", 10))
    rate_hz = number(plugin, "update_rate", 5.0)
    if not rate_hz > 0.0:
        raise ValueError("<update_rate>: found %g, allowed is > 0 Hz" % rate_hz)
    return GraspFix(text(arm, "palm_link").rpartition("::")[2],
                    tuple((each.text or "").strip().rpartition("::")[2] for each in arm.findall("gripper_link")),
                    math.radians(number(plugin, "forces_angle_tolerance", 120.0)), rate_hz,
                    int(number(plugin, "grip_count_threshold", most // 2)), most,
                    number(plugin, "release_tolerance", 0.005))
