#!/usr/bin/env python3
"""`servo.launch sim:=false` on a rough arm: the experiment arrives within 1 mm, and what is missing stops the arm."""
import sys
import threading
import time
import unittest

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Bool, Float64MultiArray, String
from trajectory_msgs.msg import JointTrajectory

from aras_visual_servo.ground.types import Status
from aras_visual_servo_msgs.msg import InputTiming, ServoState
from wiring import Watcher, call, wait_until

DISTANCE_M = 0.001
PERIOD_S = 0.008
#: A period of the command loop, one of the clock that it goes by, and the way of the messages on a busy machine [s].
WITHIN_S = 3 * PERIOD_S + 0.05
LIMIT_S = 200.0  # wall time
COMMAND = {"trajectory": JointTrajectory, "velocity": Float64MultiArray}


class RealArm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_real_arm")
        cls.watcher, cls.poses, cls.timings, cls.commands, cls.held = Watcher(), {}, [], [], None
        cls.states = []  # all of them: two of one stamp, as when two inputs stop at once, are both heard
        cls.kind = rospy.get_param("/rough_plant/command")
        rospy.Subscriber("/plant/ground_truth/camera_pose", PoseStamped,
                         lambda m: cls.poses.__setitem__(m.header.stamp.to_nsec(), m.pose))
        rospy.Subscriber("servo_state", ServoState, cls.states.append)
        rospy.Subscriber("input_timing", InputTiming, cls.timings.append)
        rospy.Subscriber("/arm_controller/command", COMMAND[cls.kind],
                         lambda m: cls.commands.append((rospy.get_time(), cls.speed(m))))
        cls.deadman = rospy.Publisher("/deadman", Bool, queue_size=1)
        cls.fault = rospy.Publisher("/rough_plant/fault", String, queue_size=1, latch=True)
        threading.Thread(target=cls.hold, daemon=True).start()
        wait_until(lambda: len(cls.watcher.features) > 3 and cls.watcher.states, "images and answers", LIMIT_S)
        wait_until(lambda: cls.deadman.get_num_connections() and cls.fault.get_num_connections(), "the connections")

    @classmethod
    def hold(cls):
        """The dead-man's switch, ten times a second, in the state that `held` says; None: silent."""
        while not rospy.is_shutdown():
            if cls.held is not None:
                cls.deadman.publish(cls.held)
            time.sleep(0.1)

    @classmethod
    def speed(cls, message):
        """The largest speed that a command asks for."""
        values = message.points[0].velocities if cls.kind == "trajectory" else message.data
        return max(map(abs, values))

    def distance_m(self, stamp_a_ns, stamp_b_ns):
        """Between the true places of the camera at two times."""
        def place(stamp_ns):
            pose = self.poses[min(self.poses, key=lambda known: abs(known - stamp_ns))].position
            return np.array([pose.x, pose.y, pose.z])
        return float(np.linalg.norm(place(stamp_a_ns) - place(stamp_b_ns)))

    def tearDown(self):
        self.fault.publish("")

    def begin(self):
        """A goal, and the arm in motion. A goal that is refused because a machine stalls is sent again."""
        type(self).held = True
        wait_until(lambda: self.deadman.get_num_connections() > 0, "the controller")
        for _ in range(20):
            time.sleep(0.5)
            goal = self.watcher.send_goal("experiment")
            wait_until(lambda: self.watcher.result or self.commands and self.commands[-1][1] > 0.02, "motion", LIMIT_S)
            if not self.watcher.result or "the arm must rest" not in self.watcher.result.result.reason:
                break
        self.assertIsNone(self.watcher.result)
        return goal

    def said(self, text):
        """Whether a state of the controller said that it rests for want of this."""
        return any(state.status == Status.STALE_INPUT and text in state.status_text
                   for state in list(self.states))

    def at_rest_after(self, since_s, within_s):
        wait_until(lambda: rospy.get_time() > since_s + within_s + 0.3, "time", LIMIT_S)
        late = [(at_s - since_s, speed) for at_s, speed in self.commands if at_s > since_s + within_s and speed > 0.0]
        self.assertEqual(late, [])

    def test_1_the_experiment_arrives_within_a_millimetre(self):
        goal = self.begin()
        result = self.watcher.wait_result(goal, LIMIT_S).result
        self.assertTrue(result.converged, result.reason)
        ended_s = rospy.get_time()
        wait_until(lambda: rospy.get_time() > ended_s + 0.5, "time", LIMIT_S)
        taught_ns = min(stamp for stamp, state in dict(self.watcher.states).items() if state.phase == "teach")
        left_m = self.distance_m(taught_ns, max(self.poses))
        rospy.loginfo("left: %.4f mm", 1e3 * left_m)
        self.assertLess(left_m, DISTANCE_M)
        used = [timing for timing in self.timings if timing.used]
        self.assertGreater(used[-1].image_latency_max_s, 0.1)
        self.assertGreater(used[-1].image_latency_mean_s, 0.03)
        self.assertTrue(all(timing.extrapolation_s <= 0.01 for timing in used))
        if self.kind == "velocity":  # the test with prediction
            self.assertGreater(max(timing.predicted_s for timing in used), 0.1)

    def test_2_the_dead_mans_switch_stops_the_arm_and_ends_the_goal(self):
        goal = self.begin()
        type(self).held = False
        self.deadman.publish(False)
        since_s = rospy.get_time()
        self.at_rest_after(since_s, WITHIN_S)
        result = self.watcher.wait_result(goal, LIMIT_S).result
        self.assertEqual(result.status, Status.STOPPED)
        self.assertIn("dead-man", result.reason)
        refused = self.watcher.wait_result(self.watcher.send_goal("experiment"), LIMIT_S).result
        self.assertIn("the arm must rest", refused.reason)

    def test_3_a_silent_switch_stops_the_arm(self):
        goal = self.begin()
        type(self).held = None
        self.at_rest_after(rospy.get_time(), 1.0 + WITHIN_S + 0.1)
        self.assertIn("nothing on the topic `deadman`", self.watcher.wait_result(goal, LIMIT_S).result.reason)

    def test_4_joint_states_or_images_that_stop_stop_the_arm_until_they_come(self):
        faults = [("joints", 0.4, "no joint state"), ("images", 0.65, "no features")]
        if rospy.get_param("/rough_plant/axis"):
            faults.append(("axis", 0.4, "gantry for"))
        for fault, timeout_s, text in faults:
            goal = self.begin()
            self.states.clear()
            self.fault.publish(fault)
            since_s = rospy.get_time()
            self.at_rest_after(since_s, timeout_s + WITHIN_S + 0.1)
            wait_until(lambda: self.said(text), f"a state that says: {text}")
            self.assertIsNone(self.watcher.result)
            self.fault.publish("")
            wait_until(lambda: self.watcher.result or self.commands[-1][1] > 0.02, "motion again", LIMIT_S)
            self.assertIsNone(self.watcher.result)
            type(self).held = False
            self.watcher.wait_result(goal, LIMIT_S)

    def test_5_a_clock_that_jumps_ends_the_goal_and_the_next_one_works(self):
        goal = self.begin()
        call("/plant/sim/reset")
        reason = self.watcher.wait_result(goal, LIMIT_S).result.reason
        self.assertIn("the clock jumped by -", reason)
        wait_until(lambda: rospy.get_time() > 0.5, "time", LIMIT_S)
        goal = self.begin()
        type(self).held = False
        self.assertIn("dead-man", self.watcher.wait_result(goal, LIMIT_S).result.reason)


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "real_arm", RealArm, sys.argv)
