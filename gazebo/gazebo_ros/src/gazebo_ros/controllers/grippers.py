"""Grippers: the action gripper_cmd."""
import rospy
from control_msgs.msg import GripperCommandAction, GripperCommandFeedback, GripperCommandResult

from aras_visual_servo_sim import ArasError

from ..node.beat import NEVER_NS, Beat
from .actions import NOT_RUNNING, ActionAdapter
from .adapter import register


@register("effort_controllers/GripperActionController", "position_controllers/GripperActionController")
class Gripper(ActionAdapter):
    def open(self):
        self._rate_hz = self.simulation.gripper_report(self.name)["monitor_rate_hz"]
        self._beat = None
        self.serve("gripper_cmd", GripperCommandAction)

    def accept(self, handle):
        command = handle.get_goal().command
        try:
            if not self.running:
                raise ArasError(NOT_RUNNING)
            self.simulation.pursue_grip(self.name, command.position, command.max_effort)
        except ArasError as error:
            rospy.logerr("%s: %s" % (self.place, error))
            handle.set_rejected(GripperCommandResult(), str(error))
            return
        self.take(handle)
        self._beat = Beat(self._rate_hz, self.world.time_ns)

    @property
    def next_ns(self):
        return self._beat.next_ns if self.running and self._goal is not None else NEVER_NS

    def stopped(self):
        super().stopped()
        self._end()

    def publish(self, now_ns):
        self._end()
        if self._goal is not None and self._beat.due(now_ns):
            self._goal.publish_feedback(self._told(GripperCommandFeedback))

    def _told(self, kind):
        report = self.simulation.gripper_report(self.name)
        return kind(position=report["position"], effort=report["effort"], stalled=report["goal"] == "stalled",
                    reached_goal=report["goal"] == "reached")

    def _end(self):
        """Ends the goal when the controller has."""
        if self._goal is None:
            return
        end = self.simulation.gripper_report(self.name)["goal"]
        if end == "active":
            return
        goal, self._goal = self._goal, None
        if end == "reached":
            goal.set_succeeded(self._told(GripperCommandResult))
        elif end == "stalled":
            goal.set_aborted(self._told(GripperCommandResult))
        else:
            goal.set_canceled()
