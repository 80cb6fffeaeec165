"""The scenario says where a calibration found the camera: the kinematics end there, the simulated camera stays."""

import numpy as np
import pytest

from aras_visual_servo import kinematics_of, load_scenario, ModelError, ParameterError, ServoLoop
from aras_visual_servo.spatial import inverse, pose_from_rpy

#: Products of a dozen rotations: some eps.
ROUNDING = 1e-9
HAND_EYE = {"link": "link6", "position_m": [0.01, -0.02, 0.03], "rpy_rad": [0.1, -0.2, 0.3]}


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


def test_without_it_the_urdf_counts():
    scenario = load_scenario("experiment_1")
    q = np.full(6, 0.1)
    assert (kinematics_of(scenario.urdf_xml(), scenario.robot).pose(q) == ServoLoop(scenario).kinematics.pose(q)).all()


def test_the_loop_believes_it_and_the_simulated_camera_stays():
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
