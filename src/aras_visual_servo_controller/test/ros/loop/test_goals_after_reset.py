#!/usr/bin/env python3
"""Goals of a client that stamps them, as actionlib's clients do, before and after sim/reset sets time back."""
import sys
import unittest

import actionlib
import rospy
from actionlib_msgs.msg import GoalID, GoalStatus
from std_srvs.srv import Trigger

from aras_visual_servo_msgs.msg import VisualServoAction, VisualServoGoal
from wiring import LIMIT_S, Watcher, call, wait_until


class GoalsAfterReset(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_goals_after_reset")
        cls.watcher = Watcher()
        cls.watcher.wait_connected()
        cls.client = actionlib.SimpleActionClient("servo", VisualServoAction)
        assert cls.client.wait_for_server(rospy.Duration(LIMIT_S))

    def begin(self):
        """Give a goal, and wait until it is worked on."""
        self.client.send_goal(VisualServoGoal(reference="experiment"))
        wait_until(lambda: self.client.get_state() == GoalStatus.ACTIVE, "the goal to be taken")

    def reset(self):
        call("sim/pause")
        call("sim/reset")
        wait_until(lambda: rospy.get_time() < 1.0, "time to go back")

    def run_until(self, t_s):
        call("sim/unpause")
        wait_until(lambda: rospy.get_time() > t_s, f"{t_s} s")

    def setUp(self):
        self.reset()
        self.run_until(2.0)

    def test_the_result_of_a_goal_that_is_stopped_names_who_stopped_it(self):
        self.begin()
        rospy.ServiceProxy("stop", Trigger)()
        wait_until(lambda: self.client.get_state() == GoalStatus.ABORTED, "the goal to end")
        result = wait_until(self.client.get_result, "the result")
        self.assertEqual(result.reason, f"stopped by {rospy.get_name()}")

    def test_a_goal_is_taken_after_each_of_ten_resets(self):
        for _ in range(10):
            self.begin()
            self.reset()
            self.run_until(0.3)

    def test_a_goal_is_taken_after_a_reset_that_followed_its_end(self):
        self.begin()
        self.client.cancel_goal()
        wait_until(lambda: self.client.get_state() == GoalStatus.PREEMPTED, "the goal to end")
        self.reset()
        self.begin()

    def test_a_goal_that_is_given_between_a_reset_and_the_first_image_goes_on(self):
        self.begin()
        self.run_until(4.0)
        self.client.cancel_goal()
        wait_until(lambda: self.client.get_state() == GoalStatus.PREEMPTED, "the goal to end")
        self.reset()
        self.begin()
        self.run_until(0.5)
        self.assertEqual(self.client.get_state(), GoalStatus.ACTIVE)

    def test_a_goal_is_taken_after_a_reset_in_its_middle(self):
        self.begin()
        self.reset()
        self.begin()

    def test_a_goal_is_taken_after_a_reset_that_followed_a_cancel_of_all_that_is_older(self):
        self.begin()
        self.watcher.cancels.publish(GoalID(stamp=rospy.get_rostime()))
        wait_until(lambda: self.client.get_state() == GoalStatus.PREEMPTED, "the goal to end")
        self.reset()
        self.begin()


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "goals_after_reset", GoalsAfterReset, sys.argv)
