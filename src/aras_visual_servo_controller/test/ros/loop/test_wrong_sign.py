#!/usr/bin/env python3
"""A loop closed with the wrong sign must not converge: what the closed-loop test asserts can fail."""
import sys
import unittest

import numpy as np
import rospy
from sensor_msgs.msg import JointState
from wiring import call, wait_until, Watcher


class WrongSign(unittest.TestCase):
    def test_a_loop_with_the_wrong_sign_does_not_converge(self):
        rospy.init_node("test_wrong_sign")
        publisher = rospy.Publisher("joint_command", JointState, queue_size=100, tcp_nodelay=True)
        watcher = Watcher()

        def relay(message):
            if watcher.state is not None and watcher.state.phase in ("settle_start", "servo") and not message.position:
                message.velocity = [-velocity for velocity in message.velocity]
            publisher.publish(message)
        rospy.Subscriber("wanted_command", JointState, relay, tcp_nodelay=True)
        wait_until(lambda: publisher.get_num_connections() > 0, "the simulator")
        watcher.wait_connected()
        goal = watcher.send_goal("experiment", time_limit_s=4.0)
        wait_until(lambda: watcher.sim.lockstep_armed, "the lockstep to be armed")
        call("sim/unpause")
        result = watcher.wait_result(goal).result
        self.assertFalse(result.converged, result.reason)
        servo = [state for _, state in sorted(watcher.states.items()) if state.phase == "servo"
                 and np.isfinite(state.e).all()]
        self.assertGreater(len(servo), 3)
        self.assertGreater(np.linalg.norm(servo[-1].e), np.linalg.norm(servo[0].e))


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "wrong_sign", WrongSign, sys.argv)
