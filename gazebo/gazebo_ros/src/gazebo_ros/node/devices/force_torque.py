"""Force-torque sensors of joints: geometry_msgs/WrenchStamped."""
from geometry_msgs.msg import Vector3, WrenchStamped

from ...world.devices import ForceTorque
from ..convert import stamp
from .outlet import Noise, Outlet, serves


@serves(ForceTorque)
class ForceTorqueOutlet(Outlet):
    """What the child link exerts on its parent, in the axes of the child, about its origin: that of the joint."""

    def open(self):
        self._noise = Noise(self.device.topic, self.device.noise)
        self._messages = self.advertise(self.device.topic, WrenchStamped)

    def wanted(self):
        return self._messages.get_num_connections() > 0

    def send(self, now_ns):
        values = self._noise(self.simulation.joint_wrench(self.device.joint), now_ns)
        message = WrenchStamped()
        message.header.stamp = stamp(now_ns)
        message.header.frame_id = self.model.description.children[self.device.joint]
        message.wrench.force = Vector3(*map(float, values[:3]))
        message.wrench.torque = Vector3(*map(float, values[3:]))
        self._messages.publish(message)
