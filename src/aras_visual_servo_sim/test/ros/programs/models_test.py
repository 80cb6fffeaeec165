#!/usr/bin/env python3
"""Models that come, go and move by service; run by models.test."""
import unittest

import rospy
import rostest
import yaml
from aras_visual_servo_msgs.srv import (DeleteLight, DeleteModel, GetLights, GetModelState, SetLight, SetModelMotion,
                                        SetModelState, SpawnModel, Step)
from geometry_msgs.msg import Point, Pose, PoseStamped, Quaternion, Twist, TwistStamped, Vector3
from std_srvs.srv import Empty
from visualization_msgs.msg import Marker, MarkerArray

from listening import Listener, service, until, until_sent_to

TABLE = """<robot name="table"><link name="top"><visual><geometry><box size="0.2 0.1 0.02"/></geometry></visual></link>
  <link name="leg"><visual><geometry><cylinder radius="0.01" length="0.1"/></geometry></visual></link>
  <joint name="j" type="fixed"><parent link="top"/><child link="leg"/><origin xyz="0 0 -0.06"/></joint></robot>"""


def pose(x=0.0, y=0.0, z=0.0):
    return Pose(Point(x, y, z), Quaternion(w=1.0))


class Models(unittest.TestCase):
    """A simulator that stays paused: time passes by sim/step."""

    def setUp(self):
        self.spawn, self.delete = service("sim/spawn_model", SpawnModel), service("sim/delete_model", DeleteModel)
        self.place = service("sim/set_model_pose", SetModelState)
        self.state = service("sim/get_model_state", GetModelState)
        self.move, self.step = service("sim/set_model_motion", SetModelMotion), service("sim/step", Step)
        service("sim/reset", Empty)()

    def test_models_are_spawned_found_and_deleted(self):
        for name, description in (("table", TABLE), ("ball", "sphere_m: 0.02"),
                                  ("sheet", "package://aras_description/targets/rectangle.yaml")):
            answer = self.spawn(model_name=name, model_xml=description, initial_pose=pose(0.1, 0.0, 0.05))
            self.assertTrue(answer.success, answer.status_message)
            self.assertEqual(self.state(model_name=name).pose, pose(0.1, 0.0, 0.05))
        twice = self.spawn(model_name="ball", model_xml="sphere_m: 0.02", initial_pose=pose())
        self.assertFalse(twice.success)
        self.assertIn("ball", twice.status_message)
        self.assertTrue(self.delete(model_name="ball").success)
        gone = self.delete(model_name="ball")
        self.assertFalse(gone.success)
        for name in ("table", "sheet", "target"):
            self.assertIn(name, gone.status_message)
        service("sim/reset", Empty)()
        self.assertFalse(self.state(model_name="table").success, "a reset brings back what was configured")

    def test_faults_of_a_description_are_answered(self):
        for description, fault in (("sphere_m: -1", "sphere_m"), ("no/such.stl", "no/such.stl"), ("", "empty"),
                                   ("<robot", "ball")):
            answer = self.spawn(model_name="ball", model_xml=description, initial_pose=pose())
            self.assertFalse(answer.success)
            self.assertIn(fault, answer.status_message)
        self.assertIn("moon", self.place(model_name="target", pose=pose(), reference_frame="moon").status_message)
        self.assertIn("dance", self.move(model_name="target", motion="{type: dance}").status_message)
        self.assertFalse(self.move(model_name="target", motion="{").success)

    def test_lights_are_set_listed_and_deleted(self):
        light, delete, lights = (service("sim/set_light", SetLight), service("sim/delete_light", DeleteLight),
                                 service("sim/get_lights", GetLights))
        self.assertEqual(lights().name, [])
        sdf = "<light name='lamp' type='point'><pose>0 0 2 0 0 0</pose><diffuse>0.2 0.4 0.6 1</diffuse></light>"
        for text in (sdf, "{name: torch, type: spot, attached_to: head, direction: [0, 0, -1]}"):
            answer = light(light=text)
            self.assertTrue(answer.success, answer.message)
        listed = lights()
        self.assertEqual(listed.name, ["lamp", "torch"])
        self.assertEqual(yaml.safe_load(listed.light[0])["position_m"], [0, 0, 2])
        self.assertEqual(yaml.safe_load(listed.light[1])["attached_to"], "head")
        self.assertTrue(light(light=listed.light[0]).success)
        self.assertEqual(lights().light, listed.light, "what is listed can be set")
        for text, fault in (("{name: torch, type: spot, attached_to: nowhere, direction: [0, 0, -1]}", "nowhere"),
                            ("{name: sun, type: directional}", "direction"), ("<light", "light"), ("", "empty")):
            answer = light(light=text)
            self.assertFalse(answer.success)
            self.assertIn(fault, answer.message)
        self.assertTrue(delete(name="lamp").success)
        self.assertIn("lights: torch", delete(name="lamp").message)
        service("sim/reset", Empty)()
        self.assertEqual(lights().name, [])

    def test_what_would_stall_the_simulator_is_refused_at_once(self):
        chain = "<robot name='chain'><link name='l0'/>" + "".join(
            "<link name='l%d'/><joint name='j%d' type='fixed'><parent link='l%d'/><child link='l%d'/></joint>"
            % (k, k, k - 1, k) for k in range(1, 20001)) + "</robot>"
        numbers = "outlines_m: [[" + ", ".join("[%d, 1]" % k for k in range(500000)) + "]]"
        for description, fault in ((chain, "found 20001 links, allowed <= 1000"), (numbers, "bytes of YAML, allowed"),
                                   ("box_m: " + "[" * 30000, "ball"),
                                   ("box_m: &a [*a]", "deep, allowed <= 64")):
            answer = self.spawn(model_name="ball", model_xml=description, initial_pose=pose())
            self.assertFalse(answer.success)
            self.assertIn(fault, answer.status_message)
        answer = self.move(model_name="target", motion="{type: waypoints, waypoints: " + "[" * 200000)
        self.assertIn("bytes of YAML, allowed <= 131072", answer.status_message)

    def test_a_pose_may_be_relative_to_a_link_and_a_twist_goes_on(self):
        answer = self.place(model_name="target", pose=pose(0.0, 0.0, 0.3), reference_frame="eye_optical_frame",
                            twist=Twist(linear=Vector3(0.1, 0.0, 0.0)))
        self.assertTrue(answer.success, answer.status_message)
        self.assertAlmostEqual(self.state(model_name="target").pose.position.z, 0.2, delta=0.01)
        self.step(steps=500)
        moved = self.state(model_name="target")
        self.assertAlmostEqual(moved.pose.position.x, 0.05, delta=1e-9)
        self.assertEqual(moved.twist.linear.x, 0.1)
        self.assertEqual(moved.header.stamp.to_nsec(), 500000000)

    def test_a_motion_moves_truth_and_its_twist_and_ends(self):
        truth = Listener("ground_truth/target_pose", PoseStamped)
        twists = Listener("ground_truth/target_twist", TwistStamped)
        until_sent_to(truth.subscriber, twists.subscriber)
        motion = "{type: constant_velocity, linear_m_per_s: [0, 0.2, 0]}"
        self.assertTrue(self.move(model_name="target", motion=motion).success)
        self.step(steps=100)
        until(lambda: truth.messages and truth.messages[-1].header.stamp.to_nsec() == 100000000, "the image at 0.1 s")
        self.assertAlmostEqual(truth.messages[-1].pose.position.y, 0.02, delta=1e-9)
        until(lambda: twists.messages and twists.messages[-1].header.stamp.to_nsec() == 100000000, "its twist")
        self.assertEqual(twists.messages[-1].twist.linear.y, 0.2)
        self.assertTrue(self.move(model_name="target", motion="").success)
        self.assertEqual(self.state(model_name="target").twist.linear.y, 0.0)

    def test_markers_follow(self):
        markers = Listener("scene_markers", MarkerArray)
        markers.wait()
        self.assertTrue(self.spawn(model_name="sheet", model_xml="package://aras_description/targets/rectangle.yaml",
                                   initial_pose=pose()).success)
        until(lambda: "sheet" in {marker.ns for marker in markers.messages[-1].markers}, "the sheet is drawn")
        self.assertTrue(self.delete(model_name="sheet").success)
        until(lambda: "sheet" not in {marker.ns for marker in markers.messages[-1].markers}, "the sheet is gone")

    def test_solids_are_drawn_where_they_are_and_go_when_they_are_deleted(self):
        markers = Listener("scene_markers", MarkerArray)
        markers.wait()

        def drawn(name):
            return [marker for marker in markers.messages[-1].markers if marker.ns == name]

        for name, description, shapes in (("ball", "sphere_m: 0.02", 1), ("crate", "box_m: [0.1, 0.2, 0.3]", 1),
                                          ("drum", "cylinder_m: [0.1, 0.2]", 1), ("table", TABLE, 2)):
            answer = self.spawn(model_name=name, model_xml=description, initial_pose=pose(0.1, 0.0, 0.05))
            self.assertTrue(answer.success, answer.status_message)
            until(lambda name=name: drawn(name), name + " is drawn")
            self.assertEqual(len(drawn(name)), shapes)
            for marker in drawn(name):
                self.assertEqual((marker.header.frame_id, marker.type), ("world", Marker.TRIANGLE_LIST))
                self.assertEqual(len(marker.points) % 3, 0)
            self.assertEqual(drawn(name)[0].pose.position.x, 0.1)
        corners = {(round(p.x, 6), round(p.y, 6), round(p.z, 6)) for p in drawn("crate")[0].points}
        self.assertEqual(corners, {(x, y, z) for x in (-0.05, 0.05) for y in (-0.1, 0.1) for z in (-0.15, 0.15)})
        motion = "{type: constant_velocity, linear_m_per_s: [0, 0.2, 0]}"
        self.assertTrue(self.move(model_name="ball", motion=motion).success)
        self.step(steps=500)
        until(lambda: abs(drawn("ball")[0].pose.position.y - 0.1) < 1e-9, "the ball is drawn where it went")
        self.assertTrue(self.delete(model_name="ball").success)
        until(lambda: not drawn("ball"), "the ball is gone")
        self.assertTrue(drawn("table"))
        self.assertFalse(drawn("base"), "links of the robot are no markers")


if __name__ == "__main__":
    rospy.init_node("tester", anonymous=True)
    rostest.rosrun("aras_visual_servo_sim", "Models", Models)
