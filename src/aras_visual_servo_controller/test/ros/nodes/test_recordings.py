#!/usr/bin/env python3
"""Recordings that follow one another: what is published once all connections stand is in the bag."""
import os
import pathlib
import shutil
import sys
import tempfile
import unittest

import rosbag
import rospy
from aras_visual_servo_controller.nodes.graph import Graph
from aras_visual_servo_controller.nodes.recording import Recording
from std_msgs.msg import String
from std_srvs.srv import Empty
from wiring import call, wait_until

RECORDINGS = 20
TOPIC = "/told"


class Recordings(unittest.TestCase):
    def test_every_recording_has_what_was_published_once_its_connections_stood(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="aras_recordings_"))
        self.addCleanup(shutil.rmtree, folder)
        publisher = rospy.Publisher(TOPIC, String, queue_size=10)
        graph = Graph(rospy.get_name(), os.environ["ROS_MASTER_URI"])
        nodes = {rospy.get_name(), rospy.resolve_name("sim")}
        call("sim/pause", Empty)
        told = []
        for number in range(RECORDINGS):
            bag = folder / f"{number}.bag"
            recording = Recording(bag, [TOPIC])
            wait_until(lambda: not graph.missing_connections(nodes), "the connections")
            publisher.publish(str(number))
            recording.settle()
            recording.stop()
            with rosbag.Bag(str(bag)) as file:
                told.append([message.data for _, message, _ in file.read_messages([TOPIC])])
        self.assertEqual(told, [[str(number)] for number in range(RECORDINGS)])


if __name__ == "__main__":
    import rostest
    rospy.init_node("test_recordings")
    rostest.rosrun("aras_visual_servo_controller", "recordings", Recordings, sys.argv)
