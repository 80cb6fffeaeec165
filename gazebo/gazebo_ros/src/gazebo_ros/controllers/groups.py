"""Controllers of several joints with one list of commands."""
from std_msgs.msg import Float64MultiArray

from .adapter import Adapter, register


@register("effort_controllers/JointGroupEffortController", "effort_controllers/JointGroupPositionController",
          "position_controllers/JointGroupPositionController", "velocity_controllers/JointGroupVelocityController")
class Group(Adapter):
    def open(self):
        self.listen(self.topic("command"), Float64MultiArray, self._command)

    def _command(self, message):
        if self.running:
            self.simulation.set_group_command(self.name, list(message.data))
