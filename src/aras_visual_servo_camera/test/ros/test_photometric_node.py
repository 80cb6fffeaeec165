#!/usr/bin/env python3
"""Wiring of camera_node with vision.photometric: topic, stamps, reference, blank images, another camera."""

import sys

import numpy as np
import rospy
import rostest
from aras_visual_servo_msgs.msg import PhotometricFeatures

from feature_node import FeatureNodeTest


def texture(width, height, shift_px=0.0):
    u, v = np.meshgrid(np.arange(width) - shift_px, np.arange(height))
    return np.rint(128 + 50 * np.sin(0.21 * u + 0.05 * v) + 50 * np.cos(0.17 * v)).astype(np.uint8)


class PhotometricNodeTest(FeatureNodeTest):
    TOPIC, MESSAGE, FOCAL_PX = "camera/photometric", PhotometricFeatures, 100.0

    def test_a_view_becomes_the_reference_and_another_one_differs_from_it(self):
        view = self.answer_to(texture(160, 120))
        self.assertTrue(view.valid and view.target_visible)
        self.assertEqual(view.header.frame_id, "camera_optical_frame")
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertTrue(answer.success, answer.message)  # whatever the moments make of a texture
        self.assertEqual(answer.stamp, view.header.stamp)
        same = self.answer_to(texture(160, 120))
        self.assertTrue(same.has_reference and same.valid)
        self.assertEqual((same.rms, same.z_star_m), (0.0, 0.5))
        self.assertEqual(same.reference_stamp_ns, view.header.stamp.to_nsec())
        moved = self.answer_to(texture(160, 120, 1.0))
        self.assertTrue(moved.valid and moved.rms > 1.0 and moved.level == 0)
        self.assertEqual((len(moved.H), len(moved.b), moved.interaction), (21, 6, "mean"))
        self.assertEqual(moved.reference_hash, same.reference_hash)
        self.assertNotEqual(moved.reference_hash, 0)

    def test_an_image_before_the_last_becomes_the_reference_by_its_stamp(self):
        views = [self.answer_to(texture(160, 120, shift)) for shift in (0.0, 1.0, 2.0)]
        answer = self.set_reference(z_star_m=0.5, stamp=views[1].header.stamp)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.stamp, views[1].header.stamp)
        self.assertEqual(self.answer_to(texture(160, 120, 1.0)).rms, 0.0)
        self.assertGreater(self.answer_to(texture(160, 120, 2.0)).rms, 1.0)

    def test_a_blank_image_is_refused_as_reference_with_the_reason(self):
        before = self.answer_to(texture(160, 120)).reference_stamp_ns
        blank = self.answer_to(np.full((120, 160), 90, np.uint8))
        self.assertFalse(blank.valid or blank.target_visible)
        self.assertIn("contrast", blank.fault)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("standard deviation", answer.message)
        self.assertEqual(self.answer_to(texture(160, 120)).reference_stamp_ns, before)

    def test_a_camera_that_sees_more_than_the_reference_says_so(self):
        self.answer_to(texture(160, 120))
        self.assertTrue(self.set_reference(z_star_m=0.5, from_current_view=True).success)
        wider = self.answer_to(texture(200, 120))
        self.assertFalse(wider.valid or wider.has_reference)
        self.assertIn("teach it again", wider.fault)
        self.assertEqual(self.answer_to(texture(160, 120)).rms, 0.0)

    def test_bad_depth_is_refused(self):
        self.answer_to(texture(160, 120))
        answer = self.set_reference(z_star_m=0.0, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("z_star_m", answer.message)


if __name__ == "__main__":
    rospy.init_node("test_photometric_node")
    rostest.rosrun("aras_visual_servo_camera", "photometric_node", PhotometricNodeTest, sys.argv)
