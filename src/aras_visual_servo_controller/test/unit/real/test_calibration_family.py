"""The family of calibrations: residuals against noise, wide lenses, joint offsets, too little motion."""

import numpy as np
import pytest

from aras_visual_servo import ParameterError, load_scenario, robot_kinematics
from aras_visual_servo.spatial import inverse
from aras_visual_servo_controller.calibration.boards import Board
from aras_visual_servo_controller.calibration.camera import calibrate_camera
from aras_visual_servo_controller.calibration.camera_model import CameraCalibration
from aras_visual_servo_controller.calibration.family import (CALIBRATIONS, Calibrated, check_residuals,
                                                             point_noise_px)
from aras_visual_servo_controller.calibration.hand_eye import calibrate_hand_eye
from aras_visual_servo_controller.calibration.joint_offsets import calibrate_joint_offsets
from aras_visual_servo_controller.calibration.target import target_plane
from test_calibration_samples import BOARD, HEIGHT, NOISE_PX, WIDTH, X_FC, looks, pose, seen, true_camera

RATIONAL = np.array([0.9, 0.2, 0.0004, -0.0003, 0.02, 1.5, 0.5, 0.1])
ARM, LINK = "ur5e", "tool0"


def rational_camera():
    K = np.array([[330.0, 0.0, 322.0], [0.0, 331.0, 237.0], [0.0, 0.0, 1.0]])
    return CameraCalibration(WIDTH, HEIGHT, K, RATIONAL, NOISE_PX, (), np.zeros(12), "rational_polynomial")


def result(views, residual_px, parameters):
    return Calibrated({}, (), tuple("abc"), residual_px, (residual_px,) * len(views), parameters, views)


def test_the_family_has_a_calibration_in_each_file():
    assert list(CALIBRATIONS) == ["camera", "eye_to_hand", "hand_eye", "joint_offsets", "target"]
    assert all(each.about and each.files for each in CALIBRATIONS.values())


@pytest.mark.parametrize("camera", [true_camera(), true_camera("equidistant"), rational_camera()],
                         ids=lambda camera: camera.distortion_model)
def test_the_noise_of_the_points_is_told_without_the_camera(camera):
    views = seen(camera, looks(far_m=0.2 if camera.distortion_model == "equidistant" else 0.3))
    assert 0.9 * NOISE_PX < point_noise_px(views, BOARD) < 1.3 * NOISE_PX
    small = Board("chessboard", 3, 4, 0.03)
    assert np.isnan(point_noise_px([], BOARD)) and np.isfinite(point_noise_px([small.points_m[:, :2] * 1e3], small))


def test_a_wide_lens_needs_its_model_and_the_residual_says_so():
    views = seen(rational_camera(), looks(16, far_m=0.2))
    checks = {}
    for model, count in (("rational_polynomial", 12), ("plumb_bob", 9)):
        found = calibrate_camera(views, BOARD, (WIDTH, HEIGHT), model)
        assert len(found.intrinsics) == len(found.stddev) == count and found.distortion_model == model
        checks[model] = check_residuals(result(views, found.residual_px, count + 6 * 16), BOARD)
        again = CameraCalibration.from_yaml(found.as_yaml())
        assert (again.intrinsics == found.intrinsics).all() and again.distortion_model == model
        if model == "rational_polynomial":
            assert np.abs(found.K - rational_camera().K).max() < 5.0 * found.stddev[:4].max()
    assert 0.75 < checks["rational_polynomial"].times < 1.1
    assert checks["rational_polynomial"].fits and checks["plumb_bob"].fits is False


def arm_samples(offsets, count=16, still=()):
    """(arm, reported joints, views) of an arm whose joints are off by `offsets`; the board rests before it."""
    arm, random = robot_kinematics(load_scenario(ARM).urdf_xml(), "world", LINK), np.random.default_rng(5)
    scenario = load_scenario(ARM)
    home = scenario.goal_posture(arm)
    X_BO = arm.pose(home + offsets) @ X_FC @ pose([0.0, 0.0, 0.35], [0.05, 0.1, 0.2])
    centre = np.eye(4)
    centre[:3, 3] = -BOARD.points_m.mean(axis=0)
    X_BO = X_BO @ centre
    joints, boards = [], []
    while len(joints) < count:
        move = random.uniform(-0.5, 0.5, len(home))
        move[[arm.joint_names.index(name) for name in still]] = 0.0
        X_CO = inverse(arm.pose(home + move + offsets) @ X_FC) @ X_BO
        pixels = true_camera().project(BOARD.points_m, X_CO)
        if X_CO[2, 3] > 0.1 and X_CO[2, 2] > 0.4 and (pixels > 0).all() and (pixels < [WIDTH, HEIGHT]).all():
            joints.append(home + move)
            boards.append(X_CO)
    return arm, np.array(joints), seen(true_camera(), boards)


def test_joint_offsets_are_found_with_the_camera_and_the_first_and_last_are_not_told():
    arm = robot_kinematics(load_scenario(ARM).urdf_xml(), "world", LINK)
    truth = dict(shoulder_lift_joint=0.02, elbow_joint=-0.03, wrist_1_joint=0.015, wrist_2_joint=-0.01)
    arm, joints, views = arm_samples(arm.vector({**dict.fromkeys(arm.joint_names, 0.0), **truth}))
    without = calibrate_hand_eye([arm.pose(q) for q in joints], views, BOARD, true_camera())
    assert check_residuals(result(views, without.residual_px, 12), BOARD).fits is False
    found = calibrate_joint_offsets(arm, joints, views, BOARD, true_camera())
    assert set(found.unknown) == {"shoulder_pan_joint", "wrist_3_joint"} and set(found.offsets) == set(truth)
    for name, (value, stddev) in found.offsets.items():
        assert abs(value - truth[name]) < 5.0 * stddev < 5e-3, name
    error = inverse(X_FC) @ found.hand_eye.X_FC
    assert np.linalg.norm(error[:3, 3]) < 5.0 * found.hand_eye.stddev_m < 5e-3
    check = check_residuals(result(views, found.hand_eye.residual_px, 16), BOARD)
    assert check.fits and check.times == pytest.approx(1.0, abs=0.15)


def test_too_little_motion_is_named():
    arm = robot_kinematics(load_scenario(ARM).urdf_xml(), "world", LINK)
    arm, joints, views = arm_samples(np.zeros(6), still=("elbow_joint", "wrist_1_joint"))
    with pytest.raises(ParameterError) as error:
        calibrate_joint_offsets(arm, joints, views, BOARD, true_camera())
    assert [fault.split(":")[0] for fault in error.value.faults] == ["elbow_joint", "wrist_1_joint"]
    random = np.random.default_rng(3)
    flat = [pose([*random.uniform(-0.05, 0.05, 2), 0.4], [0.0, 0.0, random.uniform(-1.0, 1.0)]) for _ in range(8)]
    with pytest.raises(ParameterError, match="tilt the board more"):
        calibrate_camera(seen(true_camera(), flat), BOARD, (WIDTH, HEIGHT))
    far = pose([0.0, 0.0, 60.0], [0.3, 0.2, 0.0])
    with pytest.raises(ParameterError, match="larger board"):
        target_plane(seen(true_camera(), [far])[0], BOARD, true_camera())
