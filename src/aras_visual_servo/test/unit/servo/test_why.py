"""What the servo says beside its status: what held the arm back, and that the target is not where it was taught."""

import re
from types import SimpleNamespace

import numpy as np
import pytest
from bench import Bench

from aras_visual_servo import Status, StopSettings, Tick
from aras_visual_servo.servo.arrival import DISPLACED, displaced_target
from aras_visual_servo.servo.gates import FREE_S, Hindrance, TimeLimit
from aras_visual_servo.spatial import exponential, rotation

STOP = {"tilt_rad": 0.0003, "position_m": 0.0002, "rotation_rad": 0.0004}
THRESHOLDS = {"xn": 0.0001, "yn": 0.0002, "an": 0.0001, "alpha": 0.0003}


def in_words(text):
    """(mm, deg) of the sentence about a displaced target."""
    found = re.search(r"the target is found ([0-9.]+) mm and ([0-9.]+) deg from where it was taught", text)
    return None if found is None else tuple(map(float, found.groups()))


@pytest.mark.parametrize("axis, sign", [(0, 1.0), (1, 1.0), (1, -1.0)])
def test_the_result_says_how_far_the_target_is_from_where_it_was_taught(axis, sign):
    bench = Bench(thresholds=THRESHOLDS, stop=STOP)
    for _ in range(20):
        bench.step()
    bench.camera.X_WT[axis, 3] += 0.02 * sign
    last = bench.run()
    assert last.status == Status.CONVERGED
    distance_mm, angle_deg = in_words(last.status_text)
    assert distance_mm == pytest.approx(20.0, abs=0.3) and angle_deg < 0.1


def test_a_turned_target_is_told_by_its_angle():
    bench = Bench(thresholds=THRESHOLDS, stop=STOP)
    bench.camera.X_WT[:3, :3] = rotation([0.0, 0.0, 0.2]) @ bench.camera.X_WT[:3, :3]
    last = bench.run()
    assert last.status == Status.CONVERGED
    assert in_words(last.status_text)[1] == pytest.approx(np.degrees(0.2), abs=0.1)


def test_a_target_at_rest_is_not_spoken_of():
    last = Bench(thresholds=THRESHOLDS, stop=STOP).run()
    assert last.status == Status.CONVERGED and "target is found" not in last.status_text


def test_a_goal_that_may_move_or_looks_the_same_from_two_sides_is_not_spoken_of():
    for changes in ({"track": True, "time_limit_s": 8.0}, {"symmetric_target": True}):
        bench = Bench(thresholds=THRESHOLDS, stop=STOP, **changes)
        bench.camera.X_WT[0, 3] += 0.02
        last = bench.run()
        assert last.status == Status.CONVERGED and "target is found" not in last.status_text, changes


@pytest.mark.parametrize("part, told", [(0.99, False), (1.01, True)])
@pytest.mark.parametrize("index, unit", [(0, "position_m"), (1, "position_m"), (2, "position_m"),
                                         (3, "rotation_rad"), (4, "rotation_rad"), (5, "rotation_rad")])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_displacement_that_is_told(index, unit, part, told, sign):
    stop = StopSettings(**STOP)
    twist = np.zeros(6)
    twist[index] = sign * part * DISPLACED * getattr(stop, unit)
    assert bool(displaced_target(exponential(twist), np.zeros(6), stop)) is told
    # The same displacement, seen in the image too, is the camera's own.
    assert displaced_target(exponential(twist), twist, stop) == ""
    assert displaced_target(exponential(twist), None, stop) == ""


def test_half_a_turn_is_told_whole():
    stop = StopSettings(**STOP)
    X = np.diag([-1.0, -1.0, 1.0, 1.0])
    assert in_words(displaced_target(X, np.zeros(6), stop))[1] == pytest.approx(180.0)


def test_a_goal_out_of_the_joints_reach_ends_with_the_joint_and_for_how_long():
    bench = Bench(thresholds=THRESHOLDS, stop=STOP, time_limit_s=6.0, inverse={"at_limits": "saturate"})
    bench.camera.X_WT[1, 3] += 1.5
    last = bench.run()
    assert last.status == Status.TIMED_OUT
    found = re.search(r"for the last ([0-9.]+) s the arm could not follow the law \((.*)\)", last.status_text)
    assert found and "gantry" in found.group(2)
    assert 1.0 < float(found.group(1)) < 6.0


def test_a_goal_that_the_arm_cannot_stand_at_ends_with_the_reason():
    bench = Bench(thresholds=THRESHOLDS, stop=STOP)
    bench.camera.X_WT[0, 3] -= 0.02  # towards the stretched elbow
    last = bench.run()
    assert last.status == Status.TIMED_OUT and "the arm could not follow the law" in last.status_text


def test_a_hindrance_is_forgotten_when_the_arm_has_been_free():
    hindrance = Hindrance()
    assert hindrance.words(0) == ""
    hindrance.seen(1_000_000_000, "joint 'a' at its limit")
    hindrance.seen(1_400_000_000, "joint 'b' at its limit")
    assert "last 0.4 s" in hindrance.words(1_400_000_000) and "joint 'b'" in hindrance.words(1_400_000_000)
    later = 1_400_000_000 + round(1e9 * FREE_S) + 1
    assert hindrance.words(later) == ""
    hindrance.seen(later, "joint 'c' at its limit")
    assert "last 0.0 s" in hindrance.words(later)


def test_the_servo_says_it_while_it_servos():
    bench = Bench(thresholds=THRESHOLDS, stop=STOP)
    bench.camera.X_WT[0, 3] += 0.02
    bench.run()
    assert any(record.status == Status.SERVOING and in_words(record.status_text) for record in bench.records)


@pytest.mark.parametrize("given", [("lacking",), ("held",), ("displaced",), ("lacking", "held"),
                                   ("lacking", "held", "displaced")])
def test_a_servo_that_runs_out_of_time_gives_every_reason_and_no_empty_one(given):
    def told(name):
        return name if name in given else ""

    arrival = SimpleNamespace(rule=SimpleNamespace(why_not=lambda: told("lacking")), displaced=told("displaced"))
    hindrance = SimpleNamespace(words=lambda stamp_ns: told("held"))
    limit = TimeLimit(SimpleNamespace(time_limit_s=0.2, track=False), 0, arrival, hindrance)
    tick = Tick(210_000_000, 0.1, None, np.zeros(6), None)
    assert limit.apply(tick).text.split(": ")[1] == "; ".join(given)
    assert limit.apply(tick.set(stamp_ns=190_000_000, q_dot=None)).q_dot is None
