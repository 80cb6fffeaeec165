"""What publishes joint_states of the joints that have a transmission, sorted by name."""
from sensor_msgs.msg import JointState

from ..node.beat import NEVER_NS, Beat
from ..node.convert import stamp
from .adapter import Adapter, register


@register("joint_state_controller/JointStateController")
class JointStates(Adapter):
    def open(self):
        self._states = self.advertise((self.space + "/joint_states").replace("//", "/"), JointState)
        self._settings = self.simulation.joint_state_settings(self.name)
        names = self.simulation.joint_names
        self._places = [(k, name) for k, name in enumerate(names) if name in self.model.description.actuated]
        self._beat = None

    @property
    def next_ns(self):
        return self._beat.next_ns if self.running else NEVER_NS

    def started(self, now_ns):
        super().started(now_ns)
        self._beat = Beat(self._settings["publish_rate_hz"], now_ns)

    def publish(self, now_ns):
        if not self.running or not self._beat.due(now_ns):
            return
        message = JointState()
        message.header.stamp = stamp(now_ns)
        for name, vector in (("position", self.simulation.joint_positions),
                             ("velocity", self.simulation.joint_velocities),
                             ("effort", self.simulation.joint_efforts)):
            setattr(message, name, [float(vector[k]) for k, _ in self._places])
        message.name = [name for _, name in self._places]
        for name, position, velocity, effort in self._settings["extra_joints"]:
            message.name.append(name)
            message.position.append(position)
            message.velocity.append(velocity)
            message.effort.append(effort)
        self._states.publish(message)
