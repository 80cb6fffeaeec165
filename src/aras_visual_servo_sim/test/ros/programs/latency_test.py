#!/usr/bin/env python3
"""Two cameras of different latency, one of them with a sensor, in lockstep with this test: the run of the Python class,
byte for byte."""
import hashlib
import unittest

import numpy as np
import rospy
import rostest
from aras_visual_servo_msgs.msg import SimStatus
from aras_visual_servo_msgs.srv import RestoreState, SaveState
from aras_visual_servo_sim import Simulation
from geometry_msgs.msg import PoseStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, Image, JointState
from std_srvs.srv import Empty

from listening import Listener, command, command_publisher, service, until, until_sent_to

LATENCY_NS = {"camera": 80_000_000, "side": 15_000_000}
COUNT = 20          # images of a run
VELOCITY = 0.3      # of the joint `pan` [rad/s]
DEPTH_COUNT = 3     # depth images compared


def digest(image):
    return hashlib.sha256(image.data).hexdigest()


def make_simulation():
    controllers = {name: rospy.get_param(name) for name in ("lift_controller", "pan_controller")}
    return Simulation(rospy.get_param("robot_description"), rospy.get_param("sim/sim"), controllers)


class Latency(unittest.TestCase):
    def setUp(self):
        self.status = Listener("sim/status", SimStatus)
        self.clock = Listener("/clock", Clock)
        self.joints = Listener("joint_states", JointState)
        self.info = Listener("camera/camera_info", CameraInfo)
        self.pose = Listener("ground_truth/camera_pose", PoseStamped)
        self.depth = Listener("camera/depth/image_raw", Image)
        self.images = []
        self.subscribers = [
            rospy.Subscriber(name + "/image_raw", Image, lambda image, name=name: self.images.append((name, image)),
                             queue_size=100, tcp_nodelay=True) for name in LATENCY_NS]
        self.publisher = command_publisher()
        listeners = (self.clock, self.joints, self.info, self.pose, self.depth)
        until_sent_to(*self.subscribers, *(listener.subscriber for listener in listeners))
        service("sim/pause", Empty)()
        service("sim/reset", Empty)()
        paused = self.status.newer(lambda m: m.paused and m.ticks == 0 and not m.lockstep_armed, "a fresh start")
        self.start = paused.header.stamp
        self.images[:] = []
        self.publisher.publish(command(rospy.Time(0)))
        self.status.newer(lambda m: m.lockstep_armed, "the first command arms the lockstep")
        service("sim/unpause", Empty)()

    def answer(self, count):
        """Answers the newest image and those after it until `count` more came; status while the last is held."""
        until(lambda: self.images, "the first image")
        seen = len(self.images)
        for k in range(seen, seen + count):
            self.publisher.publish(command(self.images[k - 1][1].header.stamp, pan=VELOCITY))
            until(lambda k=k: len(self.images) > k, "image %d" % k)
        status = self.status.newer(lambda m: m.holding, "holding for the last one")
        self.wait_for_what_goes_with(list(self.images))
        return status

    def wait_for_what_goes_with(self, images):
        """Waits until joint states and truth of these images have come, each of which has a connection of its own."""
        all_stamps = {image.header.stamp.to_nsec() for _, image in images}
        own = {image.header.stamp.to_nsec() for name, image in images if name == "camera"}
        for listener, stamps in ((self.joints, all_stamps), (self.pose, own), (self.info, own)):
            until(lambda listener=listener, stamps=stamps: stamps <= set(listener.stamps()), "what goes with images")

    def test_the_run_is_that_of_the_python_class(self):
        status = self.answer(COUNT)
        simulation = make_simulation()
        states = {message.header.stamp: message for message in self.joints.messages}
        poses = {message.header.stamp: message.pose for message in self.pose.messages}
        infos = {message.header.stamp for message in self.info.messages}
        compared = 0
        for name, image in self.images:
            due = min(LATENCY_NS, key=lambda camera: (simulation.next_image_ns(camera), list(LATENCY_NS).index(camera)))
            self.assertEqual(due, name)
            stamp_ns = simulation.step_to_image(name)
            stamp = image.header.stamp
            self.assertEqual((stamp - self.start).to_nsec(), stamp_ns)
            self.assertEqual(simulation.time_ns, stamp_ns + LATENCY_NS[name])
            self.assertEqual(hashlib.sha256(simulation.render(name).tobytes()).hexdigest(), digest(image))
            truth = simulation.frame_state(name)
            np.testing.assert_array_equal(states[stamp].position, truth["joint_positions"])
            if name == "camera":
                self.assertIn(stamp, infos)
                position = poses[stamp].position
                np.testing.assert_array_equal([position.x, position.y, position.z], truth["camera_pose"][:3, 3])
                for message in self.depth.messages:
                    if message.header.stamp == stamp:
                        np.testing.assert_array_equal(np.frombuffer(message.data, np.float32).reshape(48, 64),
                                                      simulation.render_depth(name))
                        compared += 1
            if (name, image) != self.images[-1]:
                simulation.set_command(velocity={"pan": VELOCITY}, stamp_ns=stamp_ns)
        self.assertGreaterEqual(compared, DEPTH_COUNT)
        self.assertEqual(simulation.run_hash, status.run_hash)
        self.assertEqual(status.refused_commands, 0, status.last_refusal)
        self.assertGreater(abs(truth["joint_positions"][1]), 0.01, "the arm moves")

    def test_restored_in_mid_flight_it_goes_on_in_the_same_way_and_no_stamp_goes_back(self):
        self.answer(7)
        save, restore = service("sim/save_state", SaveState), service("sim/restore_state", RestoreState)
        self.assertTrue(save(name="here").success)
        count = len(self.images)
        first = self.answer(8)
        images = [(name, digest(image)) for name, image in self.images[count - 1:]]
        before = len(self.images)
        newest = max(self.joints.stamps())
        seen = len(self.joints.messages)
        self.assertTrue(restore(name="here").success)
        until(lambda: len(self.images) > before, "the image is sent again")
        again = self.answer(8)
        self.assertEqual([(name, digest(image)) for name, image in self.images[before:]], images)
        self.assertEqual(again.run_hash, first.run_hash)
        stamps = self.joints.stamps()[seen:]
        self.assertGreater(stamps[0], newest)
        self.assertEqual(stamps, sorted(stamps))
        known = set(stamps)
        for _, image in self.images[before:]:
            self.assertIn(image.header.stamp.to_nsec(), known, "a joint state for every image")


if __name__ == "__main__":
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", "latency", Latency)
