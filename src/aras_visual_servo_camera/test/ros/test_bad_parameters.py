#!/usr/bin/env python3
"""camera_node does not start with parameters it cannot use, and lists all of their faults."""

import subprocess
import sys
import unittest

import rospy
import rostest

LIMIT_S = 20.0


class BadParametersTest(unittest.TestCase):
    def run_with(self, vision):
        name = "/camera_node_" + self.id().rsplit(".", 1)[-1]
        if vision is not None:
            rospy.set_param(name + "/vision", vision)
        command = ["rosrun", "aras_visual_servo_camera", "camera_node", "__name:=" + name[1:]]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S, check=False)
        return done.returncode, done.stdout.decode()

    def test_every_fault_is_listed(self):
        code, text = self.run_with({"object": "grey", "segmentation": "fixed", "order": 2, "colour": "red"})
        self.assertNotEqual(code, 0)
        for part in ("vision.object: found grey", "vision.threshold: found nothing", "vision.order", "vision.colour"):
            self.assertIn(part, text)

    def test_missing_section_is_named(self):
        code, text = self.run_with(None)
        self.assertNotEqual(code, 0)
        self.assertIn("vision: found nothing", text)


if __name__ == "__main__":
    rospy.init_node("test_bad_parameters")
    rostest.rosrun("aras_visual_servo_camera", "bad_parameters", BadParametersTest, sys.argv)
