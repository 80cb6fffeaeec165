"""How nodes call one another: goals of the action `servo`, and services."""

import time
from typing import Any, Callable, Dict

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus

from aras_visual_servo import ParameterError

#: Wall time until a goal that was not taken is sent again [s].
AGAIN_S = 2.0
#: Wall time within which a clock that has gone back reaches every node [s].
CLOCK_S = 0.5
#: Wall time within which a service must be offered [s].
SERVICE_TIMEOUT_S = 5.0


class ActionServer(actionlib.SimpleActionServer):
    """An action server for time that goes back: after sim/reset, a restored state, or a bag that is played again.

    actionlib's SimpleActionServer refuses goals with an older stamp than the last one; this server takes such a goal
    if the last one has ended.

    Args: name: of the action.  specification: its message class.
    """

    def __init__(self, name: str, specification: Any) -> None:
        super().__init__(name, specification, auto_start=False)
        self._newest = rospy.Time()
        take = self.action_server.internal_goal_callback

        def look_and_take(goal):
            # Older than the cancelled goal: it is that goal, or the clock message after a reset is still on its way.
            until_s = time.monotonic() + CLOCK_S
            while (rospy.Time() < goal.goal_id.stamp <= self.action_server.last_cancel
                   and rospy.get_rostime() >= self._newest and time.monotonic() < until_s):
                time.sleep(0.005)
            self.look_at_time()
            take(goal)

        self.action_server.internal_goal_callback = look_and_take

    def look_at_time(self) -> None:
        """Forget the stamps of earlier goals when time has gone back. To be called regularly."""
        now = rospy.get_rostime()
        with self.action_server.lock, self.lock:
            if now < self._newest:
                self.action_server.last_cancel = rospy.Time()  # it cancels goals of older stamps
                self._forget_stamps()
                for entry in self.action_server.status_list:
                    entry.handle_destruction_time = min(entry.handle_destruction_time, now)
            self._newest = now

    def internal_goal_callback(self, goal: Any) -> None:
        """Called by actionlib with a new goal."""
        with self.lock:
            if not self.is_active() and not self.is_new_goal_available():
                self._forget_stamps()
        super().internal_goal_callback(goal)
        if goal.get_goal_status().status in (GoalStatus.RECALLED, GoalStatus.REJECTED):
            rospy.logwarn("goal %s not taken: its stamp, %.3f s, is before that of the goal that is being worked on",
                          goal.get_goal_id().id, goal.get_goal_id().stamp.to_sec())

    def _forget_stamps(self):
        for handle in (self.current_goal, self.next_goal):
            if handle.get_goal():
                handle.get_goal_id().stamp = rospy.Time()


class GoalSender:
    """Publishes a goal again and again until the action server has taken it.

    A goal that is published once can be lost, because rospy connects a subscriber slightly before it hands messages to
    it. Sending the goal again does no harm, since an action server takes each goal id once.

    Args: publish: called with the goal message.
    Attributes: goal_id: of the goal that was sent last, "" before.  taken: whether it was taken.
    """

    def __init__(self, publish: Callable[[Any], None]) -> None:
        self._publish = publish
        self._goal, self._sent_s = None, 0.0
        self.goal_id, self.taken = "", False

    def send(self, goal: Any, now_s: float) -> None:
        """Send a VisualServoActionGoal at wall time now_s."""
        self._goal, self.goal_id, self.taken = goal, goal.goal_id.id, False
        self._sent_s = now_s
        self._publish(goal)

    def look(self, now_s: float) -> None:
        """Send the goal once more if it has not been taken for AGAIN_S. To be called regularly."""
        if self._goal is not None and not self.taken and now_s - self._sent_s >= AGAIN_S:
            self.send(self._goal, now_s)

    def heard(self, statuses: Dict[str, bool]) -> None:
        """Notes the statuses of the action server. Args: statuses: dict of goal id -> whether it is still pending."""
        self.taken = self.taken or not statuses.get(self.goal_id, True)


def call_service(name: str, kind: Any, *arguments: Any) -> Any:
    """Answer of the service `name`, a class `kind`, to a request of these fields.

    Raises:
        ParameterError: it answers `success: false`; with its message.
        rospy.ROSException: no node offers it within SERVICE_TIMEOUT_S.  rospy.ServiceException: it fails.
    """
    rospy.wait_for_service(name, SERVICE_TIMEOUT_S)
    answer = rospy.ServiceProxy(name, kind)(*arguments)
    if getattr(answer, "success", True) is False:
        raise ParameterError(f"{name}: {getattr(answer, 'message', '') or getattr(answer, 'status_message', '')}")
    return answer
