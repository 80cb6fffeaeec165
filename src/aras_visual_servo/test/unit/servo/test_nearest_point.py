"""`servo.out_of_reach`: the arm goes to the point that is nearest to an unreachable goal, rests there, and says so."""

import re

import numpy as np
import pytest
from bench import Bench, config
from toy_plant import pose_error

from aras_visual_servo import ParameterError, Servo, Status
from aras_visual_servo.arm.nearest import nearest
from aras_visual_servo.servo.nearest_point import direction

THRESHOLDS = {"xn": 0.0001, "yn": 0.0002, "an": 0.0001, "alpha": 0.0003}
#: Images that the arm may take to rest, and to end: 5 s and `rest_s` more.
REST, END = 150, 215
#: The features tell a goal that is some centimetres away to this.
TOLD_MM = 2.0
FAR = np.array([0.2, 0.1, 0.0])


def bench_of(way, **changes):
    changes = {"thresholds": THRESHOLDS, "out_of_reach": {}, **changes}
    bench = Bench(**{key: value for key, value in changes.items() if value is not None})
    bench.camera.X_WT[:3, 3] += way
    bench.X_WG[:3, 3] += way
    return bench


def missing_mm(bench):
    """Distance of the camera from the goal, and the least that the arm can have."""
    lower, upper = bench.arm.lower + 0.01, bench.arm.upper - 0.01
    best = nearest(bench.arm, bench.X_WG, bench.goal_q, lower, upper, steps=500)
    return 1e3 * pose_error(bench.X_WG, bench.arm.pose(bench.q))[0], 1e3 * best.sizes[0]


@pytest.mark.parametrize("way", [FAR, [-0.3, 0.0, 0.0], [0.0, 1.7, 0.0], [-0.06, 0.3, 0.0], [0.0, 0.0, -0.2]])
def test_the_arm_rests_at_the_nearest_point_and_the_servo_ends(way):
    bench = bench_of(np.array(way))
    last = bench.run(END)
    assert bench.servo.finished and last.status == Status.OUT_OF_REACH and not last.converged
    rests = next(i for i in range(len(bench.records)) if not any(r.q_dot.any() for r in bench.records[i:]))
    assert rests < REST
    off_mm, least_mm = missing_mm(bench)
    assert least_mm > 1.0 and off_mm - least_mm < TOLD_MM
    told_mm = float(re.match(r"out of reach by ([0-9.]+) mm", last.status_text).group(1))
    assert told_mm == pytest.approx(least_mm, abs=TOLD_MM, rel=0.05)
    assert ("gantry" in last.status_text) == (way[1] > 1.0)


def test_a_goal_within_reach_is_servoed_to_as_without_the_section():
    records = []
    for section in ({}, None):
        bench = bench_of(np.array([0.03, 0.2, 0.0]), out_of_reach=section)
        assert bench.run(400).status == Status.CONVERGED
        records.append(np.array([record.q for record in bench.records]))
    assert np.array_equal(*records)


@pytest.mark.parametrize("method, status", [("damped", Status.CONVERGED), ("naive", Status.JOINT_LIMIT)])
def test_an_arm_that_a_limit_holds_near_a_goal_within_reach_is_helped(method, status):
    """Where the scenario asks for another inverse, the page shows what that one does."""
    bench = bench_of(np.array([0.02, 1.46, 0.0]), inverse={"method": method})
    assert bench.run(END).status == status
    assert missing_mm(bench)[1] < 0.1


def test_the_law_goes_on_when_the_target_comes_back():
    bench = bench_of(FAR, out_of_reach={"rest_s": 60.0}, time_limit_s=30.0)
    assert bench.run(400).status == Status.OUT_OF_REACH and not bench.servo.finished
    bench.camera.X_WT[:3, 3] -= FAR
    bench.X_WG[:3, 3] -= FAR
    assert bench.run(400).status == Status.CONVERGED
    assert missing_mm(bench)[0] < 0.2


def test_a_resting_arm_follows_a_target_that_moves_out_of_reach():
    bench = bench_of(FAR, out_of_reach={"rest_s": 60.0}, time_limit_s=30.0)
    bench.run(REST)
    way = np.array([0.0, 0.2, 0.0])
    bench.camera.X_WT[:3, 3] += way
    bench.X_WG[:3, 3] += way
    assert bench.run(REST).status == Status.OUT_OF_REACH
    off_mm, least_mm = missing_mm(bench)
    assert off_mm - least_mm < TOLD_MM and not bench.records[-1].q_dot.any()


def test_a_goal_that_is_followed_does_not_end():
    bench = bench_of(FAR, track=True)
    assert bench.run(END + 30).status == Status.OUT_OF_REACH and not bench.servo.finished


def test_it_is_refused_where_the_arm_moves_to_positions():
    with pytest.raises(ParameterError, match="servo.out_of_reach|out_of_reach: found"):
        Servo(bench_of(FAR).arm, config(mode="look_then_move", out_of_reach={}))


@pytest.mark.parametrize("twist, words", [
    ([-0.1, 0.0, 0.2, 0.0, 0.0, 0.0], "forwards and to the left"),
    ([0.0, -0.1, 0.0, 0.1, 0.0, 0.0], "up and by a turn up"),
    ([0.1, 0.1, -0.01, 0.0, 0.0, 0.0], "to the right and down"),
    ([0.0, 0.0, 0.0, 0.0, -0.1, 0.0], "by a turn to the left"),
    ([0.0, 0.0, 0.0, 0.0, 0.0, 0.1], "by a roll clockwise")])
def test_a_direction_is_told_as_seen_in_the_image(twist, words):
    assert direction(np.array(twist)) == words
