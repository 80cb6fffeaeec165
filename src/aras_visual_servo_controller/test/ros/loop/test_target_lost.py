#!/usr/bin/env python3
"""A target that is moved out of view: status TARGET_LOST, the arm comes to rest, the goal ends by its time limit."""
import sys
import unittest

import numpy as np
import rospy
from geometry_msgs.msg import Pose

from aras_visual_servo_msgs.msg import ServoState
from aras_visual_servo_msgs.srv import SetTargetPose
from wiring import Watcher, call, wait_until

# The arm has come to rest when no joint moves faster than this [m/s, rad/s]: 1 % of the speeds seen while servoing.
REST = 2e-3
REST_NS = 1_500_000_000  # simulated time given to the arm to come to rest


class TargetLost(unittest.TestCase):
    def test_arm_stops_when_the_target_is_moved_out_of_view(self):
        rospy.init_node("test_target_lost")
        watcher = Watcher()
        watcher.wait_connected()
        goal = watcher.send_goal("experiment", time_limit_s=4.0)
        wait_until(lambda: watcher.sim.lockstep_armed, "the lockstep to be armed")
        call("sim/unpause")
        watcher.wait_phase("servo")
        away = Pose()
        away.position.x, away.position.y, away.position.z, away.orientation.w = 5.0, 5.0, 0.19, 1.0
        self.assertTrue(call("sim/set_target_pose", SetTargetPose, "", away).success)
        lost = wait_until(lambda: next((state for state in list(watcher.states.values())
                                        if state.status == ServoState.TARGET_LOST), None), "status TARGET_LOST")
        self.assertEqual(max(map(abs, lost.q_dot)), 0.0)
        result = watcher.wait_result(goal).result
        self.assertEqual((result.converged, result.status), (False, ServoState.TIMED_OUT))
        rest_ns = lost.header.stamp.to_nsec() + REST_NS
        last = wait_until(lambda: max((stamp for stamp in list(watcher.joints) if stamp > rest_ns), default=None),
                          "joint states of an arm at rest")
        self.assertLess(np.abs(watcher.joints[last].velocity).max(), REST)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "target_lost", TargetLost, sys.argv)
