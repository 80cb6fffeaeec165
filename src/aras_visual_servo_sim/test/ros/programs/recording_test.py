#!/usr/bin/env python3
"""The simulator writes bags: its own topics without a listener, those of others, counts, refusals, a full disk."""
import pathlib
import re
import resource
import shutil
import tempfile
import threading
import unittest
import xmlrpc.client

import rosbag
import rosgraph
import rospy
import rostest
from aras_visual_servo_msgs.msg import SimStatus
from aras_visual_servo_msgs.srv import StartRecording
from geometry_msgs.msg import PointStamped
from listening import Listener, service, until
from sensor_msgs.msg import Image
from std_msgs.msg import String
from std_srvs.srv import Trigger


def simulator():
    """Process of the simulator."""
    return xmlrpc.client.ServerProxy(rosgraph.Master("/test").lookupNode("/recording/sim")).getPid("/test")[2]


class Recording(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="aras_recording_"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.status = Listener("sim/status", SimStatus)
        self.addCleanup(self.status.subscriber.unregister)
        self.stop = service("sim/stop_recording", Trigger)
        self.addCleanup(self.stop)

    def start(self, name, topics, compression="lz4", split_mib=0):
        return service("sim/start_recording", StartRecording)(str(self.folder / name), topics, compression, split_mib)

    def pass_time(self, seconds):
        """Until that much simulated time has passed."""
        end = rospy.get_rostime() + rospy.Duration(seconds)
        self.status.newer(lambda status: status.header.stamp > end, f"{seconds} s later")

    def read(self, name):
        """dict topic -> messages of a bag."""
        messages = {}
        with rosbag.Bag(str(self.folder / name)) as bag:
            for topic, message, _ in bag.read_messages():
                messages.setdefault(topic, []).append(message)
        return messages

    def test_own_topics_are_written_without_a_listener(self):
        topics = ["/recording/camera/image_raw", "/recording/camera/camera_info", "/recording/joint_states", "/clock",
                  "/recording/ground_truth/camera_pose", "/recording/camera/segmentation/image_raw"]
        self.assertTrue(self.start("own.bag", topics).success)
        self.pass_time(2.0)
        self.assertTrue(self.stop().success)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["own.bag"])
        messages = self.read("own.bag")
        self.assertEqual(set(messages), {*topics, "/recording/sim/recording"})
        stamps = [message.header.stamp.to_nsec() for message in messages["/recording/camera/image_raw"]]
        first = round(stamps[0] * 30 / 1e9)
        self.assertEqual(stamps, [-(-(first + k) * 1000 // 30) * 1_000_000 for k in range(len(stamps))])
        self.assertGreaterEqual(len(stamps), 59)
        for topic in ("camera/camera_info", "ground_truth/camera_pose", "camera/segmentation/image_raw"):
            self.assertEqual([message.header.stamp.to_nsec() for message in messages["/recording/" + topic]], stamps)
        [counts] = messages["/recording/sim/recording"]
        self.assertEqual(dict(zip(counts.topics, counts.published)), {topic: len(messages[topic]) for topic in topics})

    def test_messages_that_a_queue_dropped_are_counted(self):
        publisher = rospy.Publisher("/elsewhere", PointStamped, queue_size=None)
        text = rospy.Publisher("/told", String, queue_size=None)
        self.assertTrue(self.start("foreign.bag", ["/elsewhere", "/told", "/recording/sim/status"]).success)
        until(lambda: publisher.get_num_connections() and text.get_num_connections(), "the recording listens")
        for k in range(5):
            publisher.publish(PointStamped())
            text.publish(String("a"))
            if k == 2:
                publisher.impl.seq += 4  # what a full queue leaves
        self.pass_time(1.0)
        self.assertTrue(self.stop().success)
        messages = self.read("foreign.bag")
        self.assertEqual([len(messages[topic]) for topic in ("/elsewhere", "/told")], [5, 5])
        self.assertTrue(messages["/recording/sim/status"][-1].recording)
        counts = messages["/recording/sim/recording"][0]
        told = {topic: (n, counted) for topic, n, counted in zip(counts.topics, counts.published, counts.counted)}
        self.assertEqual((told["/elsewhere"], told["/told"]), ((9, True), (5, False)))

    def test_what_a_latched_topic_sends_to_a_newcomer_alone_is_not_taken_for_lost(self):
        publisher = rospy.Publisher("/kept", PointStamped, queue_size=10, latch=True)
        self.addCleanup(publisher.unregister)
        self.assertTrue(self.start("latched.bag", ["/kept"]).success)
        until(publisher.get_num_connections, "the recording listens")
        publisher.publish(PointStamped())
        newcomer = Listener("/kept", PointStamped)
        self.addCleanup(newcomer.subscriber.unregister)
        newcomer.wait(1)
        publisher.publish(PointStamped())
        self.assertEqual([message.header.seq for message in newcomer.wait(2)], [2, 3])
        self.pass_time(1.0)
        self.assertTrue(self.stop().success)
        messages = self.read("latched.bag")
        self.assertEqual([message.header.seq for message in messages["/kept"]], [1, 3])
        [counts] = messages["/recording/sim/recording"]
        self.assertEqual([*zip(counts.topics, counts.published, counts.counted)], [("/kept", 2, False)])

    def test_every_part_of_a_split_recording_has_the_latched_messages(self):
        self.assertTrue(self.start("split.bag", ["/recording/camera/image_raw", "/recording/scene_markers"], "none",
                                   split_mib=1).success)
        until(lambda: (self.folder / "split_2.bag.active").exists(), "a third part")
        self.assertTrue(self.stop().success)
        stamps = []
        for part in range(len(list(self.folder.iterdir()))):
            messages = self.read(f"split_{part}.bag")
            if part > 0:
                self.assertEqual(len(messages["/recording/scene_markers"]), 1, part)
            stamps += [message.header.stamp.to_nsec() for message in messages["/recording/camera/image_raw"]]
        first = round(stamps[0] * 30 / 1e9)
        self.assertEqual(stamps, [-(-(first + k) * 1000 // 30) * 1_000_000 for k in range(len(stamps))])

    def test_what_cannot_be_meant_is_refused_by_name(self):
        (self.folder / "there.bag").write_text("")
        for name, topics, compression, words in (
                ("there.bag", ["/clock"], "lz4", "allowed one that does not exist"),
                ("run.txt", ["/clock"], "lz4", "allowed a path that ends in .bag"),
                ("run.bag", ["/clock"], "zip", "found the compression 'zip'"),
                ("run.bag", [], "lz4", "found no topic"),
                ("run.bag", ["a b"], "lz4", "found the topic 'a b'"),
                ("nowhere/run.bag", ["/clock"], "lz4", "No such file or directory")):
            answer = self.start(name, topics, compression)
            self.assertFalse(answer.success)
            self.assertIn(words, answer.message)
        relative = service("sim/start_recording", StartRecording)("run.bag", ["/clock"], "lz4", 0)
        self.assertIn("allowed an absolute path", relative.message)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["there.bag"])
        self.assertTrue(self.start("run.bag", ["/clock"]).success)
        self.assertIn("stop it first", self.start("other.bag", ["/clock"]).message)

    def test_a_full_disk_is_named_at_once(self):
        (self.folder / "run.bag.active").symlink_to("/dev/full")
        answer = self.start("run.bag", ["/recording/camera/image_raw"], "none")
        self.assertFalse(answer.success)
        self.assertIn("run.bag: No space left on device", answer.message)
        self.assertTrue(self.start("again.bag", ["/clock"]).success)  # the simulator lives

    def test_images_that_wait_for_a_listener_that_hangs_have_a_bound_in_bytes(self):
        status = pathlib.Path(f"/proc/{simulator()}/status")
        hangs = threading.Event()
        self.addCleanup(hangs.set)
        rospy.Subscriber("camera/image_raw", Image, lambda _: hangs.wait())
        self.pass_time(1.0)
        before = int(re.search(r"RssAnon:\s+(\d+) kB", status.read_text())[1])
        self.pass_time(12.0)  # 360 images, 79 MiB
        after = int(re.search(r"RssAnon:\s+(\d+) kB", status.read_text())[1])
        self.assertLess(after - before, 24 * 1024)

    def test_a_disk_that_fills_up_ends_the_recording_with_its_name(self):
        pid = simulator()
        before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
        self.assertTrue(self.start("run.bag", ["/recording/camera/image_raw"], "none").success)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (3_000_000, before[1]))
        fault = self.status.newer(lambda status: status.recording_fault, "a fault of the recording")
        self.assertIn("run.bag: File too large", fault.recording_fault)
        self.assertFalse(fault.recording)
        answer = self.stop()
        self.assertFalse(answer.success)
        self.assertIn("File too large", answer.message)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, before)
        self.assertTrue(self.start("again.bag", ["/clock"]).success)  # the simulator lives
        self.status.newer(lambda status: status.recording and not status.recording_fault, "another recording")
        self.assertTrue(self.stop().success)


if __name__ == "__main__":
    rospy.init_node("recording_test")
    rostest.rosrun("aras_visual_servo_sim", "recording", Recording)
