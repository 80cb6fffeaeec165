"""An action server for time that goes back: after sim/reset, a restored state, or a bag that is played again."""

from typing import Any

import actionlib
import rospy
from actionlib_msgs.msg import GoalStatus


class ActionServer(actionlib.SimpleActionServer):
    """actionlib's SimpleActionServer refuses goals with an older stamp than the last one; this server takes such a goal
    if the last one has ended.

    Args:
        name: of the action.  specification: its message class.
    """

    def __init__(self, name: str, specification: Any):
        super().__init__(name, specification, auto_start=False)
        self._newest = rospy.Time()
        take = self.action_server.internal_goal_callback

        def look_and_take(goal):
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
