"""Sampling of starts and perturbations; camera poses to joints; any section is planned or refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import (
    ArasError, BALL_AXES, CAMERA_AXES, GOAL_AXES, keys_of, Kinematics, load_scenario, ParameterError, Perturbations,
    reach, scenario_from_dict, SweepSection)
from aras_visual_servo.arm.reach import REACHED_M, REACHED_RAD
from aras_visual_servo.scenario.sweep import METHODS, SPACES, ViewRanges
from aras_visual_servo.spatial import rotation_vector
from aras_visual_servo_study.sweep.perturb import Perturbation, perturbed
from aras_visual_servo_study.sweep.plan import make_starts, sample, SweepSettings
from aras_visual_servo_study.sweep.space import pose_of

#: Of rotation matrices and their vectors, angles up to 2 rad: a few rounding errors.
ROUNDING = 1e-12


@pytest.fixture(scope="module")
def scenario():
    return load_scenario("experiment_1")


@pytest.fixture(scope="module")
def kinematics(scenario):
    return Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])


def with_sweep(scenario, section):
    return scenario_from_dict(dict(scenario.as_dict(), sweep=section), base=scenario._base)


def plan(scenario, kinematics, section=None, **changes):
    scenario = with_sweep(scenario, section) if section else scenario
    return make_starts(SweepSettings.from_scenario(scenario, kinematics, **changes), scenario, kinematics)


@pytest.mark.parametrize("method", METHODS)
def test_samples_are_seeded_and_inside_the_unit_cube(method):
    points = sample(method, 50, 3, [7, 1])
    assert np.all((points >= 0.0) & (points < 1.0))
    np.testing.assert_array_equal(points, sample(method, 50, 3, [7, 1]))
    if method != "grid":
        assert np.any(points != sample(method, 50, 3, [8, 1]))


def test_a_latin_hypercube_has_one_point_in_every_row_and_column():
    points = sample("latin_hypercube", 20, 4, [3, 1])
    for column in np.floor(points * 20).T:
        assert sorted(column) == list(range(20))


@pytest.mark.parametrize("method", METHODS)
def test_joint_starts_are_inside_their_ranges_and_the_others_at_the_goal(scenario, kinematics, method):
    ranges = {"J2": [-0.15, -0.05], "gantry": [-0.1, 0.0]}
    starts = plan(scenario, kinematics, {"space": "joint", "joints": ranges, "method": method}, starts=16)
    assert len(starts) == 16
    for start in starts:
        assert all(low <= start.joints[name] <= high for name, (low, high) in ranges.items())
        assert start.joints["J3"] == scenario.experiment["goal"]["joints"]["J3"]
        assert start.refusal == ""


def test_a_start_outside_joint_limits_is_refused_by_name(scenario, kinematics):
    [start] = plan(scenario, kinematics, {"space": "joint", "joints": {"gantry": [1.7, 1.7]}}, starts=1)
    assert start.refusal.startswith("outside joint limits: gantry 1.7")


def test_camera_starts_stand_where_they_were_sampled(scenario, kinematics):
    starts = plan(scenario, kinematics, starts=12)
    goal = kinematics.pose(kinematics.vector(scenario.experiment["goal"]["joints"]))
    for start in (start for start in starts if not start.refusal):
        X = np.linalg.solve(goal, kinematics.pose(kinematics.vector(start.joints)))
        wanted = [start.offset.get(axis, 0.0) for axis in ("x_m", "y_m", "z_m")]
        assert np.linalg.norm(X[:3, 3] - wanted) < REACHED_M
        assert np.linalg.norm(rotation_vector(X[:3, :3]) - [0.0, 0.0, start.offset["rz_rad"]]) < 2.0 * REACHED_RAD
    assert sum(not start.refusal for start in starts) > 6


def test_a_camera_pose_out_of_reach_is_refused(kinematics, scenario):
    goal = kinematics.vector(scenario.experiment["goal"]["joints"])
    joints, reason = reach(kinematics, goal, kinematics.pose(goal) @ pose_of({"z_m": 2.0}))
    assert joints is None and reason.startswith("camera pose out of reach")


def test_starts_do_not_depend_on_what_is_perturbed(scenario, kinematics):
    bare = plan(scenario, kinematics, starts=6, seed=3)
    section = {"perturb": {"z_star_error": [-0.2, 0.2], "servo.gains_per_s.xn": [1.0, 4.0]}}
    varied = plan(scenario, kinematics, section, starts=6, seed=3)
    assert [start.joints for start in bare] == [start.joints for start in varied]
    assert all(-0.2 <= start.parameters["z_star_error"] <= 0.2 for start in varied)
    assert len({start.parameters["servo.gains_per_s.xn"] for start in varied}) == 6


def test_every_fault_of_the_section_is_named(scenario, kinematics):
    section = {"perturb": {"wind": [0, 1], "noise_stddev": [-1.0, 2.0], "z_star_error": 3, "target": ["blobb"],
                           "servo.gain": [1, 2], "experiment.start.joints.J1": [0, 1]}}
    with pytest.raises(ParameterError) as caught:
        plan(scenario, kinematics, section, method="sobol", seed=-1, camera={"x_m": [0.2, 0.1]})
    text = str(caught.value)
    for expected in ("sweep.method: found sobol, ", "sweep.seed: found -1",
                     "sweep.camera.x_m: found [0.2, 0.1]",
                     "sweep.perturb.wind: found an unknown name, allowed z_star_error",
                     "noise_stddev: found -1.0, allowed >= 0", "sweep.perturb.z_star_error: found 3, allowed", "blobb",
                     "sweep.perturb.servo.gain: ", "servo.gain: found",
                     "sweep.perturb.experiment.start.joints.J1: found"):
        assert expected in text


def test_perturbations_reach_robot_controllers_camera_and_target(scenario):
    other = perturbed(scenario, {"z_star_error": 0.1, "pid_gain_scale": 2.0, "friction_scale": 3.0, "target": "l_shape",
                                 "damping_scale": 0.5, "noise_stddev": 1.5, "target_scale": 1.2})
    assert other.experiment["z_star_m"] == pytest.approx(0.59 * 1.1)
    assert other.controllers()["J2_position_controller"]["pid"]["p"] == 14000.0
    assert other.controllers()["J2_position_controller"]["pid"]["i_clamp"] == 1000.0
    assert 'friction="2.7"' in other.urdf_xml().replace("2.7000000000000002", "2.7")
    static = scenario.with_overrides({"robot.dynamics.static_friction": {"J2": 2.0},
                                      "robot.dynamics.stribeck_velocity": {"J2": 0.1}})
    assert 'static_friction="6.0"' in perturbed(static, {"friction_scale": 3.0}).urdf_xml()
    assert other.sim["cameras"][0]["noise_stddev"] == 1.5
    [model] = other.sim["scene"]["models"]
    assert "file" not in model and len(model["outlines_m"][0]) == 6
    assert scenario.sim["cameras"][0]["noise_stddev"] == 0.0


def test_values_are_taken_in_their_order_each_as_often():
    values = ("blob", "l_shape", "rectangle")
    perturbation = Perturbation("target", values=values)
    found = [perturbation.at(k / 300.0) for k in range(300)]
    assert found == [value for value in values for _ in range(100)]


def test_a_range_is_gone_through_evenly_from_its_low_end():
    perturbation = Perturbation("z_star_error", -0.2, 0.3)
    assert [perturbation.at(u) for u in (0.0, 0.25, 0.5)] == pytest.approx([-0.2, -0.075, 0.05], abs=ROUNDING)


def test_the_runs_of_a_sweep_get_every_value(scenario, kinematics):
    values = ["blob", "l_shape", "rectangle"]
    starts = plan(scenario, kinematics, {"perturb": {"target": {"values": values}}}, starts=9, seed=3)
    assert sorted(start.parameters["target"] for start in starts) == sorted(values * 3)


@pytest.mark.parametrize("path", ["servo", "nothing.at_all", "experiment.start.joints.J1", "servo.gains_per_s"])
def test_what_is_no_plain_value_of_a_scenario_cannot_vary(scenario, kinematics, path):
    with pytest.raises(ParameterError, match=f"{path}: found an unknown name"):
        SweepSettings.from_scenario(with_sweep(scenario, {"perturb": {path: [0.0, 1.0]}}), kinematics)


@pytest.mark.parametrize("count, dimensions, shape", [
    (3, 2, (2, 1)), (5, 3, (2, 2, 1)), (2, 3, (2, 1, 1)), (7, 2, (3, 2)), (11, 2, (3, 3)), (23, 3, (3, 3, 2)),
    (8, 3, (2, 2, 2)), (5, 1, (5,))])
def test_axes_of_a_grid_have_equally_many_places_and_the_first_ones_what_is_left(count, dimensions, shape):
    points = sample("grid", count, dimensions, 0)
    for column, places in zip(points.T, shape):
        np.testing.assert_allclose(sorted(set(column)), (np.arange(places) + 0.5) / places)
    assert len({tuple(point) for point in points}) == len(points) == math.prod(shape)


@pytest.mark.parametrize("parameters, later_s", [
    ({"noise_stddev": 1.5}, 0.0), ({"latency_images": 2}, 2 / 30), ({"latency_s": 0.01}, 0.01),
    ({"latency_images": 1, "latency_s": 0.01}, 0.01 + 1 / 30)])
@pytest.mark.parametrize("before_s", [None, 0.02])
def test_images_come_later_by_what_was_asked_and_by_nothing_else(scenario, parameters, later_s, before_s):
    if before_s is not None:
        [camera] = scenario.sim["cameras"]
        scenario = scenario.with_overrides({"sim.cameras": [dict(camera, latency_s=before_s)]})
    [camera] = perturbed(scenario, parameters).sim["cameras"]
    assert camera.get("latency_s", 0.0) == pytest.approx((before_s or 0.0) + later_s)
    assert camera["noise_stddev"] == parameters.get("noise_stddev", 0.0)


SCENARIO = load_scenario("experiment_1")
KINEMATICS = Kinematics(SCENARIO.urdf_xml(), SCENARIO.robot["base_link"], SCENARIO.robot["tip_link"])
FEW = st.integers(1, 3)  # starts; what many do is a question of time
NUMBERS = st.floats() | st.sampled_from([0, -1, 3, 10**400, 2**63, 1e308, -1e308, 5e-324, 0.1, -0.1, 1.0])
ODD = st.sampled_from([None, True, "", "x", [], {}, [[]], {"values": []}, {"values": [None]}, {1: 2}, "9" * 300])
RANGES = st.lists(NUMBERS, min_size=2, max_size=2).map(sorted) | st.lists(NUMBERS, max_size=3) | NUMBERS | ODD
PATHS = ("servo.gains_per_s.xn", "experiment.z_star_m", "sim.cameras", "vision.threshold", "servo.law", "time.lockstep",
         "experiment.start.joints.J1", "servo.no_such_key", "servo.gains_per_s", "..", "", "sim.period_s")


def ranges_of(names):
    return st.dictionaries(st.sampled_from(names), RANGES, max_size=3) | ODD


SECTION = st.fixed_dictionaries({"starts": FEW}, optional={
    "method": st.sampled_from(METHODS) | ODD, "space": st.sampled_from(SPACES) | ODD, "seed": NUMBERS | st.integers(),
    "drive_to_start": st.booleans() | ODD, "abort_factor": NUMBERS | ODD, "camera": ranges_of(CAMERA_AXES),
    "ball": ranges_of(BALL_AXES), "view": ranges_of([key.name for key in keys_of(ViewRanges)]),
    "joints": ranges_of([*KINEMATICS.joint_names, "nobody"]), "goal": ranges_of(GOAL_AXES),
    "perturb": st.dictionaries(st.sampled_from([*(key.name for key in keys_of(Perturbations)), *PATHS]),
                               RANGES | st.fixed_dictionaries({"values": st.lists(NUMBERS | ODD, max_size=2)}),
                               max_size=2) | ODD})


def planned(section):
    """The starts planned, or None if the section is refused."""
    try:
        scenario = scenario_from_dict(dict(SCENARIO.as_dict(), sweep=section), base=SCENARIO._base)
        starts = make_starts(SweepSettings.from_scenario(scenario, KINEMATICS), scenario, KINEMATICS)
        for start in starts:
            perturbed(scenario, start.parameters)
        return starts
    except ArasError as error:
        assert str(error)
        return None


@settings(deadline=None, max_examples=150, derandomize=True)
@given(SECTION)
def test_any_section_is_planned_or_refused(section):
    starts = planned(section)
    assert starts is None or 1 <= len(starts) <= section["starts"]


def test_the_keys_drawn_are_those_there_are():
    assert {key.name for key in keys_of(SweepSection)} == {
        "starts", "method", "space", "seed", "drive_to_start", "abort_factor", "camera", "ball", "view", "joints",
        "goal", "perturb"}


@pytest.mark.parametrize("starts", [10**8, 10**400], ids=["10^8", "10^400"])
def test_more_starts_than_anybody_runs_are_refused(starts):
    with pytest.raises(ParameterError, match=r"sweep.starts: found 10+(\.\.\.)?, allowed .*<= 1000000"):
        SweepSettings.from_scenario(SCENARIO, KINEMATICS, starts=starts)
