"""Calibration from exact pixels with noise of a known size: fisheye lenses, cameras that stand still, wrong samples."""

import numpy as np
import pytest
import yaml

from aras_visual_servo_controller.calibration.boards import Board
from aras_visual_servo_controller.calibration.camera import calibrate_camera
from aras_visual_servo_controller.calibration.camera_model import CameraCalibration
from aras_visual_servo_controller.calibration.hand_eye import calibrate_hand_eye
from aras_visual_servo_controller.calibration.target import target_plane
from aras_visual_servo_controller.calibration.samples import joint_faults
from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.spatial import inverse, rotation_angle, rotation_rpy

WIDTH, HEIGHT, NOISE_PX, VIEWS = 640, 480, 0.05, 12
BOARD = Board("chessboard", 8, 5, 0.03)
LENSES = {"plumb_bob": (400.0, [-0.3306, 0.117, 0.0, 0.0, 0.0]), "equidistant": (230.0, [0.02, -0.01, 0.004, -0.001])}


def pose(position_m, rpy_rad):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation_rpy(rpy_rad), position_m
    return X


def true_camera(model="plumb_bob"):
    focal_px, distortion = LENSES[model]
    K = np.array([[focal_px, 0.0, 322.0], [0.0, focal_px + 1.0, 237.0], [0.0, 0.0, 1.0]])
    return CameraCalibration(WIDTH, HEIGHT, K, np.array(distortion), NOISE_PX, (), np.zeros(4 + len(distortion)), model)


def looks(count=VIEWS, seed=1, far_m=0.3):
    """List of X_CO before the camera, tilted in all directions."""
    random, centre = np.random.default_rng(seed), np.eye(4)
    centre[:3, 3] = -BOARD.points_m.mean(axis=0)
    return [pose([*random.uniform(-0.08, 0.08, 2), far_m + random.uniform(-0.08, 0.08)],
                 random.uniform(-0.6, 0.6, 3)) @ centre for _ in range(count)]


def seen(camera, boards, seed=2):
    random = np.random.default_rng(seed)
    return [camera.project(BOARD.points_m, X_CO) + random.normal(0.0, NOISE_PX, (len(BOARD.points_m), 2))
            for X_CO in boards]


#: Camera on its link, and the board in the base.
X_FC, X_BO = pose([0.03, 0.05, 0.08], [0.04, -0.04, 0.4]), pose([0.5, 0.1, 0.2], [3.0, 0.1, 0.3])


def samples(model="plumb_bob"):
    """(poses X_BF of the arm, views) for the two places above."""
    boards = looks()
    return [X_BO @ inverse(X_CO) @ inverse(X_FC) for X_CO in boards], seen(true_camera(model), boards)


def test_a_fisheye_lens_is_found_within_what_is_said():
    camera, boards = true_camera("equidistant"), looks(15, far_m=0.16)
    found = calibrate_camera(seen(camera, boards), BOARD, (WIDTH, HEIGHT), "equidistant")
    assert found.distortion_model == "equidistant" and len(found.view_residuals_px) == 15
    assert found.residual_px == pytest.approx(np.sqrt(2.0) * NOISE_PX, rel=0.1)
    assert (found.stddev > 0.0).all() and (np.abs(found.intrinsics - camera.intrinsics) < 5.0 * found.stddev).all()
    assert found.stddev[0] < 0.5  # of the focal length [px]


def test_the_spread_of_fisheye_intrinsics_is_what_is_said():
    camera, boards = true_camera("equidistant"), looks(15, far_m=0.16)
    found = [calibrate_camera(seen(camera, boards, seed), BOARD, (WIDTH, HEIGHT), "equidistant") for seed in range(12)]
    spread = np.std([each.intrinsics for each in found], axis=0)
    assert np.allclose(spread[:4], np.mean([each.stddev[:4] for each in found], axis=0), rtol=0.7)


def test_a_fisheye_file_is_read_again_as_it_was():
    camera = true_camera("equidistant")
    again = CameraCalibration.from_yaml(camera.as_yaml())
    assert (again.intrinsics == camera.intrinsics).all() and again.distortion_model == "equidistant"
    assert yaml.safe_load(camera.as_yaml())["distortion_coefficients"]["cols"] == 4


@pytest.mark.parametrize("model", LENSES)
def test_a_camera_on_the_arm_is_found_with_each_lens(model):
    poses, views = samples(model)
    found = calibrate_hand_eye(poses, views, BOARD, true_camera(model))
    error = inverse(X_FC) @ found.X_FC
    assert np.linalg.norm(error[:3, 3]) < 5.0 * found.stddev_m < 5e-4
    assert rotation_angle(error[:3, :3]) < 5.0 * found.stddev_rad


def test_a_camera_that_stands_still_is_found_by_inverse_poses():
    """Eye-to-hand: here X_BC = X_BO of the other problem's roles, and the board is on the link."""
    X_BC, X_FO, boards = pose([0.8, 0.2, 0.5], [2.8, 0.2, 1.0]), pose([0.01, 0.02, 0.1], [0.1, 0.2, 0.3]), looks()
    poses = [X_BC @ X_CO @ inverse(X_FO) for X_CO in boards]  # X_BF
    found = calibrate_hand_eye([inverse(X_BF) for X_BF in poses], seen(true_camera(), boards), BOARD, true_camera())
    assert np.linalg.norm((inverse(X_BC) @ found.X_FC)[:3, 3]) < 5.0 * found.stddev_m < 2e-3
    assert np.linalg.norm((inverse(X_FO) @ found.X_BO)[:3, 3]) < 2e-3


def refusal(poses, views):
    with pytest.raises(ParameterError) as caught:
        calibrate_hand_eye(poses, views, BOARD, true_camera(), [f"view_{k}" for k in range(len(views))])
    return str(caught.value)


def test_samples_that_do_not_fit_the_others_are_named():
    poses, views = samples()
    poses[4], poses[9] = poses[4] @ pose([0.02, 0.0, 0.0], [0.0, 0.05, 0.0]), poses[2]
    text = refusal(poses, views)
    assert "view_4" in text and "view_9" in text
    assert not any(f"view_{k} " in text or f"view_{k}," in text for k in range(VIEWS) if k not in (4, 9))


@pytest.mark.parametrize("lag, side", [(1, "1 after"), (-1, "1 before"), (2, "2 after")])
def test_samples_out_of_step_are_told_by_how_much(lag, side):
    poses, views = samples()
    assert side in refusal(poses[lag:] + poses[:lag], views)


def test_mirrored_joints_leave_nothing_that_fits():
    poses, views = samples()
    text = refusal([np.diag([1.0, 1.0, -1.0, 1.0]) @ X @ np.diag([1.0, 1.0, -1.0, 1.0]) for X in poses], views)
    assert "--link" in text


def test_a_target_of_another_board_is_refused():
    view = seen(true_camera(), looks(1))[0]
    assert target_plane(view, BOARD, true_camera()).residual_px < 3.0 * NOISE_PX
    with pytest.raises(ParameterError, match="residual"):
        target_plane(view.reshape(5, 8, 2)[::-1].reshape(-1, 2) * [1.0, 1.3], BOARD, true_camera())


class Arm:
    joint_names, lower, upper = ("turn", "slide"), np.array([-3.2, -np.inf]), np.array([3.2, np.inf])


def test_joints_beyond_their_limits_missing_or_no_numbers_are_named():
    def keys(joints):
        return [fault.split(": ")[1] for fault in joint_faults(Arm, {"image": "a.png", "joints": joints})]
    assert keys({"turn": 3.1, "slide": 1e9}) == []
    assert keys({"turn": 31.0, "slide": "1,5"}) == ["joints.turn", "joints.slide"]
    assert keys({"turn": True}) == ["joints.turn", "joints.slide"]
    assert keys({"turn": float("nan"), "slide": 0.0}) == ["joints.turn"]
