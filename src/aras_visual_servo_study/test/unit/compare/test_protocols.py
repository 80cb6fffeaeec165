"""Published protocols: starts as published, our own boards, the table, and a benchmark that is gone on with."""

from types import SimpleNamespace

import numpy as np
import pytest

from aras_visual_servo import load_scenario, ParameterError
from aras_visual_servo.spatial import rotation_angle, rotation_vector
from aras_visual_servo_study.compare.protocols import (
    board as boards, Case, cns_affine, known_protocols, Protocol, protocol_named, runner, vit_vs)
from aras_visual_servo_study.compare.protocols.base import spread
from aras_visual_servo_study.sweep.engine import open_sweep
from aras_visual_servo_study.sweep.statistics import wilson

#: The publication gives means and deviations with two digits.
PUBLISHED_DIGITS = 0.005
#: X_WCg of `vit_vs`: 0.6 m above the board, the optical axis down.
GOAL_POSE = np.array([[0.0, -1.0, 0.0, 0.0], [-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.61], [0.0, 0.0, 0.0, 1.0]])


def row(number, won, **more):
    return {"id": number, "outcome": "success" if won else "failure", "vit_vs": int(won), "trace_hash": f"t{number}",
            "error_mm": 1.0 * number, "angle_deg": 0.1 * number, **more}


def test_the_starts_of_vit_vs_are_as_far_from_the_goal_as_published():
    poses, goal = vit_vs.camera_poses(), GOAL_POSE
    distance_cm = 100.0 * np.linalg.norm(poses[:, :3, 3] - goal[:3, 3], axis=1)
    angle_deg = np.degrees([rotation_angle(goal[:3, :3].T @ pose[:3, :3]) for pose in poses])
    found = distance_cm.mean(), distance_cm.std(), angle_deg.mean(), angle_deg.std()
    np.testing.assert_allclose(found, (46.42, 16.99, 74.12, 27.71), atol=PUBLISHED_DIGITS)
    assert np.allclose(poses[:, :3, :3] @ poses[:, :3, :3].transpose(0, 2, 1), np.eye(3))
    assert np.allclose(np.linalg.det(poses[:, :3, :3]), 1.0)


def test_the_pairs_of_cns_affine_look_at_the_picture_within_the_published_ranges():
    goals, starts = cns_affine.pairs()
    assert len(goals) == len(starts) == 150
    for poses, lowest_deg, tilt_deg in ((goals, 70.0, 1e-6), (starts, 60.0, 7.2)):
        distance = np.linalg.norm(poses[:, :3, 3], axis=1)
        assert 0.6 <= distance.min() < 0.61 and 0.89 < distance.max() <= 0.9
        assert np.degrees(np.arcsin(poses[:, 2, 3] / distance)).min() >= lowest_deg
        towards = -poses[:, :3, 3] / distance[:, None]
        away_deg = np.degrees(np.arccos(np.clip(np.sum(towards * poses[:, :3, 2], axis=1), -1.0, 1.0)))
        assert away_deg.max() < tilt_deg + 1e-5
    turns = [rotation_vector(start[:3, :3].T @ goal[:3, :3])[2] for goal, start in zip(goals, starts)]
    # Cut at 37 before, which is not quite the z of the rotation vector afterwards; uncut, 75 would be reached.
    assert 40.0 < np.degrees(np.abs(turns)).max() < 50.0


def test_the_goal_of_a_cns_start_is_its_own():
    scenario = load_scenario("cns_affine")
    camera = scenario.sim["cameras"][0]
    assert abs(0.5 * camera["width"] / np.tan(0.5 * camera["horizontal_fov_rad"]) - 540.0) < PUBLISHED_DIGITS
    assert scenario.servo["time_limit_s"] * camera["rate_hz"] == pytest.approx(600)
    start = cns_affine.planned(scenario, 3)[1]
    goal, _ = (poses[74] for poses in cns_affine.pairs())
    assert start.id == 75 and start.parameters["experiment.z_star_m"] == pytest.approx(np.linalg.norm(goal[:3, 3]))
    np.testing.assert_allclose(goal[:3, :3] @ start.goal["target_normal_C"], [0.0, 0.0, -1.0], atol=1e-12)


def test_canonical_has_every_law_on_both_robots():
    cases = protocol_named("canonical").cases(None, 2)
    assert {case.columns["robot"] for case in cases} == {"free camera", "six-axis arm"} and len(cases) == 22
    assert all([start.id for start in case.starts] == [1, 2] for case in cases)


def test_fewer_starts_are_spread_over_those_of_the_protocol():
    assert spread(1, 500) == [0] and spread(3, 500) == [0, 250, 499] and spread(500, 500) == list(range(500))
    assert len(set(spread(60, 500))) == 60
    np.testing.assert_array_equal(vit_vs.camera_poses(3), vit_vs.camera_poses()[[0, 250, 499]])
    with pytest.raises(ParameterError, match="starts: found 501, allowed 1 to 500"):
        spread(501, 500)


def test_the_scene_puts_the_camera_where_the_protocol_has_it():
    scenario = load_scenario("vit_vs")
    camera = scenario.sim["cameras"][0]
    focal_px = 0.5 * camera["width"] / np.tan(0.5 * camera["horizontal_fov_rad"])
    assert (camera["width"], camera["height"]) == (640, 480) and abs(focal_px - 502.30) < PUBLISHED_DIGITS
    iterations = scenario.servo["time_limit_s"] * camera["rate_hz"]
    assert iterations == pytest.approx(1500) and scenario.sweep["abort_factor"] == 5.0
    kinematics = scenario.kinematics(calibrated=False)
    np.testing.assert_allclose(kinematics.pose(scenario.goal_posture(kinematics)), GOAL_POSE, atol=1e-12)
    start = vit_vs.planned(scenario, 2)[1]
    assert start.id == 500
    np.testing.assert_allclose(kinematics.pose(kinematics.vector(start.joints)), vit_vs.camera_poses()[499], atol=1e-9)


def test_boards_are_those_of_their_seed_and_textured_everywhere(tmp_path):
    board = boards.draw(1)
    assert board.shape == (1125, 1500, 3) and np.array_equal(board, boards.draw(1))
    assert not np.array_equal(board, boards.draw(2))
    parts = board.astype(float).mean(axis=2)[:1120].reshape(8, 140, 10, 150)
    assert parts.std(axis=(1, 3)).min() > 10.0
    boards.save(tmp_path / "a.png", board)
    assert np.array_equal(boards.load(tmp_path / "a.png"), board)


def test_perturbed_boards_are_darker_or_brighter_noisy_and_half_of_them_covered():
    board = np.full((75, 100, 3), 128, np.uint8)
    copies = [boards.perturbed(board, [489, number]) for number in range(200)]
    assert np.array_equal(copies[3], boards.perturbed(board, [489, 3]))
    # Black keeps its grey or gets brighter by contrast; the noise on it is cut at 0, so that its median is near it.
    covered = [((copy.mean(axis=2) < 40).mean()) for copy in copies]
    share = np.mean([0.01 < part for part in covered])
    assert 0.3 < share < 0.7 and max(covered) < 0.5
    levels = [np.median(copy) for copy in copies]
    assert min(levels) < 70 and max(levels) > 190


def test_the_table_has_wilson_intervals_beside_the_published_rates():
    protocol = protocol_named("vit_vs")
    starts = [SimpleNamespace(id=number) for number in range(1, 11)]
    case = Case("orb_plain", None, starts, {"detector": "ORB"}, (0.896, "theirs"))
    rows = [row(number, number != 7) for number in range(1, 10)]
    rows.append({"id": 10, "outcome": "infeasible", "vit_vs": 0, "trace_hash": None})
    head, line = runner.table(protocol, [(case, rows)])
    assert head[0] == "detector" and line[0] == "ORB"
    low, high = wilson(8, 10)
    assert dict(zip(head, line))["success"] == "80.0 %"
    assert dict(zip(head, line))["95 % interval"] == f"{100 * low:.1f} % to {100 * high:.1f} %"
    assert dict(zip(head, line))["published"] == "89.6 %" and dict(zip(head, line))["median error [mm]"] == "4.5"
    assert dict(zip(head, line))["broke off"] == ""
    broken = [dict(rows[9], outcome="error", reason="error: KeyError", detail="'x'"), *rows[:9]]
    assert dict(zip(*runner.table(protocol, [(case, broken)])))["broke off"] == "1: error: KeyError: 'x'"
    changed = [dict(rows[0], trace_hash="other"), *rows[1:]]
    assert runner.digest(rows) != runner.digest(changed) and runner.digest(rows) == runner.digest(list(rows))
    assert protocol.source in runner.as_markdown(protocol, [head, line], "aras-servo benchmark vit_vs")


def test_a_benchmark_is_gone_on_with_and_refuses_another_one_in_its_folder(tmp_path):
    scenario = load_scenario("free_camera", {"servo.time_limit_s": 0.5})
    kinematics = scenario.kinematics(calibrated=False)
    joints = kinematics.by_name(scenario.start_posture(kinematics))
    starts = [vit_vs.Start(number, joints) for number in (1, 2, 3)]

    class Short(Protocol):
        name, metric = "short", "success"

    case = Case("one", scenario, starts)
    settings = {"drive_to_start": False}
    with open_sweep(tmp_path / case.name, case.scenario, case.starts, settings) as store:
        assert len(store.pending()) == 3
    pytest.importorskip("aras_visual_servo_sim")
    rows = runner.run_case(Short, case, tmp_path, workers=0)
    assert [each["id"] for each in rows] == [1, 2, 3] and runner.digest(rows[:1]) != runner.digest(rows[:2])
    assert runner.run_case(Short, case, tmp_path, workers=0) == rows
    with pytest.raises(ParameterError, match="another scenario"):
        runner.run_case(Short, Case("one", scenario, starts[:2]), tmp_path, workers=0)


def test_protocols_are_known_by_name_and_unknown_ones_list_them(tmp_path):
    assert "vit_vs" in [protocol.name for protocol in known_protocols()]
    with pytest.raises(ParameterError, match="benchmark: found coco, .*vit_vs"):
        protocol_named("coco")
    with pytest.raises(ParameterError, match="--board: found nowhere.png"):
        protocol_named("vit_vs").cases(tmp_path, 1, "nowhere.png")
