"""Limits of joints, and joints that a controller drives to and fro."""

import numpy as np
import pytest

from aras_visual_servo import accelerated, position_factor, velocity_factor
from aras_visual_servo.arm.motion import Chatter
from aras_visual_servo.arm.limits import end_factor, end_speeds, joint_bounds, limit_factors

ROUNDING = 1e-15  # of one division
LOWER, UPPER = np.array([-1.0, -np.inf]), np.array([1.0, np.inf])


@pytest.mark.parametrize("q_dot, velocity, factor", [
    ([1.0, -2.0], [1.0, 2.0], 1.0), ([3.0, -8.0], [2.0, 2.0], 0.25), ([0.0, 1e6], [1.0, np.inf], 1.0)])
def test_fastest_joint_relative_to_its_limit_sets_the_factor(q_dot, velocity, factor):
    assert velocity_factor(np.array(q_dot), np.array(velocity)) == pytest.approx(factor, abs=ROUNDING)


def test_motion_that_stays_inside_is_not_scaled():
    assert position_factor(np.array([0.9, 5.0]), np.array([0.5, 100.0]), LOWER, UPPER, 0.1) == (1.0, None)


@pytest.mark.parametrize("q", [[0.0, 0.0], [0.9, 0.0], [1.2, 0.0]])
@pytest.mark.parametrize("q_dot", [[0.5, 1.0], [3.0, -1.0], [-3.0, 8.0]])
def test_both_factors_come_in_one_call(q, q_dot):
    q, q_dot, velocity = np.array(q), np.array(q_dot), np.array([2.0, 4.0])
    assert limit_factors(q, q_dot, velocity, LOWER, UPPER, 0.1) == (
        velocity_factor(q_dot, velocity), *position_factor(q, q_dot, LOWER, UPPER, 0.1))


def test_acceleration_from_rest_keeps_the_direction():
    wanted, change = np.array([1.0, -3.0, 0.5]), np.array([0.5, 0.5, np.inf])
    found = accelerated(np.zeros(3), wanted, change)
    np.testing.assert_allclose(found, wanted / 6.0, atol=ROUNDING)  # the second joint asks for 3 where 0.5 are allowed


def test_acceleration_within_its_limit_changes_nothing():
    wanted = np.array([1.0, -3.0])
    for change in (0.2, np.inf):
        assert accelerated(np.array([0.9, -2.8]), wanted, np.full(2, change)) is wanted


def test_a_motion_that_turns_round_goes_a_part_of_the_way():
    before, wanted = np.array([1.0, 0.2]), np.array([-1.0, 0.4])
    found = accelerated(before, wanted, np.array([0.5, 0.5]))
    np.testing.assert_allclose(found, [0.5, 0.25], atol=ROUNDING)
    np.testing.assert_allclose(accelerated(np.array([1.0]), np.zeros(1), np.array([0.25])), [0.75], atol=ROUNDING)
    np.testing.assert_allclose(accelerated(np.array([0.1]), np.zeros(1), np.array([0.25])), [0.0], atol=ROUNDING)


def test_no_joint_ever_changes_by_more_than_it_may():
    random = np.random.default_rng(4)
    velocity, change = np.zeros(6), np.array([0.1, 0.2, 0.3, 0.1, 0.5, 0.2])
    for _ in range(500):
        new = accelerated(velocity, random.normal(size=6), change)
        assert (np.abs(new - velocity) <= change * (1.0 + 1e-12)).all()
        velocity = new


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_limit_of_a_joint_holds_on_its_own_side(sign):
    """The other limit is far: only this one binds."""
    lower, upper = (np.array([-1.0]), np.array([50.0])) if sign < 0.0 else (np.array([-50.0]), np.array([1.0]))
    beyond, towards, dt_s = sign * np.array([1.2]), sign * np.array([2.0]), 0.1
    assert position_factor(beyond, towards, lower, upper, dt_s) == (0.0, 0)
    assert position_factor(beyond, -towards, lower, upper, dt_s) == (1.0, None)
    factor, joint = position_factor(sign * np.array([0.9]), towards, lower, upper, dt_s)
    assert joint == 0 and factor == pytest.approx(0.5, abs=1e-14)
    assert position_factor(sign * np.array([0.9]), -towards, lower, upper, dt_s) == (1.0, None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_joint_brakes_before_either_limit(sign):
    lower, upper = (np.array([-1.0]), np.array([50.0])) if sign < 0.0 else (np.array([-50.0]), np.array([1.0]))
    q, q_dot, most, dt_s = sign * np.array([0.9]), sign * np.array([3.0]), np.array([2.0]), 0.1

    def factor(q, q_dot, most):
        return end_factor(q_dot, end_speeds(q, lower, upper, most, dt_s, 0.01))

    speed = 3.0 * factor(q, q_dot, most)[0]
    assert speed * dt_s + speed**2 / (2.0 * 2.0) == pytest.approx(0.1, rel=1e-12)
    assert factor(q, -q_dot, most) == (1.0, None)
    assert factor(sign * np.array([1.2]), q_dot, most) == (0.0, 0)
    assert factor(q, q_dot, np.array([np.inf])) == (1.0, None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_slowing_down_is_limited_as_speeding_up_is(sign):
    change = np.array([0.25])
    np.testing.assert_allclose(accelerated(sign * np.array([1.0]), sign * np.array([0.2]), change), [sign * 0.75],
                               atol=ROUNDING)
    np.testing.assert_allclose(accelerated(sign * np.array([0.2]), sign * np.array([1.0]), change), [sign * 0.45],
                               atol=ROUNDING)


def bounds(sign, before, room=0.1, acceleration=2.0, velocity=5.0, horizon_s=0.2):
    """(bound, whether it is that of the end of the way) on the side of `sign`, 0.1 s ahead, and the other bound."""
    ends = {"lower": -50.0, "upper": 50.0, ("upper" if sign > 0.0 else "lower"): sign * 1.0}
    low, high, at_stop, short = joint_bounds(
        np.array([sign * (1.0 - room)]), sign * np.array([before]), np.array([ends["lower"]]),
        np.array([ends["upper"]]), np.array([velocity]), np.array([acceleration]), 0.1, horizon_s)
    assert not short.any() and not at_stop[0 if sign > 0.0 else 1].any()
    found = (high, low)[sign < 0.0][0] * sign
    return found, bool(at_stop[1 if sign > 0.0 else 0][0]), -sign * (low, high)[sign < 0.0][0]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_bounds_leave_the_way_that_braking_takes_and_say_what_makes_them(sign):
    speed, at_stop, other = bounds(sign, before=0.4)
    assert speed * 0.1 + speed**2 / (2.0 * 2.0) == pytest.approx(0.1, rel=1e-12) and at_stop
    assert other == pytest.approx(-0.2)  # 0.4 m/s less what 2 m/s^2 change in the period
    assert bounds(sign, before=0.4, acceleration=np.inf)[:2] == (pytest.approx(0.5), True)  # the horizon
    assert bounds(sign, before=0.0)[:2] == (pytest.approx(0.2), False)  # the acceleration: 2 m/s^2 for 0.1 s
    assert bounds(sign, before=0.4, velocity=0.3)[:2] == (pytest.approx(0.3), False)
    assert bounds(sign, before=0.0, room=-0.1)[:2] == (pytest.approx(0.0), True)  # beyond its end


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_joint_that_cannot_brake_in_time_brakes_as_it_can(sign):
    lower, upper = (np.array([-1.0]), np.array([50.0])) if sign < 0.0 else (np.array([-50.0]), np.array([1.0]))
    low, high, _, short = joint_bounds(sign * np.array([0.99]), sign * np.array([3.0]), lower, upper, np.array([5.0]),
                                       np.array([2.0]), 0.1, 0.2)
    assert short.all() and low[0] == high[0] == pytest.approx(sign * 2.8)


@pytest.mark.filterwarnings("error")
def test_bounds_of_joints_without_any_limit_are_infinite():
    none = np.full(2, np.inf)
    low, high, at_stop, short = joint_bounds(np.zeros(2), np.zeros(2), -none, none, none, none, 0.03, 0.1)
    np.testing.assert_array_equal([low, high], [-none, none])
    assert not at_stop.any() and not short.any()


LIMIT = np.array([5.0, 5.0, np.inf])


def told(velocities):
    """Names found, image by image, of an arm whose second joint is told these velocities."""
    chatter = Chatter(("J1", "J2", "J3"), LIMIT)
    return [chatter.joint(np.array([0.1, velocity, 0.0])) for velocity in velocities]


def test_full_speed_both_ways_is_told_after_a_few_images_and_forgotten_after_a_few_more():
    found = told([4.8, -4.8] * 5 + [1.0] * 10)
    assert found[2] is None and found[3] == "J2" and found[9] == "J2" and found[-1] is None


@pytest.mark.parametrize("velocities", [[0.3, -0.3] * 20, [0.6, 0.7] * 9,
                                        [4.0] * 10 + [-4.0] * 10, ([4.0] * 6 + [-4.0] * 6) * 4])
def test_slow_trembling_and_turning_round_are_none(velocities):
    assert set(told(velocities)) == {None}


def test_a_joint_that_stood_still_begins_anew():
    chatter = Chatter(("J2",), LIMIT[:1])
    for velocity in (4.0, -4.0, 4.0):
        chatter.joint(np.array([velocity]))
    chatter.clear()
    assert chatter.joint(np.array([-4.0])) is None
