"""Grippers: the action gripper_cmd."""
import typing

import rospy
from control_msgs.msg import GripperCommandAction, GripperCommandFeedback, GripperCommandResult

from aras_visual_servo_sim import ArasError

from .actions import NOT_RUNNING, ActionAdapter
from .adapter import register

#: End of a goal -> status of the action.
ENDS = {"reached": "succeeded", "stalled": "aborted"}


@register("effort_controllers/GripperActionController", "position_controllers/GripperActionController")
class Gripper(ActionAdapter):
    def open(self) -> None:
        self.rate_hz = self.simulation.gripper_report(self.name)["monitor_rate_hz"]
        self.serve("gripper_cmd", GripperCommandAction)

    def accept(self, handle: typing.Any) -> None:
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
        self.begin(self.world.time_ns)

    def wanted(self) -> bool:
        return self.running and self._goal is not None

    def stopped(self) -> None:
        super().stopped()
        self._end()

    def publish(self, now_ns: int) -> None:
        self._end()
        super().publish(now_ns)

    def send(self, now_ns: int) -> None:
        self._goal.publish_feedback(self._told(GripperCommandFeedback))

    def _told(self, kind: typing.Any) -> typing.Any:
        report = self.simulation.gripper_report(self.name)
        return kind(position=report["position"], effort=report["effort"], stalled=report["goal"] == "stalled",
                    reached_goal=report["goal"] == "reached")

    def _end(self) -> None:
        """Ends the goal when the controller has."""
        end = "active" if self._goal is None else self.simulation.gripper_report(self.name)["goal"]
        if end in ENDS:
            self.finish(ENDS[end], self._told(GripperCommandResult))
        elif end != "active":
            self.finish("canceled")
