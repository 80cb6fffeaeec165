#!/usr/bin/env python3
"""Wiring of camera_node (or the nodelet): pairs, order, refusals, services. Numbers are judged by the unit tests."""

import sys
import time
import unittest

import numpy as np
import rospy
import rostest
from aras_visual_servo_msgs.msg import MomentFeatures
from aras_visual_servo_msgs.srv import SetReference
from sensor_msgs.msg import CameraInfo, Image

WIDTH, HEIGHT, FOCAL_PX = 160, 120, 100.0
LIMIT_S = 10.0  # wall; conditions are usually met within milliseconds


def wait_until(condition):
    end = time.monotonic() + LIMIT_S
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.005)
    return True


def image_message(stamp, u0=50, encoding="mono8", rows=20, upper_byte_first=False):
    pixels = np.full((HEIGHT, WIDTH), 230, np.uint8)
    for row in range(rows):  # an asymmetric staircase
        pixels[40 + row, u0 : u0 + 2 * (row + 1)] = 20
    channels = {"rgb8": 3, "bgr8": 3, "8UC3": 3, "rgba8": 4, "bgra8": 4, "rgb16": 3, "bgr16": 3,
                "rgba16": 4}.get(encoding, 1)
    if "16" in encoding:
        pixels = np.uint16(257) * pixels
        pixels = pixels.byteswap() if upper_byte_first else pixels
    message = Image(height=HEIGHT, width=WIDTH, encoding=encoding, step=WIDTH * channels * pixels.itemsize,
                    is_bigendian=upper_byte_first)
    message.header.stamp = stamp
    message.header.frame_id = "camera_optical_frame"
    message.data = np.repeat(pixels, channels, axis=1).tobytes()
    return message


def info_message(stamp, calibrated=True):
    message = CameraInfo(height=HEIGHT, width=WIDTH, distortion_model="plumb_bob", D=[0.0] * 5)
    message.header.stamp = stamp
    if calibrated:
        message.K = [FOCAL_PX, 0, (WIDTH - 1) / 2, 0, FOCAL_PX, (HEIGHT - 1) / 2, 0, 0, 1]
    return message


class CameraNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = 100
        cls.images = rospy.Publisher("camera/image_raw", Image, queue_size=200)
        cls.infos = rospy.Publisher("camera/camera_info", CameraInfo, queue_size=200)
        rospy.wait_for_service("camera/set_reference", LIMIT_S)
        cls.set_reference = staticmethod(rospy.ServiceProxy("camera/set_reference", SetReference))
        assert wait_until(lambda: cls.images.get_num_connections() and cls.infos.get_num_connections())

    def setUp(self):
        self.received = []
        self.subscriber = rospy.Subscriber("camera/features", MomentFeatures, self.received.append, queue_size=200)
        # rospy counts a connection before it stands, and an earlier test may have answers under way: a pair that is
        # seen to come back proves the one and, as order is kept, ends the other.
        marks = []
        self.assertTrue(wait_until(lambda: marks.append(self.publish_pair()) or time.sleep(0.02) or self.received))
        self.assertTrue(wait_until(lambda: self.received[-1].header.stamp == marks[-1]))
        self.received.clear()

    def tearDown(self):
        self.subscriber.unregister()

    def next_stamp(self):
        type(self).clock += 1
        return rospy.Time(self.clock)

    def publish_pair(self, **kwargs):
        stamp = self.next_stamp()
        self.images.publish(image_message(stamp, **kwargs))
        self.infos.publish(info_message(stamp))
        return stamp

    def expect_only_this_pair(self):
        """A good pair is answered, and nothing was published before it: queues keep order."""
        stamp = self.publish_pair()
        self.assertTrue(wait_until(lambda: any(f.header.stamp == stamp for f in self.received)))
        self.assertEqual([f.header.stamp for f in self.received], [stamp])

    def test_every_image_gives_one_message_in_order(self):
        stamps = [self.publish_pair(u0=20 + k) for k in range(60)]
        self.assertTrue(wait_until(lambda: len(self.received) >= len(stamps)))
        self.assertEqual([f.header.stamp for f in self.received], stamps)
        self.assertTrue(all(f.valid and f.header.frame_id == "camera_optical_frame" for f in self.received))
        x = [f.xg for f in self.received]
        self.assertTrue(np.allclose(np.diff(x), 1.0 / FOCAL_PX))  # one pixel further each

    def test_infos_ahead_of_their_images_are_paired_by_stamp(self):
        stamps = [self.next_stamp() for _ in range(5)]
        for stamp in stamps:
            self.infos.publish(info_message(stamp))
        for stamp in stamps:
            self.images.publish(image_message(stamp))
        self.assertTrue(wait_until(lambda: len(self.received) >= len(stamps)))
        self.assertEqual([f.header.stamp for f in self.received], stamps)

    def test_image_without_camera_info_is_refused(self):
        self.images.publish(image_message(self.next_stamp()))
        self.expect_only_this_pair()

    def test_camera_info_with_zero_K_is_refused(self):
        stamp = self.next_stamp()
        self.images.publish(image_message(stamp))
        self.infos.publish(info_message(stamp, calibrated=False))
        self.expect_only_this_pair()

    def test_other_encodings_are_refused_and_the_node_lives(self):
        self.publish_pair(encoding="32FC1")
        self.publish_pair(encoding="yuv444")
        self.expect_only_this_pair()

    def test_image_with_too_few_bytes_is_refused_and_the_node_lives(self):
        stamp = self.next_stamp()
        image = image_message(stamp)
        image.data = image.data[:100]
        self.images.publish(image)
        self.infos.publish(info_message(stamp))
        self.expect_only_this_pair()

    def test_all_encodings_give_the_same_moments(self):
        encodings = ("mono8", "rgb8", "bgr8", "rgba8", "bgra8", "8UC1", "8UC3", "mono16", "16UC1", "rgb16", "bgr16",
                     "rgba16")
        for encoding in encodings:
            self.publish_pair(encoding=encoding)
        self.publish_pair(encoding="mono16", upper_byte_first=True)
        n = len(encodings) + 1
        self.assertTrue(wait_until(lambda: len(self.received) >= n))
        self.assertEqual(len({tuple(f.m) for f in self.received}), 1)
        for encoding in ("bayer_rggb8", "bayer_bggr8", "bayer_gbrg8", "bayer_grbg8"):  # grey whichever colour is where
            self.publish_pair(encoding=encoding)
        self.assertTrue(wait_until(lambda: len(self.received) >= n + 4))
        for features in self.received[n:]:
            self.assertAlmostEqual(features.area, self.received[0].area, delta=0.05 * features.area)

    def test_reference_from_the_current_view(self):
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 1))
        answer = self.set_reference(z_star_m=0.59, from_current_view=True)
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.stamp, self.received[0].header.stamp)
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 2))
        self.assertTrue(self.received[1].has_reference)
        self.assertEqual(self.received[1].reference_stamp_ns, answer.stamp.to_nsec())
        self.assertAlmostEqual(self.received[1].an, 0.59, places=12)

    def test_reference_from_the_image_of_a_stamp_while_images_go_on_coming(self):
        stamps = [self.publish_pair(rows=12 + k) for k in range(8)]
        self.assertTrue(wait_until(lambda: len(self.received) == len(stamps)))
        for asked in (2, 6, 0):
            answer = self.set_reference(z_star_m=0.59, stamp=stamps[asked])
            self.assertTrue(answer.success, answer.message)
            self.assertEqual(answer.stamp, stamps[asked])
            before = len(self.received)
            self.publish_pair(rows=20)
            self.assertTrue(wait_until(lambda: len(self.received) > before))
            after = self.received[-1]
            self.assertEqual(after.reference_stamp_ns, stamps[asked].to_nsec())
            self.assertEqual(after.area_star, self.received[asked].area)

    def test_an_image_that_is_gone_is_refused_by_its_stamp_and_the_reference_stays(self):
        stamps = [self.publish_pair(rows=12 + k % 5) for k in range(40)]
        self.assertTrue(wait_until(lambda: len(self.received) == len(stamps)))
        self.assertTrue(self.set_reference(z_star_m=0.59, stamp=stamps[-1]).success)
        answer = self.set_reference(z_star_m=0.59, stamp=stamps[0])
        self.assertFalse(answer.success)
        for part in (f"found {stamps[0].to_sec():.9f} s", "the last 32 images", f"to {stamps[-1].to_sec():.9f} s"):
            self.assertIn(part, answer.message)
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 41))
        self.assertEqual(self.received[-1].reference_stamp_ns, stamps[-1].to_nsec())

    def test_a_stamp_and_the_current_view_do_not_go_together(self):
        stamp = self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 1))
        answer = self.set_reference(z_star_m=0.59, stamp=stamp, from_current_view=True)
        self.assertFalse(answer.success)
        self.assertIn("from_current_view", answer.message)

    def test_reference_by_numbers_and_bad_numbers(self):
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 1))
        view = self.received[0]
        answer = self.set_reference(z_star_m=0.5, area_star=4 * view.area, alpha_star=view.alpha)
        self.assertTrue(answer.success, answer.message)
        self.assertTrue(answer.stamp.is_zero())
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 2))
        self.assertAlmostEqual(self.received[1].an, 1.0, places=12)
        self.assertEqual(self.received[1].reference_stamp_ns, -1)
        answer = self.set_reference(z_star_m=0.0, area_star=0.1)
        self.assertFalse(answer.success)
        self.assertIn("z_star_m", answer.message)

    def test_images_are_published_to_those_who_listen(self):
        got = {}
        subscribers = [
            rospy.Subscriber("camera/" + name, Image, lambda m, n=name: got.__setitem__(n, m), queue_size=10)
            for name in ("converted_image", "overlay")
        ]
        self.assertTrue(wait_until(lambda: all(s.get_num_connections() for s in subscribers)))
        # the publisher may learn of its subscribers after they do: publish until both have one
        stamps = []
        self.assertTrue(wait_until(lambda: stamps.append(self.publish_pair()) or len(got) == 2))
        self.assertEqual(got["converted_image"].encoding, "mono8")
        self.assertEqual(got["overlay"].encoding, "rgb8")
        for message in got.values():
            self.assertIn(message.header.stamp, stamps)
            self.assertEqual((message.width, message.height), (WIDTH, HEIGHT))
        seen = np.frombuffer(got["converted_image"].data, np.uint8)
        self.assertEqual(set(np.unique(seen)), {0, 255})
        self.assertEqual(np.count_nonzero(seen), 20 * 21)
        for s in subscribers:
            s.unregister()

    def test_points_are_published_when_asked_for(self):
        asked = rospy.get_param("camera_node/vision/points", "none") != "none"  # not so in the nodelet's launch file
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 1))
        view = self.received[0]
        self.assertEqual(len(view.point_x), int(asked))
        if asked:  # the centroid of the one object, summed in another order
            self.assertAlmostEqual(view.point_x[0], view.xg, places=12)
            self.assertAlmostEqual(view.point_y[0], view.yg, places=12)

    def test_time_set_back_is_followed(self):
        self.publish_pair()
        self.assertTrue(wait_until(lambda: len(self.received) == 1))
        for stamp in (rospy.Time(1), rospy.Time(2)):
            self.images.publish(image_message(stamp))
            self.infos.publish(info_message(stamp))
        self.assertTrue(wait_until(lambda: len(self.received) == 3))
        self.assertEqual([f.header.stamp.secs for f in self.received[1:]], [1, 2])


if __name__ == "__main__":
    rospy.init_node("test_camera_node")
    rostest.rosrun("aras_visual_servo_camera", "camera_node", CameraNodeTest, sys.argv)
