"""A standing arm says why: no run ends as TIMED_OUT with "servoing" as its only word while all joints rest."""

import itertools

import numpy as np
import pytest
from bench import Bench

from aras_visual_servo import Features, Law, Observation, register_law, register_stage, Stage, Status
from aras_visual_servo.servo.gates import STILL as STILL_SPEED
from toy_plant import arm, START

THRESHOLDS = {"xn": 0.0001, "yn": 0.0002, "an": 0.0001, "alpha": 0.0003}
#: The joints count as held when they stand still for this long before the end [s].
END_S = 0.4
JOINTS = arm().joint_names


@register_law("asks_for_nothing")
class Nothing(Law):
    def _twist(self, look, s, e):
        return np.zeros(6)


@register_stage("brakes")
class Brakes(Stage):
    def apply(self, tick):
        return tick.set(twist=np.zeros(6))


def moved(axis, metres):
    def change(bench):
        bench.camera.X_WT[axis, 3] += metres
    return change


def unseen(bench):
    look = bench.look

    def without():
        seen = look()
        return seen if seen.stamp_ns < 0.5e9 else Observation(seen.stamp_ns, Features(), seen.q)
    bench.look = without


def blind(bench):
    look = bench.look

    def without():
        seen = look()
        return seen if seen.stamp_ns < 0.5e9 else Observation(seen.stamp_ns, None, seen.q)
    bench.look = without


#: The spare motion too stands still.
STILL = {"posture_gain_per_s": 0.0, "joint_limit_gain_per_s": 0.0}
#: What happens -> (change of the bench, settings, word that the result has to say).
EVENTS = {
    "the gantry ends": (moved(1, 1.7), {}, "gantry"),
    "above the arm": (moved(2, 0.6), {}, "joint"),
    "below the arm": (moved(2, -0.3), {"time_limit_s": 14.0}, "forwards"),
    "before the arm": (moved(0, -0.4), {"time_limit_s": 14.0}, "v"),
    "no target": (unseen, {}, "view"),
    "no image": (blind, {}, "image"),
    "a law of no motion": (moved(0, 0.0), {"law": "asks_for_nothing", "null_space": STILL}, "law"),
    "a stage of no motion": (moved(0, 0.0), {"stages": ["brakes"], "null_space": STILL}, "brakes"),
    "rests for less than hold_s": (moved(0, 0.0), {"hold_s": 20.0, "time_limit_s": 8.0}, "rest"),
    "starts at the end of the gantry": (moved(1, 0.5), {"start": {**START, "gantry": 1.495}}, "gantry"),
}
ACCELERATION = {"joint_acceleration": dict.fromkeys(JOINTS, 5.0)}
OPTIONS = {
    "as it is": {}, "saturate": {"inverse": {"at_limits": "saturate"}}, "naive": {"inverse": {"method": "naive"}},
    "acceleration": {"limits": ACCELERATION},
    "acceleration, saturate": {"limits": ACCELERATION, "inverse": {"at_limits": "saturate"}},
    "visibility": {"visibility": {"half_width": 1.0, "half_height": 1.0}}, "filter": {"filter": {}},
    "smooth start": {"smooth_start_per_s": 5.0}, "search": {"on_lost": "search"}, "no creep": {"creep_rate_per_s": 0.0},
    "look then move": {"mode": "look_then_move", "gains_per_s": dict.fromkeys(THRESHOLDS, 60.0)},
}


def run_of(event, option):
    change, settings, word = EVENTS[event]
    settings = {"thresholds": THRESHOLDS, "time_limit_s": 4.0, **settings, **OPTIONS[option]}
    bench = Bench(start=settings.pop("start", START), **settings)
    change(bench)
    return bench, bench.run(450), word


def stands(record):
    return np.abs(record.q_dot).max() <= STILL_SPEED


@pytest.mark.parametrize("event, option", [(event, option) for event, option in itertools.product(EVENTS, OPTIONS)
                                           if "stages" not in EVENTS[event][1] or option != "look then move"])
def test_no_run_ends_at_rest_with_servoing_as_its_only_word(event, option):
    bench, last, word = run_of(event, option)
    assert last.status != Status.FAULT, last.status_text
    if last.status != Status.TIMED_OUT:
        return
    before = [record for record in bench.records[:-1] if last.stamp_ns - record.stamp_ns < 1e9 * END_S]
    for record in filter(stands, before):
        assert record.status_text and not record.status_text.startswith("servoing"), record
    if all(map(stands, before)):
        reason = before[-1].status_text.removeprefix("standing still, ")
        assert reason in last.status_text and (word in last.status_text or option == "look then move")


def test_most_of_these_runs_do_end_at_rest():
    """Otherwise the test above says nothing."""
    ends = [run_of(event, "as it is")[:2] for event in EVENTS]
    assert sum(last.status == Status.TIMED_OUT and stands(bench.records[-2]) for bench, last in ends) >= len(ends) - 1
