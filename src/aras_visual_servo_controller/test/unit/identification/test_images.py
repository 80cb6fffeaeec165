"""What views of a board tell of an arm with a secret camera, secret joint zeros and late images."""
import dataclasses
from argparse import Namespace

import numpy as np
import pytest

from aras_visual_servo import ParameterError, load_scenario
from aras_visual_servo.spatial import exponential, inverse, transform
from aras_visual_servo_controller.calibration.boards import Board
from aras_visual_servo_controller.calibration.camera import CameraCalibration
from aras_visual_servo_controller.cli.identify import _with_images
from aras_visual_servo_controller.identification.estimates import Estimate, Identified
from aras_visual_servo_controller.identification.images import HAND_EYE, SeenArm, Sightings, identify_images
from aras_visual_servo_controller.identification.recording import Recording

BOARD = Board("chessboard", 4, 5, 0.03)
K = np.array([[400.0, 0.0, 320.0], [0.0, 400.0, 240.0], [0.0, 0.0, 1.0]])
CAMERA = CameraCalibration(640, 480, K, np.zeros(5), 0.1, (), np.full(9, np.nan))
NOISE_PX, DELAY_S, SIZE_M = 0.1, 0.06, 0.0306
FOCUS = np.array([4.0, -3.0, 2.5, -1.5])
X_CC = exponential(np.array([0.006, -0.004, 0.008, 0.01, -0.02, 0.015]))


def seen(moving, seconds=12.0, backlash=None):
    """(recording, sightings, true offsets) of a motion of the joints `moving` of a UR5e, some with a backlash."""
    arm = load_scenario("ur5e")
    kinematics = arm.kinematics()
    rng, home = np.random.default_rng(3), arm.goal_posture(kinematics)
    names = tuple(kinematics.joint_names)
    offsets = np.array([0.02 if name in ("elbow_joint", "wrist_1_joint") else 0.0 for name in names])
    times = np.arange(0.0, seconds, 0.01)
    swing = 0.15 * np.sin(times[:, None] * rng.uniform(1.0, 2.5, len(names)) + rng.uniform(0.0, 6.0, len(names)))
    q = home + swing * np.array([name in moving for name in names])
    X_BO = kinematics.camera(home) @ transform(np.eye(3), np.array([-0.05, -0.05, 0.4]))
    stamps = np.arange(0.7, seconds - 0.1, 0.2)
    half = 0.5 * np.array([(backlash or {}).get(name, 0.0) for name in names])
    link = q.copy()
    for k in range(1, len(q)):
        link[k] = np.minimum(np.maximum(link[k - 1], q[k] - half), q[k] + half)
    at = np.column_stack([np.interp(stamps - DELAY_S, times, column) for column in link.T]) + offsets
    points = BOARD.points_m * (SIZE_M / BOARD.size_m)
    true = CAMERA.intrinsics + np.append(FOCUS, np.zeros(5))
    pixels = np.stack([CAMERA.project(points, inverse(kinematics.camera(row) @ X_CC) @ X_BO, true) for row in at])
    shown = np.all((pixels > 0.0) & (pixels < (640.0, 480.0)), axis=(1, 2))
    stamps, pixels = stamps[shown], pixels[shown]
    return (Recording(names, times, q), Sightings(stamps, pixels + rng.normal(0.0, NOISE_PX, pixels.shape)), kinematics,
            dict(zip((f"{name}.offset" for name in names), offsets)))


def test_delay_zeros_lens_hand_eye_and_size_are_in_their_intervals_and_what_is_one_is_named():
    names = load_scenario("ur5e").kinematics().joint_names
    recording, sightings, kinematics, offsets = seen(names)
    found = identify_images(recording, sightings, BOARD, CAMERA, kinematics)
    turn = np.array([0.01, -0.02, 0.015])
    truth = {"image_delay_s": DELAY_S, "target.size_m": SIZE_M, **offsets,
             **dict(zip(("camera.fx", "camera.fy", "camera.cx", "camera.cy"), K[[0, 1, 0, 1], [0, 1, 2, 2]] + FOCUS)),
             **dict(zip(HAND_EYE, (*X_CC[:3, 3], *turn)))}
    unknown = {each.name: each for each in found.identified.unknown}
    assert set(unknown) == {"shoulder_pan_joint.offset", "wrist_3_joint.offset"}
    assert any(name.startswith("target.") for name in unknown["shoulder_pan_joint.offset"].not_apart_from)
    off = {name: (each.value - truth[name]) / each.stddev for name, each in found.identified.estimates.items()}
    assert set(off) == set(truth) - set(unknown)
    assert max(map(abs, off.values())) < 4.0 and sum(abs(each) < 1.96 for each in off.values()) >= 13, off
    assert found.identified.estimates["image_delay_s"].stddev < 1e-3
    assert found.held_out_px < 1.2 * np.sqrt(2.0) * NOISE_PX
    X_FC = exponential(np.full(6, 0.1))
    np.testing.assert_allclose(found.hand_eye(X_FC)["position_m"], (X_FC @ X_CC)[:3, 3], atol=2e-3)
    assert found.camera.K[0, 0] == pytest.approx(404.0, abs=1.0)


def test_backlash_is_told_where_the_joints_have_it_and_nowhere_else():
    names = load_scenario("ur5e").kinematics().joint_names
    truth = {"shoulder_pan_joint": 0.012, "elbow_joint": 0.004, "wrist_3_joint": 0.02}
    recording, sightings, kinematics, offsets = seen(names, backlash=truth)
    found = identify_images(recording, sightings, BOARD, CAMERA, kinematics)
    told = {name[:-9]: each for name, each in found.identified.estimates.items() if name.endswith(".backlash")}
    assert set(told) == set(truth)
    for name, each in told.items():
        assert abs(each.value - truth[name]) < 4.0 * each.stddev < 2e-3, (name, each)
    assert abs(found.identified.estimates["elbow_joint.offset"].value - 0.02) < 2e-3
    assert found.held_out_px < 1.3 * np.sqrt(2.0) * NOISE_PX


def test_the_overlay_puts_the_camera_where_the_images_have_it():
    arm = load_scenario("ur5e")
    told = {name: Estimate(0.0, 1.0, "") for name in (*HAND_EYE, "image_delay_s")}
    told |= {"image_delay_s": Estimate(0.07, 1e-4, "s"), "elbow_joint.offset": Estimate(0.02, 1e-4, "rad")}
    found = SeenArm(Identified(told, [], {}), 0.1, 0.1, CAMERA, X_CC)
    section = _with_images(Namespace(link="tool0"), arm, {"robot": {"dynamics": {}}}, found)
    assert section["real"] == {"image_delay_s": 0.07} and section["robot"]["dynamics"] == {}
    assert section["robot"]["joint_offsets"] == {"elbow_joint": 0.02}
    q = arm.goal_posture(arm.kinematics())
    there = dataclasses.replace(arm, robot={**arm.robot, "hand_eye": section["robot"]["hand_eye"]}).kinematics()
    np.testing.assert_allclose(there.camera(q), arm.kinematics().camera(q) @ X_CC, atol=1e-9)
    assert "hand_eye" not in _with_images(Namespace(link=None), arm, {"robot": {}}, found)["robot"]


def test_a_motion_of_one_joint_leaves_the_others_open_and_too_few_views_are_refused():
    recording, sightings, kinematics, _ = seen(("wrist_1_joint",), 6.0)
    found = identify_images(recording, sightings, BOARD, CAMERA, kinematics)
    unknown = {each.name for each in found.identified.unknown}
    assert {"elbow_joint.offset", "wrist_1_joint.offset", "target.size_m"} <= unknown
    assert "image_delay_s" in found.identified.estimates and found.held_out_px < 0.5
    few = Sightings(sightings.times_s[:5], sightings.pixels[:5])
    with pytest.raises(ParameterError) as error:
        identify_images(dataclasses.replace(recording, joint_names=("a", "b", "c", "d", "e", "f")), few, BOARD, CAMERA,
                        kinematics)
    assert [fault.split(":")[0] for fault in error.value.faults] == ["joint_names", "images"]
