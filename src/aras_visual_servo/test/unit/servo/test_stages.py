"""Stages one by one, also of one's own; what a move does beside what the law asks for; what keeps an object in view."""

from dataclasses import dataclass

import numpy as np
import pytest
from bench import Bench, config, DT_S, resting
from toy_plant import arm, GOAL, pose_error

import aras_visual_servo as avs
from aras_visual_servo import FEATURE_NAMES, Servo, Status, Tick, View
from aras_visual_servo.features.interaction import centroid
from aras_visual_servo.servo.stages import SmoothStart
from aras_visual_servo.servo.look_then_move import LookThenMove
from aras_visual_servo.servo.stage import STAGES
from aras_visual_servo.servo.visibility import keep_in_view, VisibilitySettings

TWIST = np.array([0.1, -0.2, 0.3, 0.0, 0.1, 0.5])


def tick():
    return Tick(0, DT_S, None, np.zeros(6), None, twist=TWIST)


@dataclass(frozen=True)
class SlowSettings:
    part: float = avs.setting(0.5, above=0, at_most=1, help="Part of the twist.")


@pytest.fixture
def stage_that():
    """Registers a stage with this `apply`, and forgets it afterwards."""
    def make(apply):
        avs.register_stage("made_for_test", settings=SlowSettings)(type("Made", (avs.Stage,), {"apply": apply}))
        return ["made_for_test"]

    yield make
    STAGES.pop("made_for_test", None)


def test_smooth_start_lets_the_twist_in_at_its_rate_and_anew_for_each_goal():
    stage, rate = SmoothStart(4.0), 4.0
    for k in range(1, 200):
        np.testing.assert_allclose(stage.apply(tick()).twist, (1.0 - np.exp(-rate * k * DT_S)) * TWIST, atol=1e-12)
    stage.set_reference(None)
    np.testing.assert_allclose(stage.apply(tick()).twist, (1.0 - np.exp(-rate * DT_S)) * TWIST, atol=1e-12)


def test_a_stage_of_ones_own_has_the_last_word_on_the_twist_with_its_settings(stage_that):
    plain = Bench(creep_rate_per_s=0.0).step()[1].twist
    stages = stage_that(lambda self, tick: tick.set(twist=(self.settings.part * tick.twist).tolist()))
    for part in ({}, {"part": 0.25}):
        record = Bench(creep_rate_per_s=0.0, stages=stages, made_for_test=part).step()[1]
        np.testing.assert_allclose(record.twist, part.get("part", 0.5) * plain, rtol=1e-9)


@pytest.mark.parametrize("apply, status", [
    (lambda self, tick: tick.rest(avs.Status.STALE_INPUT, "held"), avs.Status.STALE_INPUT),
    (lambda self, tick: None, avs.Status.FAULT), (lambda self, tick: 1 / 0, avs.Status.FAULT),
    (lambda self, tick: tick.set(twist=[0.0] * 5), avs.Status.FAULT),
    (lambda self, tick: tick.set(twist=np.full(6, np.nan)), avs.Status.FAULT),
    (lambda self, tick: tick.set(twist=None), avs.Status.FAULT)])
def test_a_stage_may_stop_the_arm_and_whatever_it_does_wrong_stops_it(stage_that, apply, status):
    command, record = Bench(stages=stage_that(apply)).step()
    assert record.status == status and resting(command) and not record.twist.any()
    assert ("made_for_test" in record.status_text) == (status == avs.Status.FAULT)


@pytest.mark.parametrize("changes, key", [
    ({"stages": ["made_for_tst"]}, "stages"), ({"made_for_test": {"part": 2.0}}, "made_for_test.part"),
    ({"stages": ["made_for_test"], "mode": "look_then_move"}, "stages")])
def test_a_fault_of_a_stage_is_one_of_the_scenario(stage_that, changes, key):
    stage_that(None)
    with pytest.raises(avs.ParameterError) as caught:
        avs.Servo(arm(), config(**changes))
    assert [fault.replace("/", ".").split(": ")[0] for fault in caught.value.faults] == [f"servo.{key}"]


def test_the_gains_used_come_with_the_answer_and_a_list_is_a_twist():
    @avs.register_law("listed")
    class Listed(avs.Law):
        def _twist(self, look, s, e):
            return [0.0, 0.0, 0.01, 0.0, 0.0, 0.0]

    try:
        bench = Bench(law="listed", adaptive_gain={"infinity_part": 0.5, "slope": 4.0}, tilt_gain_per_s=0.0)
        _, record = bench.step()
        assert record.twist[2] == pytest.approx(0.01)
        assert bench.servo._tick.answer.twist.shape == (6,)
        used = bench.servo._tick.answer.gains_per_s
        assert len(used) == 4 and 1.5 < min(used) < 3.0  # the scenario's are 3 /s
    finally:
        from aras_visual_servo.laws.base import LAWS
        del LAWS["listed"]


def test_the_set_points_follow_an_arm_that_moves_while_the_target_is_lost():
    moves = LookThenMove(arm(), None, None, None, np.zeros(6))
    moves.rest(tick().rest(avs.Status.TARGET_LOST, "").set(q_dot=np.arange(6.0)))
    np.testing.assert_allclose(moves.set_point, DT_S * np.arange(6.0))


GAINS = dict.fromkeys(FEATURE_NAMES, 50.0)  # half of the error by each look
TILT_RAD = 0.01
#: Part of a tilt that a look leaves: 0.1, and what the arm's Jacobian turns on the way.
LEFT = 0.2


def tilted(joint, sign, **changes):
    return Bench(start={**GOAL, joint: GOAL[joint] + sign * TILT_RAD}, mode="look_then_move", gains_per_s=GAINS,
                 **changes)


def tilt_of(bench):
    """Angle between the optical axis and its taught direction [rad]."""
    return float(np.arccos(np.clip(bench.arm.pose(bench.q)[:3, 2] @ bench.X_WG[:3, 2], -1.0, 1.0)))


def look_once(bench):
    """Until the second look."""
    bench.step()
    while np.array_equal(bench.step()[1].e, bench.records[0].e):
        pass


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_look_takes_most_of_a_tilt_away(sign):
    bench = tilted("J5", sign)
    assert tilt_of(bench) == pytest.approx(TILT_RAD, rel=1e-6)
    look_once(bench)
    assert tilt_of(bench) < LEFT * TILT_RAD


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_tilt_is_gone_at_the_end_and_the_camera_at_its_goal(sign):
    bench = tilted("J5", sign)
    bench.run(400)
    distance, angle = pose_error(bench.X_WG, bench.arm.pose(bench.q))
    assert distance < 1e-5 and angle < 1e-5


def test_without_tilt_hold_a_look_leaves_the_tilt():
    bench = tilted("J5", 1.0, tilt_gain_per_s=0.0)
    look_once(bench)
    assert tilt_of(bench) > 0.9 * TILT_RAD


def test_a_move_is_called_short_only_where_a_joint_ends_it():
    free = tilted("J5", 1.0)
    free.step()
    assert free.records[-1].status == Status.SERVOING
    bench = tilted("J5", 1.0)
    bench.arm.upper[:], bench.arm.lower[:] = bench.set_point + 1e-4, bench.set_point - 1e-4
    bench.servo = Servo(bench.arm, config(mode="look_then_move", gains_per_s=GAINS))
    bench.servo.set_reference(free.servo.reference)
    bench.servo.start(0, bench.set_point)
    bench.step()
    assert bench.records[-1].status == Status.JOINT_LIMIT and "at its limit" in bench.records[-1].status_text


VIEW = VisibilitySettings(half_width=0.5, half_height=0.4, margin=0.02)


@pytest.fixture
def features():
    return Bench(start=GOAL).look().features


@pytest.mark.parametrize("axis, half, name", [(0, 0.5, "20"), (1, 0.4, "02")])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_each_border_the_edge_uses_up_its_room_as_fast_as_asked(features, axis, half, name, sign):
    twist = np.zeros(6)
    twist[axis] = sign * 2.0  # the object moves the other way
    kept, bent = keep_in_view(VIEW, features, twist)
    assert bent and (np.delete(kept, axis) == np.delete(twist, axis)).all() and abs(kept[axis]) < 2.0
    view = View(features, np.array([0.0, 0.0, 1.0 / features.an]))
    n, at = view.mu[name] / features.area, (features.xg, features.yg)[axis]
    L_spread = (view.L_mu(int(name[0]), int(name[1])) - n * view.L_area()) / features.area / n**0.5
    room = half - 0.02 + sign * at - 2.0 * n**0.5
    L_edge = -sign * centroid(view.m, view.plane)[axis] + L_spread
    assert float(L_edge @ kept) == pytest.approx(VIEW.rate_per_s * room, rel=1e-9)


@pytest.mark.parametrize("axis, name", [(0, "20"), (1, "02")])
def test_an_object_without_extent_along_an_axis_is_left_alone_there(features, axis, name):
    features.mu[features.moment_names.index(name)] = 0.0
    twist = np.array([2.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    kept, bent = keep_in_view(VIEW, features, twist)
    assert bent and kept[axis] == 2.0 and kept[1 - axis] < 2.0


def test_an_object_that_ends_beyond_a_border_is_brought_back_and_one_larger_than_the_view_is_not_held(features):
    twist = np.array([2.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    features.xg = features.yg = 0.3  # beyond two borders, well within the others
    kept, bent = keep_in_view(VisibilitySettings(half_width=0.3, half_height=0.3, margin=0.0), features, twist)
    assert bent and (kept[:2] < 2.0).all()
    features.xg = features.yg = 0.0
    small = VisibilitySettings(half_width=0.01, half_height=0.01, margin=0.0)
    kept, bent = keep_in_view(small, features, twist)
    assert kept is twist and not bent
