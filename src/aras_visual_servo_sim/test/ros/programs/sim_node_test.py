#!/usr/bin/env python3
"""The simulator node on the wire; run by the .test files beside this one, each naming one class.

Every wait is for a condition, with a limit of wall time.
"""
import os
import subprocess
import sys
import unittest

import cv2
import dynamic_reconfigure.client
import numpy as np
import rospy
import rostest
from aras_visual_servo_msgs.msg import JointControllerState, SimStatus
from aras_visual_servo_msgs.srv import PauseAt, SetJointPositions, SetTargetPose, Step
from aras_visual_servo_sim import Simulation
from geometry_msgs.msg import PoseStamped, TwistStamped
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import CameraInfo, CompressedImage, Image, JointState
from std_msgs.msg import Float64
from std_srvs.srv import Empty

from listening import LIMIT_S, Listener, command, command_publisher, service, until, until_sent_to

NAN = float("nan")
CLOCK_NS = 10_000_000  # period of the clock without images


class Wiring(unittest.TestCase):
    """A free-running simulator, a few times faster than real time."""

    def test_every_topic_of_the_interface_is_there(self):
        expected = ["joint_states", "image_joint_states", "camera/image_raw", "camera/camera_info",
                    "ground_truth/camera_pose", "ground_truth/camera_twist", "ground_truth/target_pose",
                    "ground_truth/target_twist", "sim/status", "pan_controller/state",
                    "scene_markers", "camera_path"]
        expected = {rospy.resolve_name(name) for name in expected} | {"/clock"}
        until(lambda: expected <= {name for name, _ in rospy.get_published_topics()}, "topics " + str(expected))

    def test_image_camera_info_joints_and_truth_carry_the_same_stamp(self):
        others = [Listener("camera/camera_info", CameraInfo), Listener("joint_states", JointState),
                  Listener("ground_truth/camera_pose", PoseStamped), Listener("ground_truth/target_pose", PoseStamped)]
        for other in others:
            other.wait()
        images = Listener("camera/image_raw", Image)
        images.wait(20)
        for other in others:
            until(lambda other=other: set(images.stamps()[:20]) <= set(other.stamps()), "stamps of every image")
        self.assertEqual(images.messages[0].header.frame_id, "eye_optical_frame")
        self.assertEqual(others[0].messages[0].header.frame_id, "eye_optical_frame")
        self.assertEqual(others[1].messages[0].name, ["lift", "pan"])

    def test_image_joint_states_are_the_joint_states_of_the_images_and_no_others(self):
        all_joints, of_images = Listener("joint_states", JointState), Listener("image_joint_states", JointState)
        images = Listener("camera/image_raw", Image)
        all_joints.wait()
        images.wait(), of_images.wait()
        first = max(images.stamps()[0], of_images.stamps()[0], all_joints.stamps()[0])
        until(lambda: images.stamps()[-1] > first + 10**9 < of_images.stamps()[-1], "a second of both")
        last = min(images.stamps()[-1], of_images.stamps()[-1])
        expected = [stamp for stamp in images.stamps() if first <= stamp <= last]
        self.assertEqual([stamp for stamp in of_images.stamps() if first <= stamp <= last], expected)
        until(lambda: all_joints.stamps()[-1] >= last, "all joint states")
        position = {message.header.stamp.to_nsec(): message.position for message in all_joints.messages}
        for message in of_images.messages:
            if first <= message.header.stamp.to_nsec() <= last:
                self.assertEqual(message.position, position[message.header.stamp.to_nsec()])

    def test_images_come_at_their_rate_in_simulated_time(self):
        images = Listener("camera/image_raw", Image)
        images.wait(40)
        stamps_ms = [stamp // 1000000 for stamp in images.stamps()[:40]]
        first = stamps_ms[0] * 30 // 1000
        expected = [-(-(first + k) * 1000 // 30) for k in range(40)]  # k / 30 Hz, rounded up to a tick of 1 ms
        self.assertEqual(stamps_ms, expected)

    def test_compressed_images_are_jpeg_files_of_the_same_stamps(self):
        compressed = Listener("camera/image_raw/compressed", CompressedImage)
        images = Listener("camera/image_raw", Image)
        stamps = until(lambda: set(images.stamps()) & set(compressed.stamps()), "an image both ways")
        image = next(m for m in images.messages if m.header.stamp.to_nsec() in stamps)
        file = next(m for m in compressed.messages if m.header.stamp == image.header.stamp)
        self.assertEqual(file.header.frame_id, "eye_optical_frame")
        self.assertEqual(file.format, "rgb8; jpeg compressed bgr8")
        seen = cv2.imdecode(np.frombuffer(file.data, np.uint8), cv2.IMREAD_COLOR)[:, :, ::-1]
        raw = np.frombuffer(image.data, np.uint8).reshape(seen.shape)
        self.assertLess(np.abs(seen.astype(int) - raw).mean(), 5.0)

    def test_clock_never_runs_backwards_and_is_never_behind_an_image(self):
        clocks = Listener("/clock", Clock)
        clocks.wait()
        images = Listener("camera/image_raw", Image)
        images.wait(20)
        newest = images.stamps()[19]
        until(lambda: clocks.messages[-1].clock.to_nsec() >= newest, "the clock reaches the image")
        times = [message.clock.to_nsec() for message in clocks.messages]
        self.assertEqual(times, sorted(times))
        # rospy's own subscription to the clock keeps one message: a slow process misses some.
        until(lambda: any(message.clock.to_nsec() % CLOCK_NS and message.clock.to_nsec() in images.stamps()
                          for message in list(clocks.messages)), "a clock at an image between two of its own")

    def test_float64_command_moves_its_joint(self):
        states = Listener("joint_states", JointState)
        command_publisher("lift_controller/command", Float64).publish(0.1)
        states.newer(lambda m: m.position[m.name.index("lift")] > 0.08, "the lift goes up")

    def test_nan_command_is_refused_counted_and_the_arm_holds(self):
        status = Listener("sim/status", SimStatus)
        states = Listener("pan_controller/state", JointControllerState)
        refused = status.wait()[-1].refused_commands
        publisher = command_publisher()
        stamp = rospy.Time(0)  # unstamped: as of its arrival
        start = states.wait()[-1].set_point
        publisher.publish(command(stamp, pan=0.1))
        states.newer(lambda m: m.set_point > start + 0.001, "the velocity moves the set-point")
        publisher.publish(command(stamp, pan=NAN))
        last = status.newer(lambda m: m.refused_commands > refused, "the refusal is counted")
        self.assertIn("pan", last.last_refusal)
        held = [states.newer(lambda m: True, "a state").set_point for _ in range(20)]
        self.assertEqual(len(set(held)), 1, held)

    def test_gains_change_through_dynamic_reconfigure(self):
        states = Listener("pan_controller/state", JointControllerState)
        client = dynamic_reconfigure.client.Client("pan_controller/pid", timeout=LIMIT_S)
        self.assertEqual(client.get_configuration()["p"], 20.0)
        client.update_configuration({"p": 30.0})
        state = states.newer(lambda m: m.p == 30.0, "the new gain is used")
        self.assertEqual((state.i, state.d, state.i_clamp), (1.0, 0.5, 5.0))
        client.update_configuration({"p": 20.0})

    def test_target_can_be_placed_and_an_unknown_one_is_refused(self):
        truth = Listener("ground_truth/target_pose", PoseStamped)
        place = service("sim/set_target_pose", SetTargetPose)
        pose = PoseStamped().pose
        pose.position.x, pose.orientation.w = 0.02, 1.0
        self.assertTrue(place(model="", pose=pose).success)
        truth.newer(lambda m: m.pose.position.x == 0.02, "the target is where it was put")
        answer = place(model="moon", pose=pose)
        self.assertFalse(answer.success)
        self.assertIn("target", answer.message)

    def test_twist_of_a_moving_target_is_published(self):
        poses = Listener("ground_truth/target_pose", PoseStamped)
        twists = Listener("ground_truth/target_twist", TwistStamped)
        twists.wait()
        self.assertEqual(twists.messages[0].header.frame_id, "world")
        self.assertEqual(twists.messages[0].twist.linear.x, 0.0)
        until(lambda: set(twists.stamps()) & set(poses.stamps()), "both of one image")

    def test_pause_stops_time_step_moves_it_and_reset_starts_again(self):
        status = Listener("sim/status", SimStatus)
        pause, unpause = service("sim/pause", Empty), service("sim/unpause", Empty)
        step = service("sim/step", Step)
        until(lambda: status.messages and status.messages[-1].ticks > 100, "time goes by")
        self.assertFalse(step(steps=5).success, "stepping is for a paused simulator")
        pause()
        before = step(steps=0).stamp
        self.assertEqual((step(steps=50).stamp - before).to_nsec(), 50000000)
        ticks = status.newer(lambda m: m.paused, "a status of the paused simulator").ticks
        self.assertEqual(status.newer(lambda m: m.paused, "another one").ticks, ticks)
        place = service("sim/set_joint_positions", SetJointPositions)
        self.assertTrue(place(name=["lift"], position=[-0.1]).success)
        self.assertFalse(place(name=["lift"], position=[NAN]).success)
        service("sim/reset", Empty)()
        fresh = status.newer(lambda m: m.ticks == 0, "the reset")
        self.assertEqual((fresh.frames, fresh.refused_commands, fresh.paused), (0, 0, True))
        self.assertEqual(step(steps=0).stamp.to_nsec(), 0)
        unpause()
        status.newer(lambda m: m.ticks > 0, "time goes by again")

    def test_pause_at_stops_the_simulator_at_exactly_that_tick(self):
        status = Listener("sim/status", SimStatus)
        pause, unpause, pause_at = service("sim/pause", Empty), service("sim/unpause", Empty), service("sim/pause_at",
                                                                                                       PauseAt)
        now = status.newer(lambda m: m.ticks > 0, "time goes by").header.stamp
        refusal = pause_at(now - rospy.Duration(0, 1000000))
        self.assertFalse(refusal.success)
        self.assertIn("allowed the time of now", refusal.message)
        pause()
        now = service("sim/step", Step)(steps=0).stamp
        for steps in (1, 777):
            now += rospy.Duration(0, steps * 1000000)
            self.assertTrue(pause_at(now).success)
            unpause()
            stopped = status.newer(lambda m: m.paused and m.header.stamp >= now, "the pause")
            self.assertEqual(stopped.header.stamp, now)
        self.assertTrue(pause_at(now + rospy.Duration(1)).success)
        service("sim/reset", Empty)()
        unpause()
        status.newer(lambda m: m.ticks > 1000 + now.to_nsec() // 1000000, "a pause of the time before the reset")


class Lockstep(unittest.TestCase):
    """A simulator that starts paused and waits for an answer to each image."""

    def setUp(self):
        self.status = Listener("sim/status", SimStatus)
        self.images = Listener("camera/image_raw", Image)
        self.publisher = command_publisher()
        until_sent_to(self.images.subscriber)
        service("sim/pause", Empty)()
        service("sim/reset", Empty)()
        self.status.newer(lambda m: m.paused and m.ticks == 0 and not m.lockstep_armed, "a fresh start")
        del self.images.messages[:]
        self.publisher.publish(command(rospy.Time(0)))
        self.status.newer(lambda m: m.lockstep_armed, "the first command arms the lockstep")

    def run_images(self, count):
        """Unpauses, answers `count` images, each with a velocity, and leaves the next one unanswered."""
        service("sim/unpause", Empty)()
        for k in range(count):
            stamp = self.images.wait(k + 1)[k].header.stamp
            self.publisher.publish(command(stamp, pan=0.1))
        self.images.wait(count + 1)
        return self.status.newer(lambda m: m.holding, "holding for the last one")

    def test_first_image_is_at_time_zero_and_nothing_moves_until_it_is_answered(self):
        status = self.run_images(0)
        self.assertEqual((status.ticks, status.frames), (0, 1))
        self.assertEqual(self.status.newer(lambda m: m.holding, "still holding").ticks, 0)
        self.assertEqual(len(self.images.messages), 1)

    def test_an_older_stamp_does_not_release_the_image_and_its_own_does(self):
        self.run_images(1)
        self.assertEqual(self.images.stamps(), [0, 34000000])
        self.publisher.publish(command(rospy.Time(0, 33000000)))
        self.assertEqual(self.status.newer(lambda m: m.holding, "still holding").ticks, 34)
        self.publisher.publish(command(rospy.Time(0, 34000000)))
        self.assertEqual(self.images.wait(3)[2].header.stamp.to_nsec(), 67000000)

    def test_same_answers_give_the_same_hash(self):
        first = self.run_images(10)
        self.setUp()
        second = self.run_images(10)
        self.assertEqual(first.run_hash, second.run_hash)
        self.assertEqual((first.ticks, first.frames), (second.ticks, second.frames))

    def test_an_answer_that_a_reset_has_overtaken_is_dropped_and_one_of_the_future_is_refused(self):
        before = self.run_images(3).header.stamp
        service("sim/pause", Empty)()
        service("sim/reset", Empty)()
        self.status.newer(lambda m: m.paused and m.ticks == 0 and not m.lockstep_armed, "a fresh start")
        del self.images.messages[:]
        self.publisher.publish(command(before, pan=0.1))
        for _ in range(3):  # it comes after what was sent before it
            status = self.status.newer(lambda m: True, "a status")
        self.assertFalse(status.lockstep_armed, "an answer of the time that is gone")
        self.publisher.publish(command(rospy.Time(0)))
        armed = self.status.newer(lambda m: m.lockstep_armed, "the first command of the new time")
        self.assertEqual(armed.refused_commands, 0, armed.last_refusal)
        self.run_images(2)
        self.publisher.publish(command(before, pan=0.1))
        refused = self.status.newer(lambda m: m.refused_commands > 0, "a command of the future")
        self.assertIn("in the future", refused.last_refusal)

    def test_hash_is_that_of_the_same_run_in_process(self):
        controllers = {name: rospy.get_param(name) for name in ("lift_controller", "pan_controller")}
        simulation = Simulation(rospy.get_param("robot_description"), rospy.get_param("sim/sim"), controllers)
        for _ in range(11):
            stamp_ns = simulation.step_to_image("camera")
            simulation.render("camera")
            expected = simulation.run_hash
            simulation.set_command(velocity={"pan": 0.1}, stamp_ns=stamp_ns)
        self.assertEqual(self.run_images(10).run_hash, expected)

    def test_after_the_timeout_it_says_who_did_not_answer(self):
        self.run_images(0)
        status = self.status.newer(lambda m: "no answer" in m.held_by, "the report")
        self.assertIn(rospy.get_name(), status.held_by)
        self.assertTrue(status.holding)

    def test_services_answer_and_the_clock_is_repeated_while_it_holds(self):
        self.run_images(0)
        clocks = Listener("/clock", Clock)
        self.assertEqual(clocks.wait(3)[-1].clock.to_nsec(), 0)
        self.assertTrue(service("sim/set_joint_positions", SetJointPositions)(name=["lift"], position=[0.05]).success)


class Refusal(unittest.TestCase):
    """What stops the start-up. Each node runs in its own namespace with one thing wrong."""

    def refused(self, namespace, *words):
        process = subprocess.run(["rosrun", "aras_visual_servo_sim", "sim_node", "__ns:=" + namespace, *words],
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S, check=False,
                                 env=dict(os.environ, ROSCONSOLE_STDOUT_LINE_BUFFERED="1"))
        self.assertNotEqual(process.returncode, 0)
        return process.stdout.decode()

    def test_bad_urdf_names_joint_and_value(self):
        rospy.set_param("/bad_urdf/robot_description",
                        "<robot name='r'><link name='a'/><link name='b'/><joint name='elbow' type='revolute'>"
                        "<parent link='a'/><child link='b'/><limit lower='1' upper='-1' effort='1' velocity='1'/>"
                        "</joint></robot>")
        self.assertIn("elbow", self.refused("bad_urdf"))

    def start(self, *words):
        """A simulator in the background, which is killed at the end of the test."""
        process = subprocess.Popen(["rosrun", "aras_visual_servo_sim", "sim_node", *words])
        self.addCleanup(process.wait, LIMIT_S)
        self.addCleanup(process.kill)
        return process

    def robot_in(self, namespace):
        """Sets the parameters of a simulator, as sim.launch does."""
        for name in ("robot_description", "lift_controller", "pan_controller"):
            rospy.set_param("/%s/%s" % (namespace, name), rospy.get_param("standing/" + name))
        rospy.set_param("/%s/sim" % namespace, rospy.get_param("standing/sim"))

    def test_a_nodelet_that_there_is_not_is_named(self):
        self.robot_in("nodelets")
        rospy.set_param("/nodelets/sim/nodelets", {"eye": "nowhere/Nothing"})
        output = self.refused("nodelets", "/clock:=/nodelets/clock")
        self.assertIn("nodelets/eye: found 'nowhere/Nothing'", output)

    def test_a_simulator_started_again_takes_over_the_parameters_of_the_first(self):
        self.robot_in("again")
        for _ in range(2):
            process = self.start("__ns:=again", "/clock:=/again/clock")
            status = Listener("/again/sim/status", SimStatus)
            status.wait()
            self.assertTrue(rospy.has_param("/again/sim/segmentation_ids"))
            process.kill()
            process.wait(LIMIT_S)
            status.subscriber.unregister()

    def test_a_second_simulator_of_the_same_name_is_refused_and_the_first_lives_on(self):
        self.robot_in("taken")
        process = self.start("__ns:=taken", "/clock:=/taken/clock")
        status = Listener("/taken/sim/status", SimStatus)
        status.wait()
        message = self.refused("taken")
        self.assertIn("node '/taken/sim': runs already", message)
        seen = len(status.messages)
        status.wait(seen + 3)
        self.assertIsNone(process.poll())

    def test_a_second_publisher_of_a_clock_is_refused_by_the_name_of_the_first(self):
        for namespace in ("clock_first", "clock_second"):
            self.robot_in(namespace)
        self.start("__ns:=clock_first", "/clock:=/one/clock")
        Listener("/clock_first/sim/status", SimStatus).wait()
        message = self.refused("clock_second", "/clock:=/one/clock")
        self.assertIn("/one/clock: node '/clock_first/sim' publishes it already", message)

    def test_missing_robot_is_said(self):
        self.assertIn("robot_description", self.refused("no_robot"))

    def test_all_bad_parameters_are_listed_at_once(self):
        rospy.set_param("/bad_yaml/robot_description", rospy.get_param("robot_description"))
        rospy.set_param("/bad_yaml/sim", {"sim": {"period_s": -1.0, "colour": "red"}, "time": {"lockstp": True},
                                          "tim": {}})
        rospy.set_param("/bad_yaml/odd", {"type": "effort_controllers/JointPositionController", "joint": "nose"})
        message = self.refused("bad_yaml")
        for fault in ("period_s", "colour", "lockstp", "~tim", "nose"):
            self.assertIn(fault, message)


class TwoNamespaces(unittest.TestCase):
    """`left` runs, `right` starts paused; each has its own clock."""

    def test_each_simulator_has_its_own_time_and_commands(self):
        clocks = {side: Listener("/%s/clock" % side, Clock) for side in ("left", "right")}
        joints = {side: Listener("/%s/joint_states" % side, JointState) for side in ("left", "right")}
        command_publisher("/left/lift_controller/command", Float64).publish(0.1)
        joints["left"].newer(lambda m: m.position[0] > 0.08, "the left lift goes up")
        clocks["right"].wait(3)
        self.assertEqual({message.clock.to_nsec() for message in clocks["right"].messages}, {0})
        self.assertGreater(clocks["left"].messages[-1].clock.to_nsec(), 0)
        service("/right/sim/unpause", Empty)()
        height = joints["right"].newer(lambda m: m.header.stamp.to_sec() > 0.5, "the right one runs").position[0]
        self.assertLess(height, 0.01, "the left one's command is not for it")
        self.assertNotIn("/clock", [name for name, _ in rospy.get_published_topics()])


if __name__ == "__main__":
    case = {kind.__name__: kind for kind in (Wiring, Lockstep, Refusal, TwoNamespaces)}[sys.argv[1]]
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", case.__name__, case)
