"""Spaces of starts and goals: the ball about the goal, the whole field of view, goals seen tilted."""

import numpy as np
import pytest

from aras_visual_servo import Kinematics, load_scenario, Outline, ParameterError, scenario_from_dict
from aras_visual_servo_study.sweep.plan import make_starts, sample, SweepSettings
from aras_visual_servo_study.sweep.run import placed
from aras_visual_servo_study.sweep.space import (
    CAMERA_AXES, in_ball, offset_of, pose_of, tilted_goal, View, VIEW_MARGIN_PX)

#: Sums and products of a few rounding errors, in metres, radians and pixels.
ROUNDING = 1e-9
#: Corners of a median from 2000 samples: sqrt(0.25 / 2000) is 0.011, three of them.
MEDIAN = 0.034


def parts(scenario):
    kinematics = Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    return kinematics, kinematics.pose(kinematics.vector(scenario.experiment["goal"]["joints"]))


@pytest.fixture(scope="module")
def wide():
    return load_scenario("field_of_view")


@pytest.fixture(scope="module")
def tilted():
    return load_scenario("six_dof_domain")


def test_displacements_survive_the_round_trip():
    offset = dict(zip(CAMERA_AXES, (0.1, -0.2, 0.05, 0.3, -0.4, 1.2)))
    assert offset_of(pose_of(offset)) == pytest.approx(offset, abs=ROUNDING)


def test_a_ball_is_filled_evenly():
    ranges = {"distance_m": (0.0, 0.2), "angle_rad": (0.1, 0.5)}
    points = np.array([list(in_ball(ranges, place).values()) for place in sample("random", 2000, 6, 3)])
    distance, angle = np.linalg.norm(points[:, :3], axis=1), np.linalg.norm(points[:, 3:], axis=1)
    assert distance.max() <= 0.2 and angle.min() >= 0.1 and angle.max() <= 0.5
    # Half of the volume is inside the cube root of a half, and on either side of each plane through the middle.
    assert np.mean(distance < 0.2 * 0.5 ** (1.0 / 3.0)) == pytest.approx(0.5, abs=MEDIAN)
    assert np.mean(points > 0.0, axis=0) == pytest.approx(np.full(6, 0.5), abs=MEDIAN)


@pytest.mark.parametrize("u, v", [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (0.0, 0.0)])
def test_the_view_reaches_from_border_to_border(wide, u, v):
    kinematics, X_WCg = parts(wide)
    for depth_m, rz_rad in ((0.35, -2.9), (0.55, 1.0)):
        offset = View(wide, X_WCg).offset({"u": u, "v": v, "depth_m": depth_m, "rz_rad": rz_rad})
        pixels = Outline.of(wide).pixels(X_WCg @ pose_of(offset))
        low, high = pixels.min(axis=0) + 0.5, [319.5, 239.5] - pixels.max(axis=0)
        for axis, place in enumerate((u, v)):
            if place == 0.0:
                assert low[axis] == pytest.approx(high[axis], abs=ROUNDING * 1e3)
            else:
                assert (low if place < 0 else high)[axis] == pytest.approx(VIEW_MARGIN_PX, abs=ROUNDING * 1e3)
        assert offset["rz_rad"] == pytest.approx(rz_rad) and abs(offset["rx_rad"]) < 1e-6
        depth = (np.linalg.inv(X_WCg @ pose_of(offset)) @ Outline.of(wide).X_WT)[2, 3]
        assert depth == pytest.approx(depth_m, abs=1e-6)


def test_a_target_too_large_for_the_image_is_a_refusal(wide):
    kinematics, _ = parts(wide)
    section = {"space": "view", "view": {"depth_m": [0.05, 0.05]}, "starts": 3}
    scenario = scenario_from_dict(dict(wide.as_dict(), sweep=section), base=wide._base)
    starts = make_starts(SweepSettings.from_scenario(scenario, kinematics), scenario, kinematics)
    assert [start.refusal.partition(":")[0] for start in starts] == ["target does not fit into the image"] * 3
    assert all(start.joints is None for start in starts)


def test_the_view_needs_a_target_seen_parallel(tilted):
    scenario = load_scenario("six_dof_tilted")
    kinematics, X_WCg = parts(scenario)
    with pytest.raises(ParameterError, match="tilted by 0.262 rad at the goal, allowed <= 0.01"):
        View(scenario, X_WCg)
    document = scenario.as_dict()
    document["sim"]["scene"]["models"] = []
    with pytest.raises(ParameterError, match="which needs a flat target of known outline"):
        View(scenario_from_dict(document, base=scenario._base), X_WCg)


def test_a_tilted_goal_keeps_the_target_in_place():
    t_C, normal = np.array([0.03, -0.02, 0.5]), np.array([0.1, 0.2, 0.97])
    normal /= np.linalg.norm(normal)
    X, turned = tilted_goal({"tilt_rad": 0.4, "about_rad": 1.1}, t_C, normal)
    np.testing.assert_allclose(np.linalg.inv(X) @ [*t_C, 1.0], [*t_C, 1.0], atol=ROUNDING)
    np.testing.assert_allclose(X[:3, :3] @ turned, normal, atol=ROUNDING)
    assert np.arccos(0.5 * (np.trace(X[:3, :3]) - 1.0)) == pytest.approx(0.4)


def test_goals_of_a_sweep_are_seen_as_they_were_drawn(tilted):
    kinematics, X_WCg = parts(tilted)
    starts = make_starts(SweepSettings.from_scenario(tilted, kinematics, starts=25), tilted, kinematics)
    tried = [start for start in starts if not start.refusal]
    assert len(tried) >= 5
    X_WT = Outline.of(tilted).X_WT
    for start in tried:
        scenario = placed(tilted, start)
        X_WC = kinematics.pose(kinematics.vector(scenario.experiment["goal"]["joints"]))
        X_CT = np.linalg.solve(X_WC, X_WT)
        # The target's own z points to the camera; reaching a pose leaves 0.1 mm and half a milliradian.
        np.testing.assert_allclose(scenario.servo["target_normal_C"], -X_CT[:3, 2], atol=1e-3)
        np.testing.assert_allclose(X_CT[:3, 3], np.linalg.solve(X_WCg, X_WT)[:3, 3], atol=1e-3)
        assert np.arccos(-X_CT[2, 2]) == pytest.approx(start.goal["tilt_rad"], abs=1e-3)
        X_CnC = np.linalg.solve(X_WC, kinematics.pose(kinematics.vector(start.joints)))
        assert np.linalg.norm(X_CnC[:3, 3]) <= 0.2 + 3e-4
    assert len({start.goal["tilt_rad"] for start in starts}) == 25


@pytest.mark.parametrize("place, expected", [
    ((1.0, 0.5, 0.0), (0.2, 0.0, 0.0)), ((1.0, 0.5, 0.25), (0.0, 0.2, 0.0)), ((1.0, 0.5, 0.5), (-0.2, 0.0, 0.0)),
    ((1.0, 0.0, 0.3), (0.0, 0.0, 0.2)), ((1.0, 1.0, 0.3), (0.0, 0.0, -0.2)), ((0.0, 0.5, 0.0), (0.1, 0.0, 0.0)),
    ((0.5, 0.5, 0.0), (0.0045 ** (1.0 / 3.0), 0.0, 0.0))])
def test_a_place_in_a_ball_is_a_radius_and_two_angles(place, expected):
    ranges = {"distance_m": (0.1, 0.2), "angle_rad": (0.1, 0.2)}
    both = list(in_ball(ranges, (*place, *place)).values())
    np.testing.assert_allclose(both, [*expected, *expected], atol=ROUNDING)


@pytest.mark.parametrize("turn_rad", [0.0, 0.5 * np.pi])
def test_a_target_must_fit_into_the_image_along_both_of_its_sides(wide, turn_rad):
    _, X_WCg = parts(wide)
    view = View(wide, X_WCg)
    size = np.ptp(view._points @ pose_of({"rz_rad": turn_rad})[:3, :3], axis=0)[:2]
    place = {"u": 0.0, "v": 0.0, "rz_rad": turn_rad}
    least_m = (size / (2.0 * view._half)).max()  # depth at which the tighter side fits
    assert least_m > 1.05 * (size / (2.0 * view._half)).min(), "one side alone is too long"
    assert offset_of(pose_of(view.offset({**place, "depth_m": 1.01 * least_m})))["rz_rad"] == pytest.approx(turn_rad)
    with pytest.raises(ParameterError, match="target does not fit into the image: at depth"):
        view.offset({**place, "depth_m": 0.99 * least_m})
