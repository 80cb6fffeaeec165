"""libgazebo_ros_link_attacher.so: holds links of two models to each other when a service asks for it."""
import dataclasses
import xml.etree.ElementTree as ElementTree

from ..devices import Device, reads_of_world


@dataclasses.dataclass(frozen=True)
class LinkAttacher(Device):
    """The services attach and detach of a world."""
    namespace: str = "/link_attacher_node"
    rate_hz: float = 1.0


@reads_of_world("libgazebo_ros_link_attacher.so")
def link_attacher(_plugin: ElementTree.Element) -> LinkAttacher:
    """Reads the tag, which has no keys."""
    return LinkAttacher()
