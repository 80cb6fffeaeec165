"""Publisher of joint_states of the joints with a transmission, sorted by name."""
from sensor_msgs.msg import JointState

from ..node.convert import stamped
from .adapter import Adapter, register


@register("joint_state_controller/JointStateController")
class JointStates(Adapter):
    def open(self) -> None:
        self._states = self.advertise((self.space + "/joint_states").replace("//", "/"), JointState)
        settings = self.simulation.joint_state_settings(self.name)
        self.rate_hz, self._extra = settings["publish_rate_hz"], settings["extra_joints"]
        names = self.simulation.joint_names
        self._places = [(k, name) for k, name in enumerate(names) if name in self.model.description.actuated]

    def wanted(self) -> bool:
        return self.running

    def send(self, now_ns: int) -> None:
        vectors = self.simulation.joint_positions, self.simulation.joint_velocities, self.simulation.joint_efforts
        rows = [(name, *(float(vector[k]) for vector in vectors)) for k, name in self._places]
        rows += self._extra
        names, positions, velocities, efforts = (list(column) for column in zip(*rows)) if rows else ([],) * 4
        self._states.publish(stamped(JointState, now_ns, name=names, position=positions, velocity=velocities,
                                     effort=efforts))
