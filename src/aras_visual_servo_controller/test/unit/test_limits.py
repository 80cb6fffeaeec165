"""Velocity and position limits."""

import numpy as np
import pytest

from aras_visual_servo_controller.limits import position_factor, velocity_factor

ROUNDING = 1e-15  # of one division
LOWER, UPPER = np.array([-1.0, -np.inf]), np.array([1.0, np.inf])


def test_velocity_within_limits_is_not_scaled():
    assert velocity_factor(np.array([1.0, -2.0]), np.array([1.0, 2.0])) == 1.0


def test_fastest_joint_relative_to_its_limit_sets_the_factor():
    assert velocity_factor(np.array([3.0, -8.0]), np.array([2.0, 2.0])) == pytest.approx(0.25, abs=ROUNDING)


def test_joint_without_velocity_limit_is_not_scaled():
    assert velocity_factor(np.array([0.0, 1e6]), np.array([1.0, np.inf])) == 1.0


def test_motion_that_stays_inside_is_not_scaled():
    assert position_factor(np.array([0.9, 5.0]), np.array([0.5, 100.0]), LOWER, UPPER, 0.1) == (1.0, None)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_predicted_violation_is_scaled_to_end_at_the_limit(sign):
    factor, joint = position_factor(sign * np.array([0.9, 0.0]), sign * np.array([2.0, 1.0]), LOWER, UPPER, 0.1)
    assert joint == 0
    assert factor == pytest.approx(0.5, abs=1e-14)  # rounding of 1 - 0.9 relative to 0.1


def test_joint_beyond_its_limit_may_only_move_back():
    q = np.array([1.2, 0.0])
    assert position_factor(q, np.array([0.1, 0.0]), LOWER, UPPER, 0.1) == (0.0, 0)
    assert position_factor(q, np.array([-0.1, 0.0]), LOWER, UPPER, 0.1) == (1.0, None)
