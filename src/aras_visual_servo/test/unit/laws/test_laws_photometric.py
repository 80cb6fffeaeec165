"""Law photometric on made-up normal equations, its feature, its settings, and what stops the arm."""

from types import SimpleNamespace

import numpy as np
import pytest
from bench import Bench, config
from toy_plant import arm
from views import look_at

from aras_visual_servo import (
    DegenerateFeature, FeatureSet, NotFiniteError, Observation, ParameterError, Reference, Servo, Status)
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.laws.photometric import PhotometricSettings
from aras_visual_servo.scenario.check import check

DT_S, GAIN = 1.0 / 30.0, 3.0
NAMES = ("photometric",)
ROUNDING = 1e-9  # of solving six equations of condition 100
PHOTOMETRIC = {"law": "photometric", "features": list(NAMES), "gains_per_s": {"photometric": GAIN},
               "thresholds": {"photometric": 1.0}}
L = np.random.default_rng(2).normal(size=(50, 6)) * np.array([200, 180, 60, 110, 120, 40])


def features(xi=(0.0,) * 6, rms=None, **more):
    """What a camera displaced by -xi would report, to first order: e = -L xi."""
    e = -L @ np.array(xi)
    H, b = L.T @ L, L.T @ e
    values = {"target_visible": True, "has_reference": True, "valid": True, "fault": "", "interaction": "mean",
              "rms": float(np.sqrt(np.mean(e**2))) if rms is None else rms, "H": H[np.triu_indices(6)].tolist(),
              "b": b.tolist(), "condition": 5.0, "level": 0}
    return SimpleNamespace(**{**values, **more})


def law_of(damping=0.0, rest=(1e-4, 1e-4), **more):
    law = make_law("photometric", [GAIN], LawSetup(
        NAMES, settings={"photometric": PhotometricSettings(damping, *rest)}, **more))
    law.reset(Reference(np.zeros(1)))
    return law


XI = np.array([0.01, -0.02, 0.03, 0.1, -0.05, 0.2])


def test_without_damping_the_twist_goes_the_gauss_newton_step_at_the_gain_asked_for():
    twist, *_, pose, _ = law_of().step(look_at(features(XI), DT_S))
    np.testing.assert_allclose(pose, -XI, rtol=ROUNDING)
    np.testing.assert_allclose(twist * DT_S, XI * (1.0 - np.exp(-GAIN * DT_S)), rtol=ROUNDING)
    np.testing.assert_allclose(law_of().step(look_at(features(XI), 0.0)).twist, XI * GAIN, rtol=ROUNDING)


def test_damping_is_that_of_levenberg_and_marquardt():
    H = L.T @ L
    expected = GAIN * np.linalg.solve(H + 0.5 * np.diag(np.diag(H)), H @ XI)
    np.testing.assert_allclose(law_of(damping=0.5).step(look_at(features(XI), 0.0)).twist, expected, rtol=ROUNDING)


def test_damping_falls_with_the_cost_and_never_rises_above_what_was_asked():
    law, H = law_of(damping=0.5), L.T @ L
    for rms, damping in ((20.0, 0.5), (10.0, 0.125), (40.0, 0.5), (0.0, 0.0)):
        expected = GAIN * np.linalg.solve(H + damping * np.diag(np.diag(H)), H @ XI)
        np.testing.assert_allclose(law.step(look_at(features(XI, rms=rms), 0.0)).twist, expected, rtol=ROUNDING)


def test_cost_decreases_at_every_step_whatever_the_damping():
    for damping in (0.0, 0.01, 1.0, 100.0):
        law, xi, costs = law_of(damping), XI.copy(), []
        for _ in range(50):
            costs.append(features(xi).rms)
            xi = xi - law.step(look_at(features(xi), DT_S)).twist * DT_S
        assert (np.diff(costs) < 0.0).all(), damping


def test_error_is_the_rms_and_the_condition_that_of_the_camera():
    answer = law_of().step(look_at(features(XI, rms=12.5), DT_S))
    assert answer.s == answer.e == (12.5,) and answer.condition == 5.0
    assert FeatureSet(NAMES).source == "photometric" and FeatureSet(NAMES).sees_tilt
    assert FeatureSet().source == "moments"


@pytest.mark.parametrize("row", range(6))
def test_each_part_of_the_twist_has_to_rest_in_its_own_unit(row):
    twist = np.zeros(6)
    twist[row] = 1.0
    for translation, turn in ((0.5, 2.0), (2.0, 0.5)):
        law = law_of(rest=(translation, turn))
        assert law._settled(twist) == (translation > 1.0 if row < 3 else turn > 1.0)


@pytest.mark.parametrize("change, error, text", [
    ({"has_reference": False}, DegenerateFeature, "no reference image"),
    ({"H": []}, DegenerateFeature, "0 numbers in H"),
    ({"H": [0.0] * 21}, DegenerateFeature, "photometric: "),
    ({"condition": float("inf")}, DegenerateFeature, "condition number"),
    ({"condition": float("nan")}, DegenerateFeature, "condition number"),
    ({"b": [float("nan")] * 6}, NotFiniteError, "not finite"),
    ({"rms": float("nan")}, NotFiniteError, "nan")])
def test_what_cannot_be_inverted_is_an_error_by_name(change, error, text):
    with pytest.raises(error, match=text):
        law_of().step(look_at(features(XI, **change), DT_S))


def bench():
    """A servo that was taught at the goal and started."""
    servo = Servo(arm(), config(**PHOTOMETRIC, photometric={"damping": 0.0, "rest_m_per_s": 0.001}))
    goal = Bench().goal_q
    servo.teach(features(), goal, 0.6)
    servo.start(0)
    return servo, goal


def step(servo, q, k, seen):
    return servo.step(Observation(k * 33_333_333, seen, q, k), DT_S)


def test_servo_moves_on_luminance_and_ends_when_cost_and_twist_are_small():
    servo, q = bench()
    assert servo.source.name == "photometric" and servo.feature_names == NAMES
    command, record = step(servo, q, 1, features(XI))
    assert record.status in (Status.SERVOING, Status.NEAR_SINGULARITY, Status.JOINT_LIMIT)
    assert any(command.velocity.values()) and record.e[0] > 1.0 and record.cond_l == 5.0
    for k in range(2, 12):  # the cost alone is small: not done
        _, record = step(servo, q, k, features(XI, rms=0.5))
    assert record.status not in (Status.CONVERGED, Status.FAULT)
    for k in range(12, 20):
        command, record = step(servo, q, k, features())
    assert record.status == Status.CONVERGED and set(command.velocity.values()) == {0.0}


@pytest.mark.parametrize("seen, text", [
    (features(XI, target_visible=False, valid=False, fault="the image has no contrast"), "no contrast"),
    (features(XI, valid=False, fault="six motions look alike in this image"), "six motions"),
    (features(XI, has_reference=False), "no reference image"),
    (features(XI, condition=1e9), "condition number")])
def test_arm_stands_still_and_says_why_until_the_image_is_good_again(seen, text):
    servo, q = bench()
    command, record = step(servo, q, 1, seen)
    assert record.status == Status.TARGET_LOST and text in record.status_text
    assert set(command.velocity.values()) == {0.0} and not command.position
    command, record = step(servo, q, 2, features(XI))
    assert any(command.velocity.values())


def test_numbers_that_are_not_finite_are_a_fault():
    servo, q = bench()
    command, record = step(servo, q, 1, features(XI, b=[float("inf")] * 6))
    assert record.status == Status.FAULT and set(command.velocity.values()) == {0.0}


def test_a_view_that_shows_too_little_cannot_be_taught():
    servo = Servo(arm(), config(**PHOTOMETRIC))
    for seen in (features(target_visible=False), features(valid=False), None):
        with pytest.raises(ParameterError, match="teach"):
            servo.teach(seen, Bench().goal_q, 0.6)


def test_the_goal_is_an_rms_of_zero_whatever_the_taught_view_was_compared_with():
    for seen in (features(XI), features(has_reference=False, rms=np.nan)):
        reference = Servo(arm(), config(**PHOTOMETRIC)).teach(seen, Bench().goal_q, 0.6)
        assert reference.s_star.tolist() == [0.0] and reference.view is None and reference.plane_C is None


def test_every_fault_of_the_settings_is_listed():
    with pytest.raises(ParameterError) as caught:
        Servo(arm(), config(**{**PHOTOMETRIC, "photometric": {
            "damping": -1.0, "rest_m_per_s": 0.0, "rest_rad_per_s": 0.0, "mu": 1.0}}))
    for part in ("damping: found -1", "rest_m_per_s", "rest_rad_per_s", "photometric.mu: found"):
        assert part in str(caught.value), part
    with pytest.raises(ParameterError, match="vision.photometric.interaction"):
        Servo(arm(), config(**PHOTOMETRIC, interaction="mean"))
    with pytest.raises(ParameterError, match="allowed with law 'photometric': photometric"):
        Servo(arm(), config(law="photometric"))
    with pytest.raises(ParameterError, match="sources moments and photometric"):
        FeatureSet(("xn", "photometric"))


def test_a_scenario_must_tell_the_camera_to_make_them():
    from aras_visual_servo.scenario.scenario import load_scenario
    document = load_scenario("six_dof_rectangle").as_dict()
    for key in ("interaction", "features"):
        document["servo"].pop(key)
    document["servo"].update(PHOTOMETRIC)
    document["vision"].pop("photometric", None)
    assert [fault.path for fault in check(document)] == [("vision", "photometric")]
    document["vision"]["photometric"] = {}
    assert check(document) == []
