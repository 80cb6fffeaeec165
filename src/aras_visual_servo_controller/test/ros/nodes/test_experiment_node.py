#!/usr/bin/env python3
"""The command `run` over ROS: recording, judging and exit code, with the controller killed on the way."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import rosbag
from aras_visual_servo_controller.nodes.launch import run_over_ros
from aras_visual_servo_controller.run.loop import ServoLoop
from aras_visual_servo_controller.report.report import trace_csv
from aras_visual_servo_controller.scenario.scenario import load_scenario

LIMIT_S = 120.0  # wall time
FILES = ("run.bag", "summary.json", "trace.csv", "figure.png", "figure.pdf", "report.html", "roslaunch.log")


def kill_in_phase(phase, namespace):
    """Python program that waits for that phase and kills the controller; run beside roslaunch."""
    return f"""
import os, signal, xmlrpc.client, rospy, rosgraph
from aras_visual_servo_msgs.msg import ServoState
rospy.init_node("killer", disable_signals=True)
def look(message):
    if message.phase == "{phase}":
        uri = rosgraph.Master("/killer").lookupNode("{namespace}/controller")
        os.kill(xmlrpc.client.ServerProxy(uri).getPid("/killer")[2], signal.SIGKILL)
        os._exit(0)
rospy.Subscriber("{namespace}/servo_state", ServoState, look)
rospy.spin()
"""


class ExperimentNode(unittest.TestCase):
    def run_scenario(self, namespace, *arguments):
        """(exit code, result folder, summary) of experiment_1 over ROS."""
        folder = tempfile.mkdtemp(prefix="aras_experiment_")
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        code = run_over_ros(load_scenario("experiment_1"), folder, arguments, namespace=namespace)
        results = list(pathlib.Path(folder).glob("experiment_1/*"))
        self.assertEqual(len(results), 1)
        summary = json.loads((results[0] / "summary.json").read_text())
        return code, results[0], summary

    def test_run_records_judges_and_exits_with_0(self):
        code, folder, summary = self.run_scenario("plain")
        self.assertEqual(code, 0)
        self.assertTrue(summary["converged"] and summary["passed"], summary["faults"])
        self.assertEqual(sorted(path.name for path in folder.iterdir()), sorted(FILES))
        # Recorded over ROS or run in process: the same bytes, up to the same tick.
        record = ServoLoop(load_scenario("experiment_1")).run()
        self.assertEqual(summary["run_hash"], record.run_hash)
        self.assertEqual((folder / "trace.csv").read_text(), trace_csv(record))
        self.assert_nothing_is_lost(folder / "run.bag", "/plain/")

    def assert_nothing_is_lost(self, path, namespace):
        """Each image has its features, answer and truth in the bag; joint states come every 10 ms and at each image."""
        stamps = {}
        with rosbag.Bag(str(path)) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.startswith(namespace) and getattr(message, "_has_header", False):
                    stamps.setdefault(topic[len(namespace):], []).append(message.header.stamp.to_nsec())
        images = stamps["camera/image_raw"]
        ticks = [-(-k * 1000 // 30) * 1_000_000 for k in range(len(images))]   # first 1 ms tick at or after k / 30 Hz
        self.assertEqual(images, ticks)
        for topic in ("camera/camera_info", "camera/features", "camera/converted_image", "ground_truth/camera_pose",
                      "servo_state"):
            self.assertEqual(stamps[topic], images, topic)
        expected = sorted(set(images) | set(range(0, images[-1] + 1, 10_000_000)))
        self.assertEqual([stamp for stamp in stamps["joint_states"] if stamp <= images[-1]], expected)

    def test_goes_on_when_the_controller_is_killed_while_servoing(self):
        killer = subprocess.Popen([sys.executable, "-c", kill_in_phase("servo", "/killed")])
        try:
            code, _, summary = self.run_scenario("killed", "respawn:=true", "real_time_factor:=2")
            self.assertEqual(killer.wait(LIMIT_S), 0)
        finally:
            killer.kill()
        self.assertEqual(code, 0, summary["faults"])
        self.assertTrue(summary["converged"])


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "experiment_node", ExperimentNode, sys.argv)
