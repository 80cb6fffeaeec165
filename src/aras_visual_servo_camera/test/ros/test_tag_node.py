#!/usr/bin/env python3
"""Wiring of camera_node with vision.tag: topic, stamps, goal image, no tag, another, two of it, another camera."""

import sys

import cv2
import numpy as np
import rospy
import rostest
from aras_visual_servo_camera import TagExtractor
from aras_visual_servo_msgs.msg import PhotometricFeatures, TagFeatures

from feature_node import FeatureNodeTest
from test_camera_node import wait_until

SIZE = (320, 240)
SIDE_PX, SIDE_M, NUMBER = 80, 0.2, 7
#: Where the tag is meant to be; a margin of one module belongs to it.
LEFT, TOP = 110, 70


def with_tags(*places, number=NUMBER):
    """Grey image with a tag at each place, (u, v) of the upper left corner of its black square."""
    image = np.full(SIZE[::-1], 150, np.uint8)
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker  # its name before OpenCV 4.7
    code = draw(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11), number, SIDE_PX)
    for u, v in places:
        image[v - 10:v + SIDE_PX + 10, u - 10:u + SIDE_PX + 10] = 230
        image[v:v + SIDE_PX, u:u + SIDE_PX] = code
    return image


class TagNodeTest(FeatureNodeTest):
    TOPIC, MESSAGE, FOCAL_PX = "camera/tag", TagFeatures, 200.0

    def test_a_view_becomes_the_goal_and_the_tag_follows_the_image_as_it_does_in_process(self):
        view = self.answer_to(with_tags((LEFT, TOP)))
        self.assertTrue(view.valid and view.target_visible, view.fault)
        self.assertEqual((view.id, view.tags, len(view.point_x)), (NUMBER, 1, 4))
        self.assertAlmostEqual(view.position_m[2], SIDE_M * self.FOCAL_PX / SIDE_PX, delta=0.005)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertTrue(answer.success, answer.message)
        moved = self.answer_to(with_tags((LEFT + 5, TOP)))
        self.assertEqual(moved.reference_stamp_ns, view.header.stamp.to_nsec())
        self.assertEqual(moved.z_star_m, 0.5)
        np.testing.assert_allclose(np.subtract(moved.point_x, view.point_x), 5 / self.FOCAL_PX, atol=1e-4)

        info = self.info_of(*SIZE)
        alone = TagExtractor({"width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
                              "distortion_model": info.distortion_model}, {"id": NUMBER, "size_m": SIDE_M})
        alone.set_reference(with_tags((LEFT, TOP)), 0.5)
        here = alone.process(with_tags((LEFT + 5, TOP)))
        for name in ("homography", "point_x", "point_y", "position_m", "orientation", "pose_error", "side_px", "xg"):
            value, own = getattr(moved, name), getattr(here, name)
            self.assertEqual(list(value) if isinstance(value, tuple) else value,
                             own if isinstance(own, float) else list(own), name)

    def test_no_tag_another_tag_and_two_of_it_are_no_target_and_no_goal(self):
        for image, words in ((np.full(SIZE[::-1], 90, np.uint8), "does not show tag 7 of 36h11"),
                             (with_tags((LEFT, TOP), number=3), "does not show tag 7 of 36h11, but 3"),
                             (with_tags((30, TOP), (200, TOP)), "2 times tag 7")):
            seen = self.answer_to(image)
            self.assertFalse(seen.valid or seen.target_visible)
            self.assertIn(words, seen.fault)
            answer = self.set_reference(z_star_m=0.5, from_current_view=True)
            self.assertFalse(answer.success, answer.message)

    def test_a_camera_of_another_size_keeps_the_goal(self):
        view = self.answer_to(with_tags((LEFT, TOP)))
        self.assertTrue(self.set_reference(z_star_m=0.5, from_current_view=True).success)
        for image in (with_tags((LEFT, TOP))[:-20], with_tags((LEFT, TOP))):
            self.assertEqual(self.answer_to(image).reference_stamp_ns, view.header.stamp.to_nsec())

    def test_a_refused_teach_leaves_the_goals_of_all_features_as_they_were(self):
        seen = []
        subscriber = rospy.Subscriber("camera/photometric", PhotometricFeatures, seen.append, queue_size=200)
        view = self.answer_to(with_tags((LEFT, TOP)))
        self.assertTrue(self.set_reference(z_star_m=0.5, from_current_view=True).success)
        self.answer_to(with_tags((LEFT + 9, TOP), number=3))
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("tag 7", answer.message)
        home = self.answer_to(with_tags((LEFT, TOP)))
        self.assertEqual(home.reference_stamp_ns, view.header.stamp.to_nsec())
        self.assertTrue(wait_until(lambda: any(one.header.stamp == home.header.stamp for one in seen)))
        one = [one for one in seen if one.header.stamp == home.header.stamp][0]
        self.assertEqual((one.rms, one.reference_stamp_ns), (0.0, view.header.stamp.to_nsec()))
        subscriber.unregister()


if __name__ == "__main__":
    rospy.init_node("test_tag_node")
    rostest.rosrun("aras_visual_servo_camera", "tag_node", TagNodeTest, sys.argv)
