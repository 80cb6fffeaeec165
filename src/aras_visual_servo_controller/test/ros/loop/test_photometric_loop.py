#!/usr/bin/env python3
"""The photometric scenario over ROS in lockstep: it converges, and it is the in-process run, bit by bit."""
import sys

import rospy
from test_closed_loop import ClosedLoop

from aras_visual_servo_controller.bags.replay import NOT_COMPARED, same
from aras_visual_servo_msgs.msg import PhotometricFeatures


class PhotometricLoop(ClosedLoop):
    SCENARIO = "six_dof_photometric"
    DURATION_LIMIT_S = 15.0  # from 80 mm and 20 deg at 2 /s to rest at 0.5 mm/s: ln(2 * 80 / 0.5) / 2 = 2.9 s, damped

    @classmethod
    def listen_more(cls):
        cls.photometric = {}
        cls.subscriber = rospy.Subscriber("camera/photometric", PhotometricFeatures, cls.keep, tcp_nodelay=True)

    @classmethod
    def keep(cls, message):
        cls.photometric[message.header.stamp.to_nsec()] = message

    def compare_more(self, loop, stamp_ns):
        message = self.photometric[stamp_ns]
        for name in message.__slots__:
            if name not in NOT_COMPARED:
                self.assertTrue(same(getattr(message, name), getattr(loop.servo_extractor.features, name)),
                                f"{name} at {stamp_ns * 1e-9:.3f} s")


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "photometric_loop", PhotometricLoop, sys.argv)
