"""The servo with chosen features and laws, on moments, points and within constraints."""

import numpy as np
import pytest
from bench import Bench, config, resting
from toy_plant import arm, pose_error

from aras_visual_servo import DegenerateFeature, expand, ParameterError, plane_from_pose, Servo, Status
from aras_visual_servo.features import base as features
from aras_visual_servo.laws import base as laws
from aras_visual_servo.laws.base import LAWS

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


POINTS = expand(["points5"])
POSE, HYBRID = ("tx", "ty", "tz", "rx", "ry", "rz"), ("xr", "yr", "zr", "rx", "ry", "rz")
KINDS = {
    "ibvs": ("ibvs", POINTS, {"interaction": "mean"}),
    "ibvs at the goal's depth": ("ibvs", POINTS, {"interaction": "current", "point_depth": "goal"}),
    "pbvs": ("pbvs", POSE, {"pose_from": "points"}),
    "hybrid": ("hybrid", HYBRID, {"pose_from": "points"}),
    "sliding": ("sliding", POINTS, {"sliding": {"switching_per_s": 2.0, "boundary": dict.fromkeys(POINTS, 0.01)}}),
    "broyden": ("broyden", POINTS, {}),
    "broyden from test moves": ("broyden", POINTS, {"broyden": {"initial": "moves"}}),
}


def bench_of(kind):
    law, features, more = KINDS[kind]
    return Bench(law=law, features=list(features), gains_per_s=dict.fromkeys(features, 2.0),
                 thresholds=dict.fromkeys(features, 1e-5), time_limit_s=30.0, **more)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if "test moves" not in kind])
def test_camera_comes_home(kind):
    """The five-axis arm cannot tilt about one axis: it is right again at the goal, where the features are."""
    bench = bench_of(kind)
    assert bench.run(900).status == Status.CONVERGED, bench.records[-1].status_text
    distance, angle = pose_error(bench.X_WG, bench.arm.pose(bench.q))
    assert distance < 1e-3 and angle < 2e-3  # thresholds of 1e-5 over the smallest singular value, about 0.01


def still(command):
    return not command.position and set(command.velocity.values()) == {0.0}


@pytest.mark.parametrize("kind", KINDS)
def test_points_that_are_not_there_leave_the_arm_still_until_they_are(kind):
    bench = bench_of(kind)
    bench.step()
    for x, y in (((), ()), ((0.1,), (0.1,)), ((0.1, 0.2, 0.3, 0.4, 0.5), ())):
        view = bench.look()
        view.features.point_x, view.features.point_y = x, y
        command, record = bench.step(view)
        assert record.status == Status.TARGET_LOST and still(command), (x, record.status_text)
    _, record = bench.step()
    assert record.status in (Status.SERVOING, Status.NEAR_SINGULARITY)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("kind", KINDS)
def test_points_that_are_no_numbers_are_a_fault_with_the_arm_still(kind, bad):
    bench = bench_of(kind)
    bench.step()
    view = bench.look()
    view.features.point_y[2] = bad
    command, record = bench.step(view)
    assert record.status == Status.FAULT and "not finite" in record.status_text and still(command)


@pytest.mark.parametrize("method", ["value", "row"])
def test_a_feature_that_is_not_finite_is_named_in_the_status(monkeypatch, method):
    yn, factor = features.FEATURES["yn"], [1.0]
    broken = type("yn", (yn,), {method: lambda self, view: factor[0] * getattr(yn, method)(self, view)})
    monkeypatch.setitem(features.FEATURES, "yn", broken)
    bench = Bench(**{**IBVS, "interaction": "current"})
    factor[0] = np.nan
    command, record = bench.step()
    assert record.status == Status.FAULT and still(command)
    assert f"{__file__}:" in record.status_text and f": feature 'yn': {method}: found " in record.status_text


@pytest.mark.parametrize("kind", ["pbvs", "hybrid"])
def test_points_in_another_order_are_refused(kind):
    bench = bench_of(kind)
    bench.step()
    view = bench.look()
    view.features.point_x, view.features.point_y = (
        [p[k] for k in (1, 0, 2, 4, 3)] for p in (view.features.point_x, view.features.point_y))
    command, record = bench.step(view)
    assert record.status == Status.TARGET_LOST and "no pose explains" in record.status_text and still(command)


WIDE = {"half_width": 0.8, "half_height": 0.6}
Q_DOT_ROUNDING = 1e-9


@pytest.mark.parametrize("law", ["qp", "mpc"])
def test_the_camera_arrives_within_the_accelerations_of_the_joints(law):
    most = {"gantry": 0.5, "J1": 2.0, "J2": 2.0, "J3": 2.0, "J5": 2.0, "J6": 2.0}
    bench = Bench(law=law, limits={"joint_acceleration": most}, **{law: WIDE})
    names, before = bench.arm.joint_names, np.zeros(6)
    for _ in range(200):
        command, record = bench.step()
        if record.status != Status.SERVOING:
            break
        q_dot = np.array([command.velocity[name] for name in names])
        allowed = np.array([most[name] for name in names]) / 30.0
        assert (np.abs(q_dot - before) <= allowed + Q_DOT_ROUNDING).all()
        np.testing.assert_allclose(record.twist, bench.arm.jacobian(record.q) @ q_dot, atol=Q_DOT_ROUNDING)
        before = q_dot
    bench.run()
    assert bench.records[-1].status == Status.CONVERGED
    bench.assert_at_goal()
    assert any("held back by joint" in record.status_text for record in bench.records)


@pytest.mark.parametrize("law", ["qp", "mpc"])
def test_whatever_the_law_raises_the_arm_stands_still(law, monkeypatch):
    bench = Bench(law=law, **{law: WIDE})
    monkeypatch.setattr(LAWS[law], "joint_velocity", lambda *arguments: 1 / 0)
    command, record = bench.step()
    assert record.status == Status.FAULT and "ZeroDivisionError" in record.status_text and resting(command)
