#!/usr/bin/env python3
"""A driven base over ROS: twist_command in the frame of a carried link answers images, and poses place it."""
import sys
import unittest

import numpy as np
import rospy
from geometry_msgs.msg import PoseStamped, TwistStamped
from sensor_msgs.msg import JointState
from std_srvs.srv import Empty

from aras_visual_servo_msgs.msg import SimStatus
from aras_visual_servo_msgs.srv import SetJointPositions
from listening import Listener, command_publisher, service, until_sent_to

TWIST = [0.1, -0.2, 0.05, 0.6, -0.4, 1.2]  # of the eye, in its own axes
ROUNDING = 1e-12  # of some ten steps of numbers near one
IMAGES = 10


def matrix(pose):
    x, y, z, w = pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w
    X = np.eye(4)
    X[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                 [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                 [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
    X[:3, 3] = [pose.position.x, pose.position.y, pose.position.z]
    return X


def held(V, t_s):
    """Pose after a body twist: the power series of the exponential."""
    w = V[3:]
    M, X, term = np.zeros((4, 4)), np.eye(4), np.eye(4)
    M[:3, :3], M[:3, 3] = [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]], V[:3]
    for k in range(1, 30):
        term = term @ M * (t_s / k)
        X = X + term
    return X


def twist_message(stamp, frame, values=TWIST):
    message = TwistStamped()
    message.header.stamp, message.header.frame_id = stamp, frame
    (message.twist.linear.x, message.twist.linear.y, message.twist.linear.z, message.twist.angular.x,
     message.twist.angular.y, message.twist.angular.z) = values
    return message


class DrivenBase(unittest.TestCase):
    def test_twists_answer_images_and_move_the_camera_exactly(self):
        poses, joints = Listener("ground_truth/camera_pose", PoseStamped), Listener("joint_states", JointState)
        status = Listener("sim/status", SimStatus)
        twists = command_publisher("twist_command", TwistStamped)
        until_sent_to(poses.subscriber, joints.subscriber)
        twists.publish(twist_message(rospy.Time(0), "eye_optical_frame"))
        status.newer(lambda s: s.lockstep_armed, "the first command arms the lockstep")
        service("sim/unpause", Empty)()
        armed_at = status.newer(lambda s: s.holding, "the simulator waits for an answer").header.stamp
        self.assertIn("joint_command", status.messages[-1].held_by)
        held_at = armed_at  # poses of the time before may still be under way
        for _ in range(IMAGES):
            twists.publish(twist_message(held_at, "eye_optical_frame"))
            held_at = poses.later(held_at, "the next image").header.stamp
        path = [p for p in poses.messages if p.header.stamp > armed_at]
        self.assertEqual(len(path), IMAGES, "one image an answer")
        for before, after in zip(path, path[1:]):
            dt_s = (after.header.stamp - before.header.stamp).to_sec()
            self.assertAlmostEqual(dt_s, 0.02)
            np.testing.assert_allclose(matrix(after.pose), matrix(before.pose) @ held(np.array(TWIST), dt_s),
                                       atol=ROUNDING)
        last = joints.at(held_at, "the joint states of the last image")
        self.assertEqual(last.name, ["px", "py", "pz", "rx", "ry", "rz"])
        self.assertAlmostEqual(np.linalg.norm(last.velocity[3:]), np.linalg.norm(TWIST[3:]))

        for frame, words in (("world", "a link that the driven base carries"), ("elbow", "does not exist")):
            count = status.messages[-1].refused_commands
            twists.publish(twist_message(held_at, frame))
            refused = status.newer(lambda s: s.refused_commands > count, "the command is refused")
            self.assertIn(words, refused.last_refusal)
            held_at = poses.later(held_at, "a refused command answers its image too").header.stamp
        rest = [matrix(message.pose) for message in poses.messages[-2:]]
        np.testing.assert_array_equal(rest[0], rest[1])

        place = service("sim/set_joint_positions", SetJointPositions)
        self.assertTrue(place(["px", "rx", "ry", "rz"], [0.7, 0.0, np.pi, 0.0]).success)
        twists.publish(twist_message(held_at, "", [0.0] * 6))
        placed = joints.at(poses.later(held_at, "the next image").header.stamp, "its joint states")
        np.testing.assert_allclose(placed.position[3:], [0.0, np.pi, 0.0], atol=ROUNDING)
        self.assertEqual(placed.position[0], 0.7)
        answer = place(["J1"], [0.0])
        self.assertFalse(answer.success)
        self.assertIn("a driven base has: px, py, pz, rx, ry, rz", answer.message)


if __name__ == "__main__":
    import rostest
    rospy.init_node("driven_base_test")
    rostest.rosrun("aras_visual_servo_sim", "driven_base", DrivenBase, sys.argv)
