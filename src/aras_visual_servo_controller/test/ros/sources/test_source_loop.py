#!/usr/bin/env python3
"""A scenario on another source than moments, over ROS in lockstep: it converges, and is the run in process bit by bit.

    test_source_loop.py SCENARIO
"""
import importlib
import sys

import rospy
from test_closed_loop import ClosedLoop

from aras_visual_servo import FeatureSet, load_scenario, source_named
from aras_visual_servo_controller.bags.replay import NOT_COMPARED, same
from aras_visual_servo_msgs.msg import ServoState


class SourceLoop(ClosedLoop):
    SCENARIO = sys.argv[1]
    # The goal of keypoints is one image, whose noise stays in it.
    END = ServoState.SETTLED if SCENARIO == "six_dof_matches" else ServoState.CONVERGED
    # From 80 mm and 20 deg at 2 /s to rest at 0.5 mm/s: ln(2 * 80 / 0.5) / 2 = 2.9 s, slower where damped.
    DURATION_LIMIT_S = 15.0

    @classmethod
    def listen_more(cls):
        servo, cls.seen = load_scenario(cls.SCENARIO).servo, {}
        source = source_named(FeatureSet(tuple(servo["features"]), source=servo.get("source", "")).source)
        package, name = source.message.split("/")
        message = getattr(importlib.import_module(package + ".msg"), name)
        cls.subscriber = rospy.Subscriber(source.topic, message, cls.keep, tcp_nodelay=True)

    @classmethod
    def keep(cls, message):
        cls.seen[message.header.stamp.to_nsec()] = message

    def compare_more(self, loop, stamp_ns):
        message = self.seen[stamp_ns]
        for name in message.__slots__:
            if name not in NOT_COMPARED:
                self.assertTrue(same(getattr(message, name), getattr(loop.servo_extractor.features, name)),
                                f"{name} at {stamp_ns * 1e-9:.3f} s")


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "source_loop_" + sys.argv[1], SourceLoop, sys.argv)
