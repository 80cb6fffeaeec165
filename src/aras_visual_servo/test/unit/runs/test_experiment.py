"""Judging a run by the true pose in the goal camera frame; features and joint states are paired by stamp."""

import dataclasses
import math

import numpy as np
import pytest
from synthetic import make_record, pose_CgC, RATE_PER_S, SETTINGS, X_WCG

from aras_visual_servo import fit_decay, judge, pose_error, RecordBuilder, StampPairer, Status
from aras_visual_servo.runs.judge import NothingToJudge

# Products and inverses of a few 4 x 4 matrices of order 1 m: rounding of about 10 eps, in mm.
ROUNDING_MM = 1e-11
# The angle is found from sines and cosines of order 1: 10 eps rad in degrees.
ROUNDING_DEG = 1e-12
# Straight line through an exact exponential: rounding of log and polyfit.
ROUNDING_RATE = 1e-9


def test_the_final_error_is_the_pose_of_the_camera_in_the_goal_camera_frame():
    result = judge(make_record(final_p_m=(1e-3, -2e-3, 3e-3), final_angle_rad=-0.01))
    for key, value in (("x_mm", 1.0), ("y_mm", -2.0), ("z_mm", 3.0)):
        assert result.final_error[key] == pytest.approx(value, abs=ROUNDING_MM)
    assert result.final_error["angle_deg"] == pytest.approx(math.degrees(0.01), abs=ROUNDING_DEG)


def test_the_goal_frame_and_not_the_world_frame_is_used():
    X_WC = X_WCG.copy()
    X_WC[:3, 3] += [0.0, 0.001, 0.002]  # in the world: y_C = -y_W and z_C = -z_W there
    error = pose_error(X_WCG, X_WC)
    assert (error["y_mm"], error["z_mm"]) == pytest.approx((-1.0, -2.0), abs=ROUNDING_MM)


@pytest.mark.parametrize("angle_rad", [0.0, 1e-9, 1e-4, 1.0, math.pi - 1e-6, math.pi])
def test_the_angle_is_exact_from_zero_to_half_a_turn(angle_rad):
    assert pose_error(np.eye(4), pose_CgC([0, 0, 0], angle_rad))["angle_deg"] == pytest.approx(
        math.degrees(angle_rad), abs=ROUNDING_DEG)


def test_a_run_within_the_limits_passes():
    result = judge(make_record())
    assert result.converged and result.passed and result.faults == ()


@pytest.mark.parametrize("final, key", [((3e-4, 0, 0), "x_mm"), ((0, -3e-4, 0), "y_mm"), ((0, 0, 6e-4), "z_mm")])
def test_one_axis_outside_its_limit_fails_and_is_named(final, key):
    result = judge(make_record(final_p_m=final, final_angle_rad=0.0))
    assert result.converged and not result.passed
    assert len(result.faults) == 1 and result.faults[0].startswith(key)


def test_an_angle_outside_its_limit_fails():
    result = judge(make_record(final_angle_rad=math.radians(0.06)))
    assert [fault.split(":")[0] for fault in result.faults] == ["angle_deg"]


def test_a_run_that_timed_out_fails_even_at_the_goal():
    result = judge(make_record(final_p_m=(0, 0, 0), final_angle_rad=0.0, status=Status.TIMED_OUT))
    assert not result.converged and not result.passed and "TIMED_OUT" in result.faults[0]


def test_an_unknown_true_pose_fails():
    record = make_record()
    X_WC = record.X_WC.copy()
    X_WC[record.servo_rows[-1]] = np.nan
    assert not judge(dataclasses.replace(record, X_WC=X_WC)).passed


def test_the_duration_is_simulated_time_from_first_to_last_servo_image():
    result = judge(make_record(servo_images=31))
    assert result.images == 31 and result.duration_s == pytest.approx(30 * 0.033333333, abs=1e-12)


def test_the_decay_rate_of_an_exponential_is_found():
    rates = fit_decay(make_record())
    assert list(rates) == ["xn", "yn", "an", "alpha"]
    assert all(abs(rate - RATE_PER_S) < ROUNDING_RATE for rate in rates.values())


def test_only_the_straight_end_of_a_bounded_law_is_fitted():
    """The error falls at 0.3 /s to a tenth, then exponentially: one line through all of it has another slope."""
    record = make_record(servo_images=181)
    t_s, e = record.t_s[record.servo_rows] - record.t_s[record.servo_rows[0]], record.e.copy()
    bounded = np.where(t_s < 3.0, 1.0 - 0.3 * t_s, 0.1 * np.exp(-RATE_PER_S * (t_s - 3.0)))
    e[record.servo_rows, 0] = bounded
    assert fit_decay(dataclasses.replace(record, e=e))["xn"] == pytest.approx(RATE_PER_S, rel=0.05)
    e[record.servo_rows, 0] = 1.0 - 0.16 * t_s  # never exponential
    assert math.isnan(fit_decay(dataclasses.replace(record, e=e))["xn"])


def test_a_feature_without_an_error_has_no_decay_rate():
    record = make_record()
    e = record.e.copy()
    e[:, 2] = 1e-6
    assert math.isnan(fit_decay(dataclasses.replace(record, e=e))["an"])


def test_only_the_continuous_decoupled_law_promises_rates():
    assert judge(make_record()).gains_per_s == dict.fromkeys(("xn", "yn", "an", "alpha"), RATE_PER_S)
    paper = {**SETTINGS, "servo": {**SETTINGS["servo"], "law": "paper", "mode": "look_then_move"}}
    assert judge(make_record(settings=paper)).gains_per_s == {}


def test_a_record_without_servo_says_which_phases_it_has_and_how_it_ended():
    builder = RecordBuilder("cut", ("J1",))
    builder.add_row(0, "to_goal")
    builder.add_row(1, "done", Status.TARGET_LOST, "target not in view at the goal")
    with pytest.raises(NothingToJudge, match="to_goal, done; .*target not in view"):
        judge(builder.finish())


def test_pairs_equal_stamps_whichever_comes_first():
    pairer = StampPairer()
    assert list(pairer.add_joints(10, "q10")) == []
    assert pairer.add_features(10, "f10") == [(10, "f10", "q10")]
    assert pairer.add_features(20, "f20") == []
    assert pairer.add_joints(20, "q20") == [(20, "f20", "q20")]


def test_never_takes_the_latest_joint_state_instead():
    pairer = StampPairer()
    pairer.add_joints(10, "q10")
    assert pairer.add_features(15, "f15") == []


def test_gives_up_on_a_joint_state_once_a_later_one_has_come():
    pairer = StampPairer()
    pairer.add_features(15, "f15")
    assert pairer.add_joints(20, "q20") == [(15, "f15", None)]


def test_keeps_features_in_order():
    pairer = StampPairer()
    pairer.add_features(10, "f10")
    pairer.add_features(20, "f20")
    assert pairer.add_joints(10, "q10") == [(10, "f10", "q10")]
    assert pairer.add_joints(20, "q20") == [(20, "f20", "q20")]


def test_time_that_goes_back_forgets_what_was_before():
    pairer = StampPairer()
    pairer.add_joints(1000, "old")
    pairer.add_features(1010, "old")
    assert list(pairer.add_joints(0, "q0")) == []
    assert pairer.restarts == 1
    assert pairer.add_features(0, "f0") == [(0, "f0", "q0")]


def test_features_may_show_first_that_time_went_back():
    pairer = StampPairer()
    for stamp in (0, 10, 20):
        pairer.add_joints(stamp, "old")
    for stamp in (0, 20):
        pairer.add_features(stamp, "old")
    assert pairer.add_features(0, "f0") == [], "the joint state of stamp 0 is of the time before"
    assert pairer.restarts == 1
    assert pairer.add_joints(0, "q0") == [(0, "f0", "q0")]
    assert pairer.restarts == 1


def test_joint_states_of_the_time_before_may_come_after_features_of_the_new_one():
    pairer = StampPairer()
    pairer.add_joints(20, "old")
    pairer.add_features(20, "old")
    assert pairer.add_features(0, "f0") == []
    assert pairer.add_joints(30, "old") == []
    assert pairer.add_joints(0, "q0") == [(0, "f0", "q0")]
    assert pairer.restarts == 1
    assert pairer.add_features(30, "f30") == [], "its joint state has not come, only one of the time before"


def test_features_of_the_time_before_may_come_after_joint_states_of_the_new_one():
    pairer = StampPairer()
    pairer.add_joints(20, "old")
    assert list(pairer.add_joints(0, "q0")) == []
    assert pairer.add_features(20, "old") == []
    assert pairer.add_features(0, "f0") == [(0, "f0", "q0")]


def test_even_when_the_joint_states_of_the_new_time_are_all_there():
    pairer = StampPairer()
    pairer.add_joints(30, "old")
    for stamp in (0, 10, 20):
        pairer.add_joints(stamp, f"q{stamp}")
    assert pairer.add_features(20, "old") == [(20, "old", "q20")], "taken for one of the new time"
    for stamp in (0, 10, 20):
        assert pairer.add_features(stamp, "new") == [(stamp, "new", f"q{stamp}")]


def test_time_may_go_back_again_and_again():
    pairer = StampPairer()
    for restarts in range(1, 5):
        for stamp in (0, 10):
            pairer.add_joints(stamp, f"q{stamp}")
        assert pairer.add_features(10, "f10") == [(10, "f10", "q10")]
        first, second = (pairer.add_joints, pairer.add_features)[::1 if restarts % 2 else -1]
        assert list(first(0, "new")) == []
        assert second(0, "new") == [(0, "new", "new")] and pairer.restarts == restarts


def test_keeps_no_more_than_its_capacity():
    pairer = StampPairer(capacity=2)
    for stamp in (10, 20, 30):
        pairer.add_joints(stamp, f"q{stamp}")
    assert pairer.add_features(10, "f10") == [(10, "f10", None)]
    assert pairer.add_features(20, "f20") == [(20, "f20", "q20")]
