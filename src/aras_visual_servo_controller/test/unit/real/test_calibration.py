"""Camera, hand-eye and target calibrated from images that the simulator draws, against the truth that it knows."""

import functools
import re
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from board_views import BoardViews, HEIGHT, LENS, WIDTH

import aras_visual_servo as avs
from aras_visual_servo import judge, kinematics_of, load_scenario, ParameterError, robot_kinematics
from aras_visual_servo.cli.main import main
from aras_visual_servo.spatial import inverse, rotation_angle, rotation_rpy, rotation_vector
from aras_visual_servo_controller.calibration.boards import Board
from aras_visual_servo_controller.calibration.camera import calibrate_camera
from aras_visual_servo_controller.calibration.camera_model import CameraCalibration
from aras_visual_servo_controller.calibration.hand_eye import calibrate_hand_eye
from aras_visual_servo_controller.calibration.target import target_plane

BOARDS = {"chessboard": (8, 5, 0.035), "circles": (4, 11, 0.025)}
LINK, VIEWS, Z_STAR_M = "link6", 12, 0.59
#: The detectors' errors are no white noise, of which alone the standard deviations know.
DEVIATIONS = 6.0
#: What noise of one grey level and the detectors leave of a point [px].
POINT_PX = 0.3
HAND_EYE_MM, HAND_EYE_DEG, FOCAL_PX, DEPTH_MM = 1.5, 0.05, 3.0, 3.0


@functools.lru_cache(maxsize=None)
def seen(kind):
    """(board, its views, the pixels found, the camera calibrated from them)."""
    board = Board(kind, *BOARDS[kind])
    with tempfile.TemporaryDirectory() as folder:
        views = BoardViews(board, Path(folder), VIEWS)
    pixels = [board.find(image) for image in views.images]
    return board, views, pixels, calibrate_camera(pixels, board, (WIDTH, HEIGHT))


def truth(views):
    """The true camera as a calibration."""
    K = np.array(views.info["K"], dtype=float).reshape(3, 3)
    return CameraCalibration(WIDTH, HEIGHT, K, np.array(LENS), 0.0, (), np.zeros(9))


def hand_eye(kind):
    """(`HandEye`, true X_FC)."""
    board, views, pixels, camera = seen(kind)
    arm = robot_kinematics(views.scenario.urdf_xml(), "world", LINK)
    poses = [arm.pose(arm.vector(joints)) for joints in views.joints]
    return calibrate_hand_eye(poses, pixels, board, camera), inverse(poses[0]) @ views.cameras[0]


@pytest.mark.parametrize("kind", BOARDS)
def test_the_points_are_found_where_they_are_and_in_their_order(kind):
    board, views, pixels, _ = seen(kind)
    for X_WC, found in zip(views.cameras, pixels):
        error = np.linalg.norm(found - truth(views).project(board.points_m, inverse(X_WC) @ views.X_WO), axis=1)
        assert np.median(error) < 0.5 * POINT_PX and error.max() < 4.0 * POINT_PX


@pytest.mark.parametrize("kind", BOARDS)
def test_the_camera_is_the_true_one_within_what_is_said(kind):
    _, views, _, camera = seen(kind)
    error = np.abs(camera.intrinsics - truth(views).intrinsics)
    assert (error[:2] < FOCAL_PX).all() and (error[:4] < DEVIATIONS * camera.stddev[:4]).all()
    assert 0.0 < camera.residual_px < POINT_PX and len(camera.view_residuals_px) == VIEWS
    cost = camera.cost(Z_STAR_M)
    assert cost["taught goal"] == 0.0
    assert 1e3 * Z_STAR_M * error[0] / camera.K[0, 0] < DEVIATIONS * cost["goal in numbers, depth"]


def test_the_file_is_read_again_as_it_was():
    camera = seen("circles")[3]
    again = CameraCalibration.from_yaml(camera.as_yaml())
    assert (again.intrinsics == camera.intrinsics).all() and (again.stddev == camera.stddev).all()
    content = yaml.safe_load(camera.as_yaml())
    assert content["distortion_model"] == "plumb_bob" and len(content["projection_matrix"]["data"]) == 12


@pytest.mark.parametrize("kind", BOARDS)
def test_the_camera_is_where_it_is_on_the_arm(kind):
    found, X_FC = hand_eye(kind)
    error = inverse(X_FC) @ found.X_FC
    assert 1e3 * np.linalg.norm(error[:3, 3]) < HAND_EYE_MM
    assert np.degrees(rotation_angle(error[:3, :3])) < HAND_EYE_DEG
    assert np.linalg.norm(error[:3, 3]) < DEVIATIONS * found.stddev_m
    assert np.linalg.norm(rotation_vector(error[:3, :3])) < DEVIATIONS * found.stddev_rad


def test_a_camera_that_sits_elsewhere_is_noticed():
    """The check above can fail: poses of another link fit no place of the camera."""
    board, views, pixels, camera = seen("circles")
    arm = robot_kinematics(views.scenario.urdf_xml(), "world", "link5")
    with pytest.raises(ParameterError, match="--link"):
        calibrate_hand_eye([arm.pose(arm.vector(joints)) for joints in views.joints], pixels, board, camera)


@pytest.mark.parametrize("kind", BOARDS)
def test_depth_and_normal_of_the_plane_are_the_true_ones(kind):
    board, views, pixels, camera = seen(kind)
    for k in range(3):
        found = target_plane(pixels[k], board, camera)
        X_CO = inverse(views.cameras[k]) @ views.X_WO
        depth_m = float(X_CO[:3, 2] @ X_CO[:3, 3] / X_CO[2, 2])
        assert abs(found.z_star_m - depth_m) < min(1e-3 * DEPTH_MM, DEVIATIONS * found.stddev_z_m)
        assert found.normal_C[2] > 0.0
        tilt = np.linalg.norm(np.cross(found.normal_C, X_CO[:3, 2]))
        assert tilt < DEVIATIONS * found.stddev_tilt_rad and np.degrees(tilt) < 0.2
        assert found.cost()["taught goal, mm"] == 0.0


def test_the_commands_write_what_the_scenario_reads_and_a_taught_goal_is_reached(tmp_path, capsys):
    import cv2
    board, views, _, _ = seen("circles")
    samples = []
    for k, (image, joints) in enumerate(zip(views.images, views.joints)):
        cv2.imwrite(str(tmp_path / f"{k:02d}.png"), image)
        samples.append({"image": f"{k:02d}.png", "joints": {name: float(q) for name, q in joints.items()}})
    (tmp_path / "samples.yaml").write_text(yaml.safe_dump(samples))
    grid = ["--board", "circles", "--columns", "4", "--rows", "11", "--size-m", "0.025", "--z-star-m", str(Z_STAR_M)]
    camera, hand = str(tmp_path / "camera.yaml"), tmp_path / "hand_eye.yaml"
    images = [str(path) for path in sorted(tmp_path.glob("*.png"))]
    page = tmp_path / "camera.html"
    assert main(["calibrate", "camera", *images, *grid, "--output", camera, "--report", str(page)]) == 0
    told = capsys.readouterr().out
    assert all(f"<td>{image}</td>" in page.read_text() for image in images) and "<td>k3</td>" in page.read_text()
    times = float(re.search(r"the residual is ([\d.]+) times", told)[1])
    assert 0.7 < times < 2.5  # errors of the detector are no white noise
    assert "# residual 0.0" in told and f"over {VIEWS} views" in told and "taught goal: 0" in told
    assert main(["calibrate", "hand_eye", str(tmp_path / "samples.yaml"), *grid, "--camera", camera, "--scenario",
                 "experiment_1", "--link", LINK, "--output", str(hand)]) == 0
    words = [images[0], *grid, "--camera", camera, "--output", str(tmp_path / "t.yaml")]
    assert main(["calibrate", "target", *words]) == 0
    found = yaml.safe_load(hand.read_text())["robot"]["hand_eye"]
    scenario = load_scenario("experiment_1", {"robot.hand_eye": found})
    q = np.zeros(6)
    X = inverse(kinematics_of(scenario.urdf_xml(), load_scenario("experiment_1").robot).pose(q)) @ \
        kinematics_of(scenario.urdf_xml(), scenario.robot).pose(q)
    assert 0.0 < 1e3 * np.linalg.norm(X[:3, 3]) < HAND_EYE_MM
    plane = yaml.safe_load((tmp_path / "t.yaml").read_text())
    assert set(plane) == {"servo", "experiment"}
    z_star_m = plane["experiment"]["z_star_m"]
    assert 0.4 < z_star_m < 0.7
    # What the errors of the calibration cost at a taught goal, tried: nothing that the judge sees.
    assert judge(avs.run(scenario)).passed


@pytest.mark.parametrize("arguments, fault", [
    (("chessboard", 8, 6, 0.03), "half a turn"), (("dots", 8, 5, 0.03), "board: found dots"),
    (("circles", 2, 11, 0.03), "columns, rows"), (("circles", 4, 11, 0.0), "size_m")])
def test_a_board_that_cannot_be_used_is_named(arguments, fault):
    with pytest.raises(ParameterError, match=fault):
        Board(*arguments)


def test_too_few_views_and_turns_about_one_axis_are_refused():
    board, views, pixels, camera = seen("circles")
    with pytest.raises(ParameterError, match="views of the board: found 2"):
        calibrate_camera(pixels[:2], board, (WIDTH, HEIGHT))
    with pytest.raises(ParameterError, match="views of the board: found 3"):
        calibrate_hand_eye([np.eye(4)] * 3, pixels[:3], board, camera)
    with pytest.raises(ParameterError, match="turns about one axis"):
        calibrate_hand_eye([np.eye(4)] * VIEWS, pixels, board, camera)


@pytest.mark.parametrize("arguments, fault", [
    (["camera", "missing.png"], "missing.png: found no image"),
    (["target", "missing.png", "--camera", "missing.yaml"], "missing"),
    (["hand_eye", "samples.yaml"], "--scenario: found nothing"),
    (["camera", "grey.png"], "found the board in none of 1")])
def test_bad_input_of_the_command_is_named(tmp_path, monkeypatch, capsys, arguments, fault):
    import cv2
    monkeypatch.chdir(tmp_path)
    cv2.imwrite("grey.png", np.full((48, 64), 128, dtype=np.uint8))
    assert main(["calibrate", *arguments, "--columns", "8", "--rows", "5", "--size-m", "0.03"]) in (2, 3)
    assert fault in capsys.readouterr().err


def test_a_file_that_is_no_calibration_is_named():
    with pytest.raises(ParameterError, match="mine.yaml: found no calibration"):
        CameraCalibration.from_yaml("{}", "mine.yaml")
    with pytest.raises(ParameterError, match="distortion_model: found equidistant with 5"):
        CameraCalibration.from_yaml(seen("circles")[3].as_yaml().replace("plumb_bob", "equidistant"))


def exact_camera(stddev=None):
    K = np.array([[200.0, 0.0, 160.0], [0.0, 250.0, 120.0], [0.0, 0.0, 1.0]])
    return CameraCalibration(320, 240, K, np.zeros(5), 0.1, (), np.zeros(9) if stddev is None else stddev)


def test_what_the_intrinsics_cost_is_their_part_of_the_depth():
    cost = exact_camera(np.array([2.0, 5.0, 0.4, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0])).cost(0.5)
    assert cost == {"taught goal": 0.0, "goal in numbers, x": pytest.approx(500.0 * 0.4 / 200.0),
                    "goal in numbers, y": pytest.approx(500.0 * 0.5 / 250.0),
                    "goal in numbers, depth": pytest.approx(500.0 * 0.5 * (0.01 + 0.02))}


def test_a_calibration_of_another_program_says_nothing_of_its_errors():
    content = yaml.safe_load(exact_camera().as_yaml())
    del content["calibration"]
    read = CameraCalibration.from_yaml(yaml.safe_dump(content))
    assert read.stddev.shape == (9,) and np.isnan(read.stddev).all() and np.isnan(read.residual_px)
    assert (read.K == exact_camera().K).all()


def test_the_spread_of_depth_and_tilt_is_about_what_is_said():
    """Of one view with pixels that are off by 0.1 px, forty times."""
    board, camera, random = Board("circles", *BOARDS["circles"]), exact_camera(), np.random.default_rng(1)
    X_CO = np.eye(4)
    X_CO[:3, :3] = rotation_rpy((0.4, 0.3, 0.2))
    X_CO[:3, 3] = [-0.05, -0.04, 0.4]
    view = camera.project(board.points_m, X_CO)
    planes = [target_plane(view + random.normal(0.0, 0.1, view.shape), board, camera) for _ in range(40)]
    spread, said = np.std([plane.z_star_m for plane in planes]), np.mean([plane.stddev_z_m for plane in planes])
    assert said == pytest.approx(spread, rel=0.4)
    tilts = [np.linalg.norm(np.cross(plane.normal_C, X_CO[:3, 2])) for plane in planes]
    said = np.mean([plane.stddev_tilt_rad for plane in planes])  # along the worse of two axes
    assert 0.5 * said < np.sqrt(np.mean(np.square(tilts))) < 2.0 * said
