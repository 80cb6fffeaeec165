"""libgazebo_ros_joint_state_publisher.so: positions and velocities of the joints that it names."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

from ..devices import Device, named, number, reads, text

if typing.TYPE_CHECKING:
    from ..model import Model


@dataclasses.dataclass(frozen=True)
class JointStatePublisher(Device):
    """Sends joint_states without a controller manager."""
    names: tuple
    topic: str
    rate_hz: float

    def joints(self) -> typing.Tuple[str, ...]:
        return self.names

    def measured(self, model: "Model") -> typing.Tuple[typing.List[str], typing.List[float], typing.List[float]]:
        """Returns positions [m or rad] and velocities of the joints, in the order of the tag."""
        simulation = model.simulation
        places = [simulation.joint_names.index(name) for name in self.names if name in simulation.joint_names]
        return ([simulation.joint_names[k] for k in places], [float(simulation.joint_positions[k]) for k in places],
                [float(simulation.joint_velocities[k]) for k in places])


@reads("libgazebo_ros_joint_state_publisher.so")
def joint_state_publisher(plugin: ElementTree.Element, _sensor: typing.Optional[ElementTree.Element], _link: str,
                          namespace: str) -> JointStatePublisher:
    """Reads the tag. A rate of 0 is every step."""
    names = tuple(filter(None, (name.strip() for name in text(plugin, "jointName").split(","))))
    return JointStatePublisher(names, named(namespace, "joint_states"), number(plugin, "updateRate", 100.0))
