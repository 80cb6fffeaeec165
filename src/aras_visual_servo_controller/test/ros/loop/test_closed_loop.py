#!/usr/bin/env python3
"""The experiment over ROS in lockstep: it converges, and it is the in-process run, bit by bit."""
import sys
import unittest

import numpy as np
import rospy
from wiring import call, wait_until, Watcher

from aras_visual_servo import load_scenario, ServoLoop
from aras_visual_servo_msgs.msg import ServoState
from aras_visual_servo_msgs.srv import Step

CLOSING_S = 0.5  # after which the goal lets the simulator pause
FEATURES = ("area", "xg", "yg", "alpha", "xn", "yn", "an", "orientation_condition", "asymmetry")


class ClosedLoop(unittest.TestCase):
    """One run; each test looks at another side of it."""

    SCENARIO, OVERRIDES, END = "experiment_1", None, ServoState.CONVERGED
    # Simulated seconds of servoing: from 0.15 m at 3 /s to the stop threshold of 0.05 mm takes ln(3000) / 3 = 2.7 s.
    DURATION_LIMIT_S = 5.0

    @classmethod
    def setUpClass(cls):
        rospy.init_node("test_closed_loop")
        cls.listen_more()
        cls.watcher = Watcher()
        cls.watcher.wait_connected()
        goal = cls.watcher.send_goal("experiment", pause_after_s=CLOSING_S)
        wait_until(lambda: cls.watcher.sim.lockstep_armed, "the lockstep to be armed")
        call("sim/unpause")
        cls.result = cls.watcher.wait_result(goal, 120.0).result
        wait_until(lambda: cls.watcher.sim.paused, "the simulator to be paused")
        cls.sim = cls.watcher.sim
        wait_until(lambda: len(cls.watcher.features) == len(cls.watcher.states) == cls.sim.frames, "the last messages")

    @classmethod
    def listen_more(cls):
        """Subscribe to what `compare_more` needs."""

    def test_converges_in_bounded_simulated_time(self):
        self.assertEqual(self.result.status, self.END, self.result.reason)
        self.assertEqual(self.result.converged, self.END == ServoState.CONVERGED)
        self.assertLess(self.result.duration_s, self.DURATION_LIMIT_S)
        thresholds = load_scenario(self.SCENARIO, self.OVERRIDES).servo["thresholds"]
        for name, e in zip(self.result.feature_names, self.result.e):
            self.assertLess(abs(e), thresholds[name])

    def test_the_simulator_paused_itself_at_the_time_that_the_goal_gave(self):
        done = min(stamp for stamp, state in self.watcher.states.items() if state.phase == "done")
        self.assertEqual(self.sim.header.stamp.to_nsec() - done, round(CLOSING_S * 1e9))

    def test_every_image_is_answered_once_and_none_is_dropped(self):
        self.assertEqual(self.sim.dropped_frames, 0)
        self.assertEqual(self.sim.refused_commands, 0, self.sim.last_refusal)
        self.assertLessEqual(set(self.watcher.features), set(self.watcher.commands))

    def test_joint_states_carry_the_stamp_of_every_image(self):
        self.assertLessEqual(set(self.watcher.features), set(self.watcher.joints))

    def test_gives_the_bytes_of_the_in_process_run(self):
        loop = ServoLoop(load_scenario(self.SCENARIO, self.OVERRIDES))
        loop.start()
        for _ in range(self.sim.frames):
            record, features, _ = loop.step()
            message, state = self.watcher.features[record.stamp_ns], self.watcher.states[record.stamp_ns]
            for name in FEATURES:
                np.testing.assert_array_equal(getattr(message, name), getattr(features, name),
                                              f"{name} at {record.stamp_ns * 1e-9:.3f} s")
            self.compare_more(loop, record.stamp_ns)
            self.assertEqual((state.phase, state.status), (record.phase, record.status))
            np.testing.assert_array_equal(state.q, record.q)
            np.testing.assert_array_equal(state.e, record.e)
        loop.sim.step(self.sim.ticks - loop.sim.ticks)  # to where it was paused
        self.assertEqual(loop.sim.run_hash, self.sim.run_hash)

    def test_a_long_step_gives_the_features_of_every_image_on_the_way(self):
        images = 300  # more than may wait for the camera node
        call("sim/step", Step, images * 100 // 3)
        wait_until(lambda: self.watcher.sim.frames >= self.sim.frames + images, "the images")
        for name in ("features", "states", "commands"):
            kept = getattr(self.watcher, name)
            wait_until(lambda: len(kept) >= self.watcher.sim.frames, f"the {name} of each of them")

    def compare_more(self, loop, stamp_ns):
        """What else an image gave, against the loop that has just answered it."""


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "closed_loop", ClosedLoop, sys.argv)
