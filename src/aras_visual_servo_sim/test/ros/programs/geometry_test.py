#!/usr/bin/env python3
"""Depth, segmentation and triggered frames on the wire."""
import time
import unittest

import numpy as np
import rospy
import rostest
from sensor_msgs.msg import CompressedImage, Image
from std_msgs.msg import Empty

WAIT_S = 30.0  # for a message, on a busy machine
HEIGHT, WIDTH = 48, 64


def until(condition, what):
    """Waits until condition() is true."""
    end = time.monotonic() + WAIT_S
    while not condition():
        if time.monotonic() > end:
            raise AssertionError("never happened: " + what)
        time.sleep(0.01)


class Geometry(unittest.TestCase):
    def test_depth_and_ids_of_one_frame_agree(self):
        depth = rospy.wait_for_message("camera/depth/image_raw", Image, WAIT_S)
        ids = rospy.wait_for_message("camera/segmentation/image_raw", Image, WAIT_S)
        self.assertEqual((depth.height, depth.width, depth.encoding, depth.step), (HEIGHT, WIDTH, "32FC1", 4 * WIDTH))
        self.assertEqual((ids.height, ids.width, ids.encoding, ids.step), (HEIGHT, WIDTH, "16UC1", 2 * WIDTH))
        self.assertEqual(depth.header.frame_id, "eye_optical_frame")
        metres = np.frombuffer(depth.data, np.float32).reshape(HEIGHT, WIDTH)
        numbers = np.frombuffer(ids.data, np.uint16).reshape(HEIGHT, WIDTH)
        target = rospy.get_param("sim/segmentation_ids")["target"]
        self.assertEqual(numbers[HEIGHT // 2, WIDTH // 2], target)
        np.testing.assert_array_equal(np.isnan(metres), numbers == 0)  # the arm rests: any two frames agree

    def test_depth_carries_the_stamp_of_an_image(self):
        images = {}
        subscriber = rospy.Subscriber("camera/image_raw", Image, lambda image: images.update({image.header.stamp: 1}))
        depths = {}
        other = rospy.Subscriber("camera/depth/image_raw", Image, lambda image: depths.update({image.header.stamp: 1}))
        until(lambda: len(images.keys() & depths.keys()) >= 3, "three depths with the stamp of an image")
        subscriber.unregister()
        other.unregister()

    def test_sixteen_bits_have_the_digital_numbers(self):
        image = rospy.wait_for_message("deep/image_raw", Image, WAIT_S)
        self.assertEqual((image.height, image.width, image.encoding, image.step), (6, 8, "mono16", 16))
        self.assertFalse(image.is_bigendian)
        values = np.frombuffer(image.data, "<u2")
        self.assertEqual(values.size, 48)
        self.assertEqual(values[0], round(230 / 255 * 4095) << 4)  # twelve bits, in the upper part of sixteen
        self.assertFalse(np.any(values & 15))
        self.assertLess(values.min(), values[0] // 2)  # the target
        file = rospy.wait_for_message("deep/image_raw/compressed", CompressedImage, WAIT_S)
        self.assertEqual(file.format, "mono16; jpeg compressed mono8")

    def test_triggered_camera_sends_one_image_for_each_request(self):
        images = []
        rospy.Subscriber("still/image_raw", Image, images.append)
        trigger = rospy.Publisher("still/image_trigger", Empty, queue_size=1)
        until(lambda: trigger.get_num_connections() > 0, "a subscriber of the trigger")
        rospy.sleep(0.3)
        self.assertEqual(images, [])
        for count in (1, 2):
            trigger.publish(Empty())
            until(lambda: len(images) >= count, "the image asked for")
            rospy.sleep(0.3)  # of simulated time: nine periods of the camera
            self.assertEqual(len(images), count)


if __name__ == "__main__":
    rospy.init_node("geometry_test")
    rostest.rosrun("aras_visual_servo_sim", "geometry", Geometry)
