"""Controllers with the topic command, of one joint or several; state and gains of those with a PID."""
import typing

import dynamic_reconfigure.server
from aras_visual_servo_sim.cfg import PidConfig
from control_msgs.msg import JointControllerState
from std_msgs.msg import Float64, Float64MultiArray

from ..node.convert import stamped
from .adapter import Adapter, register

GAINS = ("p", "i", "d", "i_clamp", "antiwindup")


@register("effort_controllers/JointEffortController", "position_controllers/JointPositionController",
          "velocity_controllers/JointVelocityController")
class Single(Adapter):
    kind = Float64

    def open(self) -> None:
        self.listen(self.topic("command"), self.kind, self._command)

    def _command(self, message: typing.Any) -> None:
        if self.running:
            self.command(message.data)

    def command(self, value: typing.Any) -> None:
        self.simulation.set_controller_command(self.name, value)


@register("effort_controllers/JointGroupEffortController", "effort_controllers/JointGroupPositionController",
          "position_controllers/JointGroupPositionController", "velocity_controllers/JointGroupVelocityController")
class Group(Single):
    """Several joints with one list of commands."""

    kind = Float64MultiArray

    def command(self, value: typing.Any) -> None:
        self.simulation.set_group_command(self.name, list(value))


@register("effort_controllers/JointPositionController", "effort_controllers/JointVelocityController",
          "velocity_controllers/JointPositionController")
class SinglePid(Single):
    rate_hz = 100.0  # ros_control sends every tenth of its steps of 1 ms

    def open(self) -> None:
        super().open()
        self._states = self.advertise(self.topic("state"), JointControllerState)
        self._gains = None
        server = dynamic_reconfigure.server.Server(PidConfig, self._reconfigured, self.topic("pid"))
        for end in (server.set_service.shutdown, server.descr_topic.unregister, server.update_topic.unregister):
            self.ends_with(end)

    def _reconfigured(self, config: typing.Any, _level: int) -> typing.Any:
        """Called in rospy's thread. The first call has the initial parameters and changes nothing."""
        gains = {key: config[key] for key in GAINS}
        first, self._gains = self._gains is None, gains
        if not first:
            self.work.post(self._set_gains, self.place)
        return config

    def _set_gains(self) -> None:
        if self.running:
            self.simulation.set_gains(self.name, **self._gains)

    def send(self, now_ns: int) -> None:
        state = self.simulation.controller_state(self.name)
        self._states.publish(stamped(JointControllerState, now_ns, time_step=1e-9 * self.world.period_ns, **state))
