"""Grippers: the action gripper_cmd."""
import actionlib
import rospy
from control_msgs.msg import GripperCommandAction, GripperCommandFeedback, GripperCommandResult

from aras_visual_servo_sim import ArasError

from ..node.beat import NEVER_NS, Beat
from .adapter import Adapter, register


@register("effort_controllers/GripperActionController", "position_controllers/GripperActionController")
class Gripper(Adapter):
    def open(self):
        self._rate_hz = self.simulation.gripper_report(self.name)["monitor_rate_hz"]
        self._goal = self._beat = None
        self._open_action()
        self.ends_with(lambda: self._server.stop())

    def _open_action(self):
        self._server = actionlib.ActionServer(self.topic("gripper_cmd"), GripperCommandAction,
                                              lambda goal: self.work.post(lambda: self._accept(goal)),
                                              lambda goal: self.work.post(lambda: self._cancel(goal)), auto_start=False)
        self._server.start()

    def _accept(self, handle):
        command = handle.get_goal().command
        try:
            if not self.running:
                raise ArasError("Can't accept new action goals. Controller is not running.")
            self.simulation.pursue_grip(self.name, command.position, command.max_effort)
        except ArasError as error:
            rospy.logerr("%s: %s" % (self.place, error))
            handle.set_rejected(GripperCommandResult(), str(error))
            return
        if self._goal is not None:
            self._goal.set_canceled()
        handle.set_accepted()
        self._goal = handle
        self._beat = Beat(self._rate_hz, self.world.time_ns)

    def _cancel(self, handle):
        if self._goal is not None and handle == self._goal:
            if self.running:
                self.simulation.cancel_goal(self.name)
            goal, self._goal = self._goal, None
            goal.set_canceled()

    @property
    def next_ns(self):
        return self._beat.next_ns if self.running and self._goal is not None else NEVER_NS

    def stopped(self):
        super().stopped()
        self._end()

    def time_reset(self, now_ns):
        """See TrajectoryFollower."""
        if self._goal is not None:
            self._goal.set_canceled()
            self._goal = None
        self._server.stop()
        self._open_action()
        super().time_reset(now_ns)

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
