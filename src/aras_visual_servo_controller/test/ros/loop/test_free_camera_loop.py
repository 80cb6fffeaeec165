#!/usr/bin/env python3
"""The free-flying camera over ROS in lockstep: it converges, and it is the in-process run, bit by bit; TF knows it."""
import sys

import numpy as np
import rospy
from test_closed_loop import ClosedLoop
from tf2_msgs.msg import TFMessage


class FreeCameraLoop(ClosedLoop):
    SCENARIO = "free_camera"
    DURATION_LIMIT_S = 10.0  # from 0.1 m and 30 deg at 2 /s to a threshold of 0.1 mm takes ln(1000) / 2 = 3.5 s

    @classmethod
    def listen_more(cls):
        cls.frames = {}
        cls.subscriber = rospy.Subscriber("/tf", TFMessage, cls.keep, tcp_nodelay=True, queue_size=1000)

    @classmethod
    def keep(cls, message):
        for transform in message.transforms:
            if transform.child_frame_id == "camera_optical_frame" and transform.header.frame_id == "world":
                cls.frames[transform.header.stamp.to_nsec()] = transform.transform

    def compare_more(self, loop, stamp_ns):
        moved = self.frames[stamp_ns].translation
        np.testing.assert_array_equal([moved.x, moved.y, moved.z], loop.camera_pose()[:3, 3])


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "free_camera_loop", FreeCameraLoop, sys.argv)
