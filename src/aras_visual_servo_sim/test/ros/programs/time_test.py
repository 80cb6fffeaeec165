#!/usr/bin/env python3
"""Lockstep with several nodes and cameras, the clock of a reset, snapshots; run by the .test files beside this one."""
import hashlib
import os
import sys
import tempfile
import unittest

import rospy
import rostest
from aras_visual_servo_msgs.msg import SimStatus
from aras_visual_servo_msgs.srv import RestoreState, SaveState, SetTargetPose
from aras_visual_servo_sim import Simulation
from geometry_msgs.msg import Pose, Quaternion
from sensor_msgs.msg import Image, JointState
from std_srvs.srv import Empty

from listening import Listener, command, command_publisher, service, until, until_sent_to

COUNT = 12  # images of a run


def digest(image):
    """Of an image's bytes; the bytes themselves in a failure's message are more than the result files bear."""
    return hashlib.sha256(image.data).hexdigest()


class SeveralNodes(unittest.TestCase):
    """Nodes `one` and `two` answer each image of `camera`, 30 Hz, both commanding the same joint; nobody waits for the
    images of `side`, 50 Hz. The clock goes on when the simulation starts over."""

    def setUp(self):
        self.status = Listener("sim/status", SimStatus)
        self.images = Listener("camera/image_raw", Image)
        self.joints = Listener("joint_states", JointState)
        until_sent_to(self.images.subscriber, self.joints.subscriber)
        for node in ("one", "two"):
            until(lambda node=node: rospy.has_param(node + "/ready"), node + " is up")

    def run_images(self, delay_one_s, delay_two_s):
        """First COUNT images after a reset: (digest, joint positions) of each, stamps."""
        rospy.set_param("one/delay_s", delay_one_s)
        rospy.set_param("two/delay_s", delay_two_s)
        service("sim/pause", Empty)()
        service("sim/reset", Empty)()
        start = self.status.newer(lambda m: m.paused and m.ticks == 0, "a fresh start").header.stamp
        self.joints.messages[:] = []
        self.images.messages[:] = []
        service("sim/unpause", Empty)()

        def first_images():  # images of the time before may still have been under way
            images = [image for image in list(self.images.messages) if image.header.stamp >= start]
            return images[:COUNT] if len(images) >= COUNT else None

        images = until(first_images, "the images")
        service("sim/pause", Empty)()
        until(lambda: {image.header.stamp.to_nsec() for image in images} <= set(self.joints.stamps()), "joint states")
        positions = {message.header.stamp: message.position for message in list(self.joints.messages)}
        stamps = [(image.header.stamp - start).to_nsec() for image in images]
        return [(digest(image), positions[image.header.stamp]) for image in images], stamps, start

    def test_the_order_of_arrival_decides_nothing_and_the_clock_never_goes_back(self):
        late_two, stamps, start = self.run_images(0.0, 0.02)
        late_one, again, restart = self.run_images(0.02, 0.0)
        self.assertEqual(late_two, late_one)
        self.assertNotEqual(late_two[0][1], late_two[-1][1], "the arm moves")
        self.assertEqual(stamps, again)
        self.assertGreater((restart - start).to_nsec(), stamps[-1])

    def test_the_last_name_wins_a_joint_that_both_command(self):
        frames, _, _ = self.run_images(0.0, 0.0)
        self.assertLess(frames[-1][1][1], frames[0][1][1], "pan goes where `two` wants it")

    def test_nobody_waits_for_the_other_camera(self):
        side = Listener("side/image_raw", Image)
        until_sent_to(side.subscriber)
        self.run_images(0.0, 0.0)
        until(lambda: len(side.messages) > COUNT, "more images than the answered camera takes")

    def test_who_is_missing_for_which_image_is_said(self):
        rospy.set_param("one/delay_s", 0.0)
        rospy.set_param("two/delay_s", 3.0)
        service("sim/unpause", Empty)()
        missing = rospy.resolve_name("two")
        status = self.status.newer(lambda m: m.held_by.startswith("an answer"), "holding")
        status = self.status.newer(lambda m: m.held_by.startswith("no answer"), "the report")
        rospy.set_param("two/delay_s", 0.0)
        self.assertIn("from: %s;" % missing, status.held_by)
        self.assertIn("image of camera at", status.held_by)
        service("sim/pause", Empty)()


class Snapshots(unittest.TestCase):
    """A simulator in lockstep with this test."""

    def setUp(self):
        self.status = Listener("sim/status", SimStatus)
        self.images = Listener("camera/image_raw", Image)
        self.publisher = command_publisher()
        until_sent_to(self.images.subscriber)
        service("sim/pause", Empty)()
        service("sim/reset", Empty)()
        self.status.newer(lambda m: m.paused and m.ticks == 0 and not m.lockstep_armed, "a fresh start")
        self.images.messages[:] = []
        self.publisher.publish(command(rospy.Time(0)))
        self.status.newer(lambda m: m.lockstep_armed, "the first command arms the lockstep")
        service("sim/unpause", Empty)()
        self.save, self.restore = service("sim/save_state", SaveState), service("sim/restore_state", RestoreState)

    def answer(self, count, velocity=0.1):
        """Answers the newest image and those after it until `count` more came; status while the last is held."""
        seen = len(self.images.wait())
        for k in range(seen, seen + count):
            self.publisher.publish(command(self.images.messages[k - 1].header.stamp, pan=velocity))
            self.images.wait(k + 1)
        newest = self.images.messages[-1].header.stamp
        return self.status.newer(lambda m: m.holding and m.header.stamp == newest, "holding for the last one")

    def test_restored_run_repeats_image_and_hash_and_the_held_image_is_sent_again(self):
        held = self.answer(3)
        kept = self.save(name="here")
        self.assertTrue(kept.success, kept.message)
        image = self.images.messages[-1]
        first = self.answer(4)
        service("sim/set_target_pose", SetTargetPose)(model="", pose=Pose(orientation=Quaternion(w=1.0)))
        count = len(self.images.messages)
        answer = self.restore(name="here")
        self.assertTrue(answer.success, answer.message)
        self.assertEqual(answer.stamp, held.header.stamp)
        again = self.images.wait(count + 1)[count]
        self.assertEqual((again.header.stamp, digest(again)), (image.header.stamp, digest(image)))
        self.assertEqual(self.answer(4).run_hash, first.run_hash)

    def test_a_file_is_what_the_python_class_saves_and_takes(self):
        controllers = {name: rospy.get_param(name) for name in ("lift_controller", "pan_controller")}
        simulation = Simulation(rospy.get_param("robot_description"), rospy.get_param("sim/sim"), controllers)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "state")
            self.answer(2)
            self.assertTrue(self.save(file=path).success)
            hash_of_node = self.answer(2).run_hash
            with open(path, "rb") as file:
                simulation.restore_state(file.read())
            for _ in range(2):
                simulation.set_command(velocity={"pan": 0.1}, stamp_ns=simulation.time_ns)
                simulation.step_to_image("camera")
                simulation.render("camera")
            self.assertEqual(simulation.run_hash, hash_of_node)
            count = len(self.images.messages)
            self.assertTrue(self.restore(file=path).success)
            self.images.wait(count + 1)
            self.assertEqual(self.answer(2).run_hash, hash_of_node)
            with open(path, "wb") as file:
                file.write(b"no state")
            refused = self.restore(file=path)
            self.assertFalse(refused.success)
            self.assertIn("8 bytes", refused.message)

    def test_faults_are_said(self):
        self.answer(1)
        name = self.save().name
        self.assertTrue(name.startswith("state_"), name)
        self.assertIn(name, self.restore(name="moon").message)
        self.assertIn("one of them", self.restore().message)
        self.assertIn("/no/such", self.save(file="/no/such/folder").message)
        self.assertIn("/no/such", self.restore(file="/no/such/folder").message)
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("found a folder, allowed a regular file", self.save(file=folder).message)
            self.assertIn("found a folder, allowed a regular file", self.restore(file=folder).message)
            pipe = os.path.join(folder, "pipe")
            os.mkfifo(pipe)
            self.assertIn("found a pipe, allowed a regular file", self.restore(file=pipe).message)
        nowhere = service("sim/set_target_pose", SetTargetPose)(model="", pose=Pose())
        self.assertFalse(nowhere.success)
        self.assertIn("orientation has length 0", nowhere.message)
        far = Pose(orientation=Quaternion(w=1.0))
        far.position.x = 1e308
        self.assertIn("allowed <= 10000", service("sim/set_target_pose", SetTargetPose)(model="", pose=far).message)


if __name__ == "__main__":
    case = {kind.__name__: kind for kind in (SeveralNodes, Snapshots)}[sys.argv[1]]
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", case.__name__, case)
