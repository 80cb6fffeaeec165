"""The servo with features and laws of the scenario's choice: the plane by kinematics, statuses, bad input."""

import numpy as np
import pytest
from bench import Bench, config
from toy_plant import arm

from aras_visual_servo import DegenerateFeature, ParameterError, plane_from_pose, Servo, Status
from aras_visual_servo.features import base as features
from aras_visual_servo.laws import base as laws

SIX = ("xn", "yn", "an", "sx", "sy", "alpha")
ROUNDING = 1e-10  # of a chain of two forward kinematics
IBVS = {"law": "ibvs", "features": list(SIX), "gains_per_s": dict.fromkeys(SIX, 2.0),
        "thresholds": dict.fromkeys(SIX, 1e-6)}


@pytest.fixture
def law_that():
    """Registers a law that does what it is told, and forgets it afterwards."""
    def make(twist):
        @laws.register_law("made_for_test")
        class Made(laws.Law):
            def _twist(self, look, s, e):
                return twist(look)

        return "made_for_test"

    yield make
    laws.LAWS.pop("made_for_test", None)


def test_plane_of_the_target_follows_the_joints():
    bench = Bench(**{**IBVS, "interaction": "current"})
    q = bench.goal_q + 0.1 * np.arange(6.0) / 6.0
    X_CT = np.linalg.inv(bench.arm.pose(q)) @ bench.camera.X_WT
    np.testing.assert_allclose(bench.servo.goal.plane_at(q), plane_from_pose(X_CT[:3, 2], X_CT[:3, 3]),
                               atol=ROUNDING)


def test_features_that_see_tilt_are_recorded_by_name_with_the_condition_of_their_matrix():
    bench = Bench(**IBVS)
    _, record = bench.servo.step(bench.look(), 1 / 30)
    assert record.feature_names == SIX and record.s.shape == record.e.shape == record.s_star.shape == (6,)
    assert record.cond_l > 1.0


def test_a_goal_of_four_gains_for_six_features_is_refused():
    servo = Servo(arm(), config(**IBVS))
    with pytest.raises(ParameterError, match="gains_per_s: found 4 .*allowed 6"):
        servo.configure(gains_per_s=[1.0] * 4)
    with pytest.raises(ParameterError, match="allowed with law 'paper'"):
        servo.configure(law="paper")


@pytest.mark.parametrize("twist, text", [
    (lambda look: np.zeros(5), "six finite numbers"), (lambda look: np.full(6, np.nan), "six finite numbers"),
    (lambda look: 1 / 0, "ZeroDivisionError"), (lambda look: None, "six finite numbers")])
def test_whatever_a_law_does_wrong_the_arm_stands_still_with_fault(law_that, twist, text):
    bench = Bench(law=law_that(twist))
    command, record = bench.servo.step(bench.look(), 1 / 30)
    assert record.status == Status.FAULT and text in record.status_text
    assert set(command.velocity.values()) == {0.0} and not command.position


@pytest.mark.parametrize("on_lost", ["hold", "back_off"])
def test_law_is_told_what_was_carried_out_and_nothing_over_a_stop(law_that, on_lost):
    told, twist = [], np.array([0.0, 0.0, 0.0, 0.0, 0.0, 400.0])  # far above what the joints can do
    bench = Bench(law=law_that(lambda look: told.append(look.applied) or twist.copy()), on_lost=on_lost,
                  lost_target={"patience_s": 0.0, "confirm_s": 0.0})
    _, record = bench.step()
    bench.step()
    assert told[0] is None and 0.0 < told[1][5] < 100.0
    np.testing.assert_array_equal(told[1], record.twist)
    lost = bench.look()
    lost.features.target_visible = False
    bench.step(lost)
    bench.step()
    assert told[2] is None


def test_a_view_that_a_feature_does_not_exist_in_stops_the_arm_until_it_does(law_that):
    def fail(look):
        raise DegenerateFeature("round")

    bench = Bench(law=law_that(fail))
    command, record = bench.servo.step(bench.look(), 1 / 30)
    assert record.status == Status.TARGET_LOST and set(command.velocity.values()) == {0.0}
    assert not bench.servo.finished


def test_moments_of_too_low_an_order_are_refused_when_taught():
    bench = Bench(**IBVS)
    view = bench.camera.features(bench.X_WG)
    view.moment_names, view.m, view.mu = view.moment_names[:3], view.m[:3], view.mu[:3]
    with pytest.raises(ParameterError, match="vision.order"):
        bench.servo.teach(view, bench.goal_q, 0.5)


def test_every_fault_of_the_features_is_listed():
    with pytest.raises(ParameterError) as caught:
        Servo(arm(), config(features=["xn", "zn"], gains_per_s={"xn": 1.0}, thresholds={"xn": 1.0, "zn": 1.0},
                            target_normal_C=[0.0, 0.0, -1.0], adaptive_gain={"infinity_part": 2.0},
                            interaction="goal", smooth_start_per_s=-1.0, plugins=["no.such.module"]))
    text = str(caught.value)
    for part in ("features[1]: found zn, ", "target_normal_C", "infinity_part", "slope: found nothing",
                 "interaction: found goal, ", "smooth_start_per_s", "no.such.module"):
        assert part in text, part
    assert "px" in features.known_features()
