"""Look then move: what a move does beside what the law asks for."""

import numpy as np
import pytest
from bench import Bench, config
from toy_plant import GOAL, pose_error

from aras_visual_servo import FEATURE_NAMES, Servo, Status

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
