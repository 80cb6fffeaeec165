"""Stages one by one, and stages of one's own."""

from dataclasses import dataclass

import numpy as np
import pytest
from bench import DT_S, Bench, config, resting
from toy_plant import arm

import aras_visual_servo as avs
from aras_visual_servo.servo.look_then_move import LookThenMove
from aras_visual_servo.servo.stage import STAGES, Tick
from aras_visual_servo.servo.stages import SmoothStart

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
    moves = LookThenMove(arm(), None, None, None, None, np.zeros(6))
    moves.rest(tick().rest(avs.Status.TARGET_LOST, "").set(q_dot=np.arange(6.0)))
    np.testing.assert_allclose(moves.set_point, DT_S * np.arange(6.0))
