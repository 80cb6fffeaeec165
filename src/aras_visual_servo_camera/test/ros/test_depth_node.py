#!/usr/bin/env python3
"""Wiring of camera_node with vision.depth: pairs by stamp, what it does without depth, with another size, in order."""

import sys

import numpy as np
import rospy
import rostest
from aras_visual_servo_camera import MomentExtractor
from aras_visual_servo_msgs.msg import MomentFeatures
from sensor_msgs.msg import Image

from feature_node import FeatureNodeTest
from test_camera_node import wait_until

SIZE = (160, 120)


def with_spot(u, v):
    """Grey image with a dark square of 21 px about (u, v)."""
    image = np.full(SIZE[::-1], 230, np.uint8)
    image[v - 10:v + 11, u - 10:u + 11] = 20
    return image


class DepthNodeTest(FeatureNodeTest):
    TOPIC, MESSAGE = "camera/features", MomentFeatures

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.depths = rospy.Publisher("camera/depth/image_raw", Image, queue_size=200)
        assert wait_until(cls.depths.get_num_connections)

    def give_depth(self, pixels, stamp, encoding="32FC1"):
        depth = Image(height=pixels.shape[0], width=pixels.shape[1], encoding=encoding, data=pixels.tobytes())
        depth.step, depth.header.stamp = pixels.strides[0], rospy.Time(stamp)
        self.depths.publish(depth)

    def test_a_depth_image_of_the_same_stamp_gives_points_their_depths_bit_for_bit_as_in_process(self):
        depth = np.full(SIZE[::-1], 0.7, np.float32) + np.arange(SIZE[0], dtype=np.float32) * 0.001
        millimetres = np.full(SIZE[::-1], 800, np.uint16)
        for pixels, encoding, near in ((depth, "32FC1", 0.76), (millimetres, "16UC1", 0.8)):
            self.give_depth(depth + 1.0, self.clock)  # of another stamp
            self.give_depth(pixels, self.clock + 1, encoding)
            seen = self.answer_to(with_spot(60, 50))
            self.assertEqual(seen.depth_fault, "")
            self.assertAlmostEqual(seen.point_z[0], near, delta=1e-5)
        info = self.info_of(*SIZE)
        alone = MomentExtractor({"width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
                                 "distortion_model": info.distortion_model}, rospy.get_param("depth/vision"))
        self.assertEqual(list(seen.point_z), alone.process(with_spot(60, 50), depth=millimetres).point_z)

    def test_without_a_usable_depth_image_features_come_and_say_why(self):
        # The last: after an image that waited in vain, later ones do not wait until depth images come again.
        for pixels, encoding, words in ((np.ones((60, 160), np.float32), "32FC1", "is 160 x 60, allowed 160 x 120"),
                                        (np.ones((120, 160), np.uint8), "mono8", "no depth image came with the image"),
                                        (None, "", "no depth image came with the image")):
            if pixels is not None:
                self.give_depth(pixels, self.clock + 1, encoding)
            seen = self.answer_to(with_spot(80, 60))
            self.assertTrue(seen.valid)
            self.assertIn(words, seen.depth_fault)
            self.assertEqual(seen.point_z, ())

    def test_a_hole_is_not_a_number(self):
        self.give_depth(np.zeros(SIZE[::-1], np.float32), self.clock + 1)
        seen = self.answer_to(with_spot(80, 60))
        self.assertTrue(np.isnan(seen.point_z).all() and len(seen.point_z) == 1 and seen.depth_fault == "")


if __name__ == "__main__":
    rospy.init_node("test_depth_node")
    rostest.rosrun("aras_visual_servo_camera", "depth_node", DepthNodeTest, sys.argv)
