#!/usr/bin/env python3
"""Wiring of camera_node with vision.matches: topic, stamps, goal image, boards without texture, another camera."""

import sys
import unittest

import numpy as np
import rospy
import rostest
from aras_visual_servo_camera import MatchExtractor
from aras_visual_servo_msgs.msg import MatchFeatures
from aras_visual_servo_msgs.srv import SetReference
from sensor_msgs.msg import CameraInfo, Image

from test_camera_node import LIMIT_S, wait_until

FOCAL_PX = 200.0
SIZE = (320, 240)


def board(width, height, shift_px=0):
    """Rectangles of many greys, moved to the right by whole pixels."""
    rng, image = np.random.default_rng(3), np.full((height, width + 40), 128, np.uint8)
    for _ in range(400):
        u, v, w, h = rng.integers(0, (width + 40, height, 30, 30))
        image[v:v + h, u:u + w] = rng.integers(0, 256)
    return np.ascontiguousarray(image[:, 20 - shift_px:20 - shift_px + width])


def info_of(width, height):
    return CameraInfo(height=height, width=width, distortion_model="plumb_bob", D=[0.0] * 5,
                      K=[FOCAL_PX, 0, (width - 1) / 2, 0, FOCAL_PX, (height - 1) / 2, 0, 0, 1])


class MatchesNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock, cls.received = 100, []
        cls.images = rospy.Publisher("camera/image_raw", Image, queue_size=200)
        cls.infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=200)
        cls.subscriber = rospy.Subscriber("camera/matches", MatchFeatures, cls.received.append, queue_size=200)
        rospy.wait_for_service("camera/set_reference", LIMIT_S)
        cls.set_reference = staticmethod(rospy.ServiceProxy("camera/set_reference", SetReference))
        assert wait_until(lambda: cls.images.get_num_connections() and cls.infos.get_num_connections()
                          and cls.subscriber.get_num_connections())

    def answer_to(self, pixels):
        """Features of this image, by its stamp."""
        type(self).clock += 1
        height, width = pixels.shape
        image = Image(height=height, width=width, encoding="mono8", step=width, data=pixels.tobytes())
        info = info_of(width, height)
        image.header.stamp = info.header.stamp = rospy.Time(self.clock)
        image.header.frame_id = info.header.frame_id = "camera_optical_frame"
        found = []

        def answered():
            self.images.publish(image)  # again, until the connections stand: the node takes equal stamps
            self.infos.publish(info)
            found.extend(message for message in self.received if message.header.stamp == image.header.stamp)
            return found

        self.assertTrue(wait_until(answered))
        return found[0]

    def test_a_view_becomes_the_goal_and_points_follow_the_image_as_they_do_in_process(self):
        view = self.answer_to(board(*SIZE))
        self.assertTrue(view.valid and not view.has_reference)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertTrue(answer.success, answer.message)
        same = self.answer_to(board(*SIZE))
        self.assertEqual((same.point_x, same.z_star_m), (view.as_goal_x, 0.5))
        self.assertEqual(same.reference_stamp_ns, view.header.stamp.to_nsec())
        moved = self.answer_to(board(*SIZE, 5))
        np.testing.assert_allclose(np.subtract(moved.point_x, same.point_x), 5 / FOCAL_PX, atol=0.3 / FOCAL_PX)

        info = info_of(*SIZE)
        alone = MatchExtractor({"width": info.width, "height": info.height, "K": list(info.K), "D": list(info.D),
                                "distortion_model": info.distortion_model}, {"detector": "orb"})
        alone.set_reference(board(*SIZE), 0.5)
        here = alone.process(board(*SIZE, 5))
        for name in ("homography", "point_x", "point_y", "match_x", "match_goal_y", "inliers", "rms_px", "xg"):
            value = getattr(moved, name)
            self.assertEqual(list(value) if isinstance(value, tuple) else value, getattr(here, name), name)

    def test_a_board_without_texture_is_refused_as_goal_and_is_no_target(self):
        blank = self.answer_to(np.full(SIZE[::-1], 90, np.uint8))
        self.assertFalse(blank.valid or blank.target_visible)
        self.assertIn("keypoints", blank.fault)
        answer = self.set_reference(z_star_m=0.5, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("0 keypoints, allowed at least min_matches", answer.message)
        self.assertFalse(self.answer_to(board(*SIZE)).has_reference)

    def test_a_camera_of_another_size_has_no_goal(self):
        self.answer_to(board(*SIZE))
        self.assertTrue(self.set_reference(z_star_m=0.5, from_current_view=True).success)
        other = self.answer_to(board(200, 150))
        self.assertTrue(other.valid)
        self.assertFalse(other.has_reference)


if __name__ == "__main__":
    rospy.init_node("test_matches_node")
    rostest.rosrun("aras_visual_servo_camera", "matches_node", MatchesNodeTest, sys.argv)
