"""Of a real arm: section `real`, the forms of its commands, and where a calibration puts the camera."""

import numpy as np
import pytest
from toy_plant import arm

from aras_visual_servo import (
    kinematics_of, load_scenario, make_form, ModelError, ParameterError, RealSettings, ServoLoop, SetPoint)
from aras_visual_servo.arm.settings import HandEyeSettings
from aras_visual_servo.config.reader import read
from aras_visual_servo.spatial import inverse, pose_from_rpy

#: Products of a dozen rotations: some eps.
ROUNDING = 1e-9
HAND_EYE = {"link": "link6", "position_m": [0.01, -0.02, 0.03], "rpy_rad": [0.1, -0.2, 0.3]}
POINT = SetPoint(5_000_000, ("a", "b"), np.array([1.0, 2.0]), np.array([0.5, -0.5]), False)


def messages(point=POINT, **settings):
    return make_form(RealSettings.from_dict(settings)).messages(point)


def test_positions_and_velocities_for_one_controller():
    (message,) = messages(command="position", controller="/arm")
    assert message == ("/arm/command", "std_msgs/Float64MultiArray", {"data": [1.0, 2.0]})
    assert messages(command="velocity", controller="/arm")[0].fields == {"data": [0.5, -0.5]}


def test_a_controller_for_every_joint():
    found = messages(command="position", controller="", joint_controllers={"b": "/wrist"})
    assert found == [("a_controller/command", "std_msgs/Float64", {"data": 1.0}),
                     ("/wrist/command", "std_msgs/Float64", {"data": 2.0})]


def test_a_trajectory_has_one_point_ahead():
    (message,) = messages(command="trajectory", ahead_s=0.1)
    assert message.topic == "arm_controller/command" and message.kind == "trajectory_msgs/JointTrajectory"
    (point,) = message.fields["points"]
    assert point["positions"] == pytest.approx([1.05, 1.95]) and point["time_from_start_s"] == 0.1
    (point,) = messages(POINT._replace(resting=True))[0].fields["points"]
    assert (point["positions"], point["velocities"]) == ([1.0, 2.0], [0.0, 0.0])


@pytest.mark.parametrize("settings, fault", [
    ({"command": "torque"}, "command: found torque, allowed one of position, trajectory, velocity"),
    ({"command": "trajectory", "controller": ""}, "controller"),
    ({"joint_controllers": {"gantry": "x"}}, "joint_controllers"),
    ({"command_period_s": 0}, "command_period_s: found 0, allowed a finite number > 0"),
    ({"workspace": {"lower_m": [0, 0, 1], "upper_m": [1, 1, 1]}}, "upper_m"),
    ({"joint_speed": {"wheel": 1.0}}, "wheel"),
    ({"speed": 1.0}, "speed"), ({"twist_frame": "tool"}, "twist_frame.*base"), ({"twist_topic": ""}, "twist_topic"),
])
def test_bad_settings_are_named(settings, fault):
    with pytest.raises(ParameterError, match=fault):
        RealSettings.from_dict(settings, arm().joint_names)


def test_settings_that_nobody_has_read_are_checked_too():
    with pytest.raises(ParameterError, match="torque"):
        make_form(RealSettings(command="torque"))


def test_a_joint_is_as_fast_as_the_section_says_and_never_faster_than_its_limit():
    kinematics = arm()
    kinematics.velocity[0] = np.inf
    names = kinematics.joint_names
    found = RealSettings(speed_part=0.1, joint_speed={names[1]: 2.0, names[2]: 9.0}).largest_speed(kinematics)
    np.testing.assert_allclose(found, [np.inf, 2.0, 5.0, 0.5, 0.5, 0.5])
    assert RealSettings(joint_speed={names[0]: 3.0}).largest_speed(kinematics)[0] == 3.0


def flange():
    """Name of the link that carries the camera in the shipped URDF."""
    from xml.etree import ElementTree
    joints = ElementTree.fromstring(load_scenario("experiment_1").urdf_xml()).findall("joint")
    parent = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in joints}
    link = parent["camera_optical_frame"]
    return parent.get(link, link)


def test_the_camera_is_where_the_calibration_has_it_at_every_posture():
    scenario = load_scenario("experiment_1")
    hand_eye = {**HAND_EYE, "link": flange()}
    arm = kinematics_of(scenario.urdf_xml(), {**scenario.robot, "hand_eye": hand_eye})
    to_link = kinematics_of(scenario.urdf_xml(), {**scenario.robot, "tip_link": flange()})
    X_FC = pose_from_rpy(hand_eye["position_m"], hand_eye["rpy_rad"])
    for seed in range(3):
        q = np.random.default_rng(seed).uniform(-0.5, 0.5, len(arm.joint_names))
        assert arm.pose(q) == pytest.approx(to_link.pose(q) @ X_FC, abs=ROUNDING)


def test_the_loop_believes_it_and_the_simulated_camera_stays():
    pytest.importorskip("aras_visual_servo_sim")
    loops = [ServoLoop(load_scenario("experiment_1", overrides)) for overrides in
             ({}, {"robot.hand_eye": {**HAND_EYE, "link": flange()}})]
    q = np.full(6, 0.1)
    poses = [loop.kinematics.pose(q) for loop in loops]
    assert np.linalg.norm((inverse(poses[0]) @ poses[1])[:3, 3]) > 0.01
    for loop in loops:
        loop.step()
    assert (loops[0].camera_pose() == loops[1].camera_pose()).all()


def test_a_link_that_the_urdf_does_not_have_is_named():
    scenario = load_scenario("experiment_1")
    with pytest.raises(ModelError, match="hand_eye.link: found hand"):
        kinematics_of(scenario.urdf_xml(), {**scenario.robot, "hand_eye": {**HAND_EYE, "link": "hand"}})


def test_a_transform_that_is_not_whole_is_refused_with_the_scenario():
    with pytest.raises(ParameterError, match="robot.hand_eye"):
        load_scenario("experiment_1", {"robot.hand_eye": {"link": "link6", "position_m": [0.0, 0.0]}})
    with pytest.raises(ParameterError, match="link"):
        read(HandEyeSettings, {**HAND_EYE, "link": ""}, "robot.hand_eye")
