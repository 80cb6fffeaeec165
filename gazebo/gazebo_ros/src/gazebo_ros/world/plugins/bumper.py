"""libgazebo_ros_bumper.so: contacts of a link with their forces."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

from ..devices import Device, named, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model
    from ..world import Touch, World

GROUND = "ground_plane::link::collision"  #: Gazebo's name of the ground


@dataclasses.dataclass(frozen=True)
class Bumper(Device):
    """A contact sensor of a link."""
    link: str
    topic: str
    frame: str
    rate_hz: float

    def links(self) -> typing.Tuple[str, ...]:
        return (self.link,)

    def touched(self, world: "World", model: "Model") -> typing.Dict[str, typing.List["Touch"]]:
        """Returns dict of the scoped name of a touched link -> list of Touch."""
        found = {}
        for touch in world.touches(model.name, self.link):
            found.setdefault(touch.other, []).append(touch)
        return found


def collision_of(scoped: str) -> str:
    """Returns how Gazebo calls the collision of MODEL::LINK."""
    return GROUND if scoped == "ground_plane" else "%s::%s_collision" % (scoped, scoped.rpartition("::")[2])


@reads("libgazebo_ros_bumper.so")
def bumper(plugin: ElementTree.Element, sensor: typing.Optional[ElementTree.Element], link: str,
           namespace: str) -> Bumper:
    """Reads the tag, which stands in a sensor of type contact."""
    rate_hz = number(plugin, "updateRate", number(sensor, "update_rate", 0.0) if sensor is not None else 0.0)
    return Bumper(link, named(namespace, text(plugin, "bumperTopicName", "bumper_states")),
                  text(plugin, "frameName", "world"), rate_hz)
