#!/usr/bin/env python3
"""Images alone: camera_node publishes nothing and says which topic it misses."""

import sys
import time
import unittest

import rospy
import rostest
from aras_visual_servo_msgs.msg import MomentFeatures
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import Image

LIMIT_S = 15.0


class WithoutCameraInfoTest(unittest.TestCase):
    def test_reason_is_logged_and_nothing_published(self):
        features, reasons = [], []
        subscribers = [
            rospy.Subscriber("camera/features", MomentFeatures, features.append),
            rospy.Subscriber("/rosout", Log, lambda m: reasons.append(m.msg) if "no intrinsics" in m.msg else None),
        ]
        publisher = rospy.Publisher("camera/image_raw", Image, queue_size=10)
        image = Image(height=8, width=8, step=8, encoding="mono8", data=bytes(64))
        end = time.monotonic() + LIMIT_S
        while not reasons and time.monotonic() < end:
            image.header.stamp = rospy.Time.now()
            publisher.publish(image)
            time.sleep(0.05)
        self.assertTrue(reasons, "camera_node never said what it misses")
        self.assertIn("camera/camera_info", reasons[0])
        self.assertEqual(features, [])
        self.assertEqual(len(subscribers), 2)


if __name__ == "__main__":
    rospy.init_node("test_without_camera_info")
    rostest.rosrun("aras_visual_servo_camera", "without_camera_info", WithoutCameraInfoTest, sys.argv)
