#!/usr/bin/env python3
"""view.launch publishes every joint and the transforms down to the camera's optical frame."""

import unittest

import rospy
import rostest
from sensor_msgs.msg import JointState

WAIT_S = 30.0
MOVING_FRAMES = {"slider", "link1", "link2", "link3", "link5", "link6"}
FIXED_FRAMES = {"rail", "link0", "camera_link", "camera_optical_frame"}


def frames_of(topic, wanted):
    """Which of the wanted frame names travelled on a topic, until all did or WAIT_S passed.

    The messages are searched as bytes: Debian's tf2_msgs for Python is one more package that nothing else here needs.
    """
    seen = set()

    def note(message):
        seen.update(name for name in wanted if len(name).to_bytes(4, "little") + name.encode() in message._buff)

    subscriber = rospy.Subscriber(topic, rospy.AnyMsg, note)
    deadline = rospy.get_time() + WAIT_S
    while seen != wanted and rospy.get_time() < deadline:
        rospy.sleep(0.05)
    subscriber.unregister()
    return set(seen)


class View(unittest.TestCase):

    def test_joint_states_are_sorted_and_at_the_positions_of_view_yaml(self):
        message = rospy.wait_for_message("/aras_visual_servo/joint_states", JointState, WAIT_S)
        self.assertEqual(message.name, ["J1", "J2", "J3", "J5", "J6", "gantry"])
        expected = rospy.get_param("/aras_visual_servo/joint_position_publisher/positions")
        self.assertEqual(dict(zip(message.name, message.position)), {name: 0.0 for name in message.name} | expected)

    def test_moving_frames_are_published(self):
        self.assertEqual(frames_of("/tf", MOVING_FRAMES), MOVING_FRAMES)

    def test_fixed_frames_are_published_down_to_the_optical_frame(self):
        self.assertEqual(frames_of("/tf_static", FIXED_FRAMES), FIXED_FRAMES)


if __name__ == "__main__":
    rospy.init_node("view_test")
    rostest.rosrun("aras_description", "view", View)
