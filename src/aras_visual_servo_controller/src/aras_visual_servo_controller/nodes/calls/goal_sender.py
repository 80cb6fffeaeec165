"""Sends a goal until the action server has taken it."""

from typing import Any, Callable, Dict

#: Wall time until a goal that was not taken is sent again [s].
AGAIN_S = 2.0


class GoalSender:
    """Publishes a goal again and again until the action server has taken it.

    A goal that is published once can be lost, because rospy connects a subscriber slightly before it hands messages to
    it. Sending the goal again does no harm, since an action server takes each goal id once.

    Args:
        publish: called with the goal message.
    Attributes:
        goal_id: of the goal that was sent last, "" before.  taken: whether it was taken.
    """

    def __init__(self, publish: Callable[[Any], None]):
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
        """Note what the action server said. Args: statuses: dict of goal id -> whether it is still pending."""
        self.taken = self.taken or not statuses.get(self.goal_id, True)
