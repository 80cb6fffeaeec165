#!/usr/bin/env python3
"""Wiring of camera_node with vision.matches: topic, stamps, goal image, boards without texture, another camera."""

import sys

import numpy as np
import rospy
import rostest
from aras_visual_servo_camera import MatchExtractor
from aras_visual_servo_msgs.msg import MatchFeatures

from feature_node import FeatureNodeTest

SIZE = (320, 240)


def board(width, height, shift_px=0):
    """Rectangles of many greys, moved to the right by whole pixels."""
    rng, image = np.random.default_rng(3), np.full((height, width + 40), 128, np.uint8)
    for _ in range(400):
        u, v, w, h = rng.integers(0, (width + 40, height, 30, 30))
        image[v:v + h, u:u + w] = rng.integers(0, 256)
    return np.ascontiguousarray(image[:, 20 - shift_px:20 - shift_px + width])


class MatchesNodeTest(FeatureNodeTest):
    TOPIC, MESSAGE, FOCAL_PX = "camera/matches", MatchFeatures, 200.0

    def test_a_view_becomes_the_goal_and_points_follow_the_image_as_they_do_in_process(self):
        view = self.answer_to(board(*SIZE))
        self.assertTrue(view.valid, view.fault)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertTrue(answer.success, answer.message)
        same = self.answer_to(board(*SIZE))
        self.assertEqual((same.point_x, same.z_star_m), (view.as_goal_x, 0.5))
        self.assertEqual(same.reference_stamp_ns, view.header.stamp.to_nsec())
        moved = self.answer_to(board(*SIZE, 5))
        shift = np.subtract(moved.point_x, same.point_x)
        np.testing.assert_allclose(shift, 5 / self.FOCAL_PX, atol=0.3 / self.FOCAL_PX)

        info = self.info_of(*SIZE)
        alone = MatchExtractor({"width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
                                "distortion_model": info.distortion_model}, {"detector": "orb"})
        alone.set_reference(board(*SIZE), 0.5)
        here = alone.process(board(*SIZE, 5))
        for name in ("homography", "point_x", "point_y", "match_x", "match_goal_y", "inliers", "rms_px", "xg"):
            value = getattr(moved, name)
            self.assertEqual(list(value) if isinstance(value, tuple) else value, getattr(here, name), name)

    def test_a_board_without_texture_is_refused_as_goal_and_is_no_target(self):
        before = self.answer_to(board(*SIZE)).reference_stamp_ns
        blank = self.answer_to(np.full(SIZE[::-1], 90, np.uint8))
        self.assertFalse(blank.valid or blank.target_visible)
        self.assertIn("keypoints", blank.fault)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("0 keypoints, allowed at least min_matches", answer.message)
        self.assertEqual(self.answer_to(board(*SIZE)).reference_stamp_ns, before)

    def test_a_camera_of_another_size_keeps_the_goal(self):
        view = self.answer_to(board(*SIZE))
        self.assertTrue(self.set_reference(z_star_m=0.5, from_current_view=True).success)
        for size in ((200, 150), SIZE):
            self.assertEqual(self.answer_to(board(*size)).reference_stamp_ns, view.header.stamp.to_nsec())


if __name__ == "__main__":
    rospy.init_node("test_matches_node")
    rostest.rosrun("aras_visual_servo_camera", "matches_node", MatchesNodeTest, sys.argv)
