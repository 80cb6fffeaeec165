#!/usr/bin/env python3
"""The command `run` over ROS: recording, judging and exit code, with the controller killed on the way."""
import json
import pathlib
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import psutil
import rosbag
from aras_visual_servo_controller.nodes.launch import run_over_ros
from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo_study.report.report import trace_csv
from aras_visual_servo.scenario.scenario import load_scenario

LIMIT_S = 120.0  # wall time
FILES = ("run.bag", "summary.json", "trace.csv", "figure.png", "figure.pdf", "report.html", "roslaunch.log")


def kill_in_phase(phase, namespace):
    """Python program that says when it listens, waits for that phase and kills the controller."""
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
print("listening", flush=True)
rospy.spin()
"""


def start_listening(program):
    """Starts it beside the run to come, and waits until it listens: on a busy machine the run may be over before."""
    process = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "listening\n"
    return process


def writer_of(path):
    """Process that has this file open, None without one."""
    for process in psutil.process_iter():
        try:
            if process.name() == "sim_node" and str(path) in [file.path for file in process.open_files()]:
                return process
        except psutil.Error:
            pass  # it ends
    return None


def stop_for_a_while(results):
    """Stop for 3 s who writes the bag in this folder, when 200 kB are written. Returns what was written by then."""
    end_s = time.monotonic() + LIMIT_S
    while time.monotonic() < end_s:
        for path in results.glob("*/*/run.bag.active"):
            writer = path.stat().st_size > 200_000 and writer_of(path)
            if writer:
                writer.suspend()
                size = path.stat().st_size
                time.sleep(3.0)
                writer.resume()
                return size
        time.sleep(0.005)
    return 0


class ExperimentNode(unittest.TestCase):
    def setUp(self):
        self.results = pathlib.Path(tempfile.mkdtemp(prefix="aras_experiment_"))
        self.addCleanup(shutil.rmtree, self.results, ignore_errors=True)

    def run_scenario(self, namespace, *arguments):
        """(exit code, result folder, summary) of experiment_1 over ROS."""
        code = run_over_ros(load_scenario("experiment_1"), self.results, arguments, namespace=namespace)
        results = list(self.results.glob("experiment_1/*"))
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
        for topic in ("camera/camera_info", "camera/features", "ground_truth/camera_pose"):
            self.assertEqual(stamps[topic], images, topic)
        self.assertEqual(sorted(set(stamps["servo_state"])), images)  # an image that is long in coming gives one more
        for topic in ("camera/converted_image", "camera/segmentation/image_raw", "camera/depth/image_raw"):
            self.assertNotIn(topic, stamps)  # made for who asks, and nobody did
        expected = sorted(set(images) | set(range(0, images[-1] + 1, 10_000_000)))
        self.assertEqual([stamp for stamp in stamps["joint_states"] if stamp <= images[-1]], expected)

    def test_nothing_is_lost_when_who_writes_the_bag_is_stopped_for_a_while(self):
        stopped = []
        stopper = threading.Thread(target=lambda: stopped.append(stop_for_a_while(self.results)), daemon=True)
        stopper.start()
        code, folder, summary = self.run_scenario("stalled", "real_time_factor:=2")
        stopper.join(LIMIT_S)
        self.assertTrue(stopped and 200_000 < stopped[0] < 0.9 * (folder / "run.bag").stat().st_size, stopped)
        self.assertEqual((code, summary["notes"]), (0, []))
        self.assert_nothing_is_lost(folder / "run.bag", "/stalled/")
        for topic in ("camera/image_raw", "camera/features", "joint_states", "ground_truth/camera_pose"):
            count = summary["recorded"]["/stalled/" + topic]
            self.assertTrue(count["published"] == count["in_bag"] > 0, (topic, count))

    def test_a_disk_that_is_full_is_the_named_failure_of_the_run(self):
        before = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8_000_000, before[1]))   # the nodes inherit it
        self.addCleanup(resource.setrlimit, resource.RLIMIT_FSIZE, before)
        code = run_over_ros(load_scenario("experiment_1"), self.results, ["record_compression:=none"],
                            namespace="full")
        self.assertEqual(code, 3)
        [log] = self.results.glob("experiment_1/*/roslaunch.log")
        self.assertIn("the recording ended: " + str(log.parent / "run.bag") + ": File too large", log.read_text())

    def test_goes_on_when_the_controller_is_killed_while_servoing(self):
        killer = start_listening(kill_in_phase("servo", "/killed"))
        try:
            code, _, summary = self.run_scenario("killed", "respawn:=true", "real_time_factor:=2", "nodelets:=false")
            self.assertEqual(killer.wait(LIMIT_S), 0)
        finally:
            killer.kill()
        self.assertEqual(code, 0, summary["faults"])
        self.assertTrue(summary["converged"])


if __name__ == "__main__":
    import rostest
    rostest.rosrun("aras_visual_servo_controller", "experiment_node", ExperimentNode, sys.argv)
