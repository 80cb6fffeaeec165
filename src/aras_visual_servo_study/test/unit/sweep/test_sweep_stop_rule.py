"""Cases that try the stop rule: what they are drawn from, what their scenarios hold, and how their ends are counted."""
import math

import numpy as np
import pytest
from synthetic import IMAGE_PERIOD_NS, make_record

from aras_visual_servo.ground.types import Status
from aras_visual_servo.scenario.scenario import load_scenario
from aras_visual_servo_study.sweep import stop_rule
from aras_visual_servo_study.sweep.stop_rule import (BORDER_PX, EXPERIMENTS, NEARER, SIX_AXIS, Case, run_case,
                                                          scenario_of, tally)

ROUNDING = 1e-12
MIDDLE = [0.5] * 15  # of all that is drawn: the scenario, five values, seven joints, two of a goal
HOME = (0.0, 0.0, 0.0)
JOINTS, GOAL = slice(6, 13), slice(13, 15)


def drawn(scenario, **places):
    """The case of a scenario whose other places are in the middle. Places: values, joints or goal, each a list."""
    place = list(MIDDLE)
    place[0] = (EXPERIMENTS.index(scenario) + 0.5) / 4.0 if scenario in EXPERIMENTS else \
        0.5 + 0.5 * (SIX_AXIS.index(scenario) + 0.5) / 11.0
    for name, where in (("values", slice(1, 6)), ("joints", JOINTS), ("goal", GOAL)):
        place[where] = places.get(name, place[where])
    return stop_rule._case(1, place)


def way(case, q_goal=None):
    """Joint positions of a case, from its goal."""
    kinematics, _, at_goal, _ = stop_rule._known(case.scenario)
    return kinematics.vector(case.joints) - (at_goal if q_goal is None else q_goal)


@pytest.mark.parametrize("place, scenario", [
    (0.0, "experiment_1"), (0.249, "experiment_1"), (0.25, "experiment_2"), (0.499, "experiment_2"),
    (0.5, SIX_AXIS[0]), (0.545, SIX_AXIS[0]), (0.546, SIX_AXIS[1]), (0.999, SIX_AXIS[-1])])
def test_half_of_the_cases_are_experiments_and_each_scenario_of_a_half_comes_as_often(place, scenario):
    assert stop_rule._case(7, [place, *MIDDLE[1:]]).scenario == scenario


@pytest.mark.parametrize("t, values", [
    (0.0, (0.5, 0.5, 0.0, 0.0, 1.0)), (1.0, (4.0, 12.0, 5.0, 0.08, 5.0)),
    (0.5, (math.sqrt(2.0), math.sqrt(6.0), 2.5, 0.04, 3.0))])
def test_gains_vary_by_factors_and_the_rest_by_steps(t, values):
    case = drawn("experiment_1", values=[t] * 5)
    assert (case.gain_factor, case.tilt_gain_per_s, case.noise_stddev, case.latency_s, case.friction_scale) == \
        pytest.approx(values, rel=ROUNDING)


def test_in_the_middle_a_case_begins_at_its_goal():
    assert np.abs(way(drawn("experiment_1"))).max() < ROUNDING


@pytest.mark.parametrize("joint, reach", [("gantry", 0.1875), ("J1", 0.05)])
def test_a_joint_reaches_a_quarter_beyond_the_scenario_or_as_far_as_any_does(joint, reach):
    index = stop_rule._known("experiment_1")[0].joint_names.index(joint)
    for side in (0.0, 1.0):
        joints = list(MIDDLE[JOINTS])
        joints[index] = side
        moved = way(drawn("experiment_1", joints=joints))
        assert moved[index] == pytest.approx((2.0 * side - 1.0) * reach, rel=1e-9)
        assert np.abs(np.delete(moved, index)).max() < ROUNDING


@pytest.mark.parametrize("side", [0.0, 1.0])
@pytest.mark.parametrize("scenario", ["experiment_1", "six_dof_points"])
def test_a_start_that_cannot_be_run_is_brought_nearer_until_it_can(scenario, side):
    kinematics, planner, q_goal, q_start = stop_rule._known(scenario)
    moved = way(drawn(scenario, joints=[side] * 7))
    full = (2.0 * side - 1.0) * np.maximum(1.25 * np.abs(q_start - q_goal), 0.05)
    steps = round(math.log(moved[0] / full[0]) / math.log(NEARER))
    np.testing.assert_allclose(moved, NEARER**steps * full, rtol=1e-9)
    assert steps > 0

    def can_be_run(q):
        return not planner.feasibility.refusal(q_goal, q) and \
            planner.feasibility.outline.border_px(kinematics.pose(q)) >= BORDER_PX

    assert can_be_run(q_goal + moved) and not can_be_run(q_goal + moved / NEARER)


@pytest.mark.parametrize("place, tilt_rad, about_rad", [
    ((0.0, 0.3), 0.0, -1.25664), ((0.5, 0.75), 0.2618, 1.5708), ((1.0, 0.3), 0.5236, -1.25664),
    ((1.0, 0.5), NEARER * 0.5236, 0.0), ((1.0, 0.0), NEARER**2 * 0.5236, -3.1416)])
def test_a_goal_is_tilted_as_drawn_or_by_less_until_the_arm_reaches_it(place, tilt_rad, about_rad):
    case = drawn("six_dof_domain", goal=list(place))
    assert (case.goal["tilt_rad"], case.goal["about_rad"]) == pytest.approx((tilt_rad, about_rad), abs=1e-9)
    kinematics = stop_rule._known("six_dof_domain")[0]
    assert np.abs(way(case, kinematics.vector(case.goal["joints"]))).max() < ROUNDING


def test_the_scenario_of_a_case_holds_all_that_varies():
    case = Case(9, "experiment_1", 2.0, 7.0, 3.0, 0.05, 2.0, {}, {})
    plain, scenario = load_scenario("experiment_1"), scenario_of(case)
    assert scenario.servo["gains_per_s"] == {name: 2.0 * gain for name, gain in plain.servo["gains_per_s"].items()}
    [camera], [before] = scenario.sim["cameras"], plain.sim["cameras"]
    assert camera == {**before, "noise_stddev": 3.0, "latency_s": 0.05}
    assert (scenario.sim["seed"], scenario.servo["tilt_gain_per_s"]) == (9, 7.0)
    assert 'friction="1.8"' in scenario.urdf_xml() and 'friction="0.9"' in plain.urdf_xml()


def run_of(monkeypatch, record, **row):
    """What `run_case` makes of a run that ended so."""
    ended = {"detail": "in words", "duration_s": 2.5, "run_hash": "a hash", "outcome": "success", **row}
    asked = []

    class SweepRunner:
        def __init__(self, scenario):
            asked.append(scenario)

        def run(self, start):
            asked.append(start)
            return ended, record

    monkeypatch.setattr(stop_rule, "SweepRunner", SweepRunner)
    row = run_case(Case(3, "experiment_1", 1.0, 3.0, 0.0, 0.0, 1.0, {"J1": 0.1}, {"tilt_rad": 0.2}))
    scenario, start = asked
    assert scenario.sim["seed"] == start.id == 3
    assert start.joints == {"J1": 0.1} and start.goal == {"tilt_rad": 0.2}
    return row


def test_a_run_is_inside_when_the_camera_stayed_within_the_judge_for_the_hold_time(monkeypatch):
    # The distance along z begins at 120 mm and decays at 3 /s: it is 0.1 mm between the images 70 and 71. The hold time
    # of 0.2 s is six periods.
    row = run_of(monkeypatch, make_record(HOME, 0.0, 78))
    assert row["inside"] and row["converged"] and row["status"] == "CONVERGED"
    assert row["worst"] == pytest.approx(1200.0 * math.exp(-3e-9 * 71 * IMAGE_PERIOD_NS), rel=1e-6)
    row = run_of(monkeypatch, make_record(HOME, 0.0, 77))
    assert row["worst"] > 1.0 and not row["inside"] and row["converged"]


@pytest.mark.parametrize("ended", [{"final_p_m": (-1.01e-4, 0.0, 0.0)}, {"final_p_m": (0.0, 2.01e-4, 0.0)},
                                   {"final_p_m": (0.0, 0.0, -1.01e-4)}, {"final_angle_rad": 0.0301 * math.pi / 180.0}])
def test_each_limit_of_the_judge_binds_on_the_last_image(monkeypatch, ended):
    row = run_of(monkeypatch, make_record(**{"final_p_m": HOME, **ended}))
    assert not row["inside"] and row["worst"] == pytest.approx(1.005, rel=0.006)


def test_a_row_tells_how_the_run_ended(monkeypatch):
    record = make_record(final_p_m=(1e-5, -2e-5, 3e-5), status=Status.TIMED_OUT)
    row = run_of(monkeypatch, record)
    assert row["inside"] and not row["converged"] and row["status"] == "TIMED_OUT"
    assert (row["x_mm"], row["y_mm"], row["z_mm"]) == pytest.approx((0.01, -0.02, 0.03), abs=1e-9)
    assert (row["reason"], row["duration_s"], row["run_hash"]) == ("in words", 2.5, "a hash")
    assert row["e"] == record.e[record.servo_rows[-1]].tolist() and row["scenario"] == "experiment_1"


def test_a_case_that_could_not_be_run_is_neither_inside_nor_converged(monkeypatch):
    row = run_of(monkeypatch, None, outcome="infeasible")
    assert row["status"] == "infeasible" and row["reason"] == "in words" and row["duration_s"] is None
    assert row["inside"] is row["converged"] is False


def test_the_servo_is_wrong_in_two_ways_and_each_is_counted():
    def row(scenario, inside, converged, status="CONVERGED"):
        return {"scenario": scenario, "inside": inside, "converged": converged, "status": status}

    rows = [row("a", True, True), row("a", True, True), row("a", False, False), row("b", True, False),
            row("b", False, True), row("b", False, True), row("b", False, False, "infeasible")]
    assert tally(rows) == {
        "a": {"runs": 3, "inside": 2, "converged": 2, "false_converged": 0, "missed": 0},
        "b": {"runs": 3, "inside": 1, "converged": 2, "false_converged": 2, "missed": 1},
        "all": {"runs": 6, "inside": 3, "converged": 4, "false_converged": 2, "missed": 1}}
