"""Controllers of one joint: the topic command, and state and gains of those with a PID."""
import dynamic_reconfigure.server
import rospy
from aras_visual_servo_sim.cfg import PidConfig
from control_msgs.msg import JointControllerState
from std_msgs.msg import Float64

from aras_visual_servo_sim import ArasError

from ..node.beat import NEVER_NS, Beat
from ..node.convert import stamp
from .adapter import Adapter, register

STATE_RATE_HZ = 100.0  #: ros_control sends every tenth of its steps of 1 ms
GAINS = ("p", "i", "d", "i_clamp", "antiwindup")


@register("effort_controllers/JointEffortController", "position_controllers/JointPositionController",
          "velocity_controllers/JointVelocityController")
class Single(Adapter):
    def open(self):
        self.listen(self.topic("command"), Float64, self._command)

    def _command(self, message):
        if self.running:
            self.simulation.set_controller_command(self.name, message.data)


@register("effort_controllers/JointPositionController", "effort_controllers/JointVelocityController")
class SinglePid(Single):
    def open(self):
        super().open()
        self._states = self.advertise(self.topic("state"), JointControllerState)
        self._beat = None
        self._gains = None
        server = dynamic_reconfigure.server.Server(PidConfig, self._reconfigured, self.topic("pid"))
        self.ends_with(server.set_service.shutdown)
        self.ends_with(server.descr_topic.unregister)
        self.ends_with(server.update_topic.unregister)

    def _reconfigured(self, config, _level):
        """In rospy's thread. The first call has what is in the parameters: nothing is to be changed then."""
        gains = {key: config[key] for key in GAINS}
        first, self._gains = self._gains is None, gains
        if not first:
            self.work.post(self._set_gains)
        return config

    def _set_gains(self):
        if not self.running:
            return
        try:
            self.simulation.set_gains(self.name, **self._gains)
        except ArasError as error:
            rospy.logerr("%s: %s" % (self.place, error))

    @property
    def next_ns(self):
        return self._beat.next_ns if self.running and self._states.get_num_connections() else NEVER_NS

    def started(self, now_ns):
        super().started(now_ns)
        self._beat = Beat(STATE_RATE_HZ, now_ns)

    def publish(self, now_ns):
        if not self.running or not self._beat.due(now_ns) or not self._states.get_num_connections():
            return
        state = self.simulation.controller_state(self.name)
        message = JointControllerState(time_step=1e-9 * self.world.period_ns,
                                       **state)
        message.header.stamp = stamp(now_ns)
        self._states.publish(message)
