#!/usr/bin/env python3
"""Where base and links are, on /tf and /tf_static, against the true pose of the camera."""
import unittest

import numpy as np
import rospy
import rostest
from aras_visual_servo_msgs.srv import SetJointPositions, Step
from geometry_msgs.msg import PoseStamped
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage

from listening import Listener, service, until, until_sent_to

BASE = {"position": [0.3, -0.2, 2.0], "rpy": (0.2, -0.4, 0.7)}
P_BC = np.array([0.05, 0.02, -0.1])            # of the URDF
R_BC = np.diag([1.0, -1.0, -1.0])
FALL_MS, GRAVITY = 200, 9.81
ROUNDING = 1e-12                               # of a few products of numbers near 1
STEP_ERROR_M = 0.5 * GRAVITY * 0.2 * 1e-3 * 1.01   # of a fall integrated in steps of 1 ms: g t h / 2


def rotation(q):
    x, y, z, w = q.x, q.y, q.z, q.w
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def vector(v):
    return np.array([v.x, v.y, v.z])


class BaseFrames(unittest.TestCase):
    def check_camera(self, transform, pose):
        """The camera is where the base's transform and the URDF put it."""
        R_WB, p_WB = rotation(transform.rotation), vector(transform.translation)
        np.testing.assert_allclose(vector(pose.position), p_WB + R_WB @ P_BC, atol=ROUNDING)
        np.testing.assert_allclose(rotation(pose.orientation), R_WB @ R_BC, atol=ROUNDING)

    def test_free_base_is_published_with_the_stamp_of_every_joint_state_and_agrees_with_the_truth(self):
        transforms, joints = Listener("free/tf", TFMessage), Listener("free/joint_states", JointState)
        poses = Listener("free/ground_truth/camera_pose", PoseStamped)
        until_sent_to(*(listener.subscriber for listener in (transforms, joints, poses)))
        service("free/sim/step", Step)(steps=FALL_MS)
        end_ns = FALL_MS * 1_000_000
        for listener in (joints, poses):
            until(lambda listener=listener: end_ns in listener.stamps(), "joint state and image at the end")
        until(lambda: transforms.messages and transforms.messages[-1].transforms[0].header.stamp.to_nsec() == end_ns,
              "the last transform")
        by_stamp = {}
        for message in list(transforms.messages):
            (transform,) = message.transforms
            self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("world", "base_link"))
            by_stamp[transform.header.stamp] = transform.transform
        self.assertEqual({stamp.to_nsec() for stamp in by_stamp}, set(joints.stamps()))
        self.assertGreaterEqual(len(poses.messages), 6)
        for message in poses.messages:
            self.assertEqual(message.header.frame_id, "world")
            self.check_camera(by_stamp[message.header.stamp], message.pose)
        first, last = (by_stamp[stamp] for stamp in (min(by_stamp), max(by_stamp)))
        np.testing.assert_allclose(vector(first.translation), BASE["position"], atol=ROUNDING)
        fallen = first.translation.z - last.translation.z
        self.assertAlmostEqual(fallen, 0.5 * GRAVITY * (FALL_MS * 1e-3) ** 2, delta=STEP_ERROR_M)

    def test_a_base_that_stands_is_static_and_agrees_with_the_truth(self):
        poses = Listener("placed/ground_truth/camera_pose", PoseStamped)
        until_sent_to(poses.subscriber)
        (transform,) = rospy.wait_for_message("placed/tf_static", TFMessage, 30.0).transforms
        self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("world", "base_link"))
        np.testing.assert_allclose(vector(transform.transform.translation), BASE["position"], atol=ROUNDING)
        service("placed/sim/step", Step)(steps=1)
        self.check_camera(transform.transform, poses.wait()[0].pose)
        self.assertNotIn("/placed/tf", {name for name, _ in rospy.get_published_topics()})

    def test_joint_states_are_late_by_their_delay_and_keep_their_stamps(self):
        joints = Listener("told_elsewhere/joint_states", JointState)
        until_sent_to(joints.subscriber)
        step = service("told_elsewhere/sim/step", Step)
        step(steps=112)
        until(lambda: 90_000_000 in joints.stamps(), "the joint state of 90 ms")
        self.assertNotIn(100_000_000, joints.stamps(), "12.3 ms are 13 periods")
        step(steps=1)
        until(lambda: 100_000_000 in joints.stamps(), "the joint state of 100 ms")
        self.assertEqual(joints.stamps(), sorted(joints.stamps()))

    def test_the_links_are_told_with_every_image_and_lead_to_the_true_camera(self):
        transforms, poses = Listener("links/tf", TFMessage), Listener("links/ground_truth/camera_pose", PoseStamped)
        until_sent_to(transforms.subscriber, poses.subscriber)
        place = service("links/sim/set_joint_positions", SetJointPositions)
        self.assertTrue(place(name=["lift", "pan"], position=[0.07, 0.4]).success)
        service("links/sim/step", Step)(steps=FALL_MS)
        until(lambda: len(poses.messages) >= 7, "the images on the way")
        last = poses.messages[6].header.stamp
        until(lambda: transforms.messages and transforms.messages[-1].transforms[0].header.stamp >= last, "transforms")
        (static,) = rospy.wait_for_message("links/tf_static", TFMessage, 30.0).transforms
        self.assertEqual((static.header.frame_id, static.child_frame_id), ("head", "eye_optical_frame"))
        by_stamp = {message.transforms[0].header.stamp: message.transforms for message in list(transforms.messages)}
        self.assertEqual(len(by_stamp), len(transforms.messages), "one message for each stamp")
        for pose in poses.messages[:7]:
            self.assertEqual([t.child_frame_id for t in by_stamp[pose.header.stamp]], ["carriage", "head"])
            R, p = np.eye(3), np.zeros(3)
            for transform in (*by_stamp[pose.header.stamp], static):
                p = p + R @ vector(transform.transform.translation)
                R = R @ rotation(transform.transform.rotation)
            np.testing.assert_allclose(p, vector(pose.pose.position), atol=ROUNDING)
            np.testing.assert_allclose(R, rotation(pose.pose.orientation), atol=ROUNDING)

    def test_nothing_is_published_where_somebody_else_says_it(self):
        until(lambda: "/told_elsewhere/joint_states" in {name for name, _ in rospy.get_published_topics()}, "it is up")
        names = {name for name, _ in rospy.get_published_topics()}
        self.assertFalse({"/told_elsewhere/tf", "/told_elsewhere/tf_static"} & names)


if __name__ == "__main__":
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", "base_frames", BaseFrames)
