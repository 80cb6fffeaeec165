"""Inverse of the arm: what is lost, what is damped, what is free."""

from types import SimpleNamespace

import numpy as np
import pytest
from toy_plant import GOAL, START, arm

from aras_visual_servo.arm.redundancy import FREE, TwistInverse, Wish
from aras_visual_servo.ground.errors import NotFiniteError, ShapeError

ROUNDING = 1e-10  # eps times the largest 1 / sigma (14) and the largest scaled entry (20), with room for the SVD
REST = np.zeros(6)
THRESHOLD = 0.02


class Solver:
    """Everything an inverse says about one twist."""

    def __init__(self, weights, length_m=0.05):
        self.invert = TwistInverse(weights, length_m, THRESHOLD, 0.02)

    def solve(self, J, twist, wish):
        inverse = self.invert(J)
        return SimpleNamespace(q_dot=inverse.joint_velocity(twist), null=inverse.free(wish), lost=inverse.lost(twist),
                               achieved=inverse.achieved(twist), manipulability=inverse.manipulability)  # fmt: skip


def inverse(weights=(1.0,) * 6):
    return Solver(weights)


@pytest.mark.parametrize("place", [GOAL, START])
@pytest.mark.parametrize("index", [0, 1, 2, 5])
def test_looking_straight_down_every_servoed_twist_is_achieved_exactly(place, index):
    kinematics = arm()
    J = kinematics.jacobian(kinematics.vector(place))
    twist = 0.01 * np.eye(6)[index]
    result = inverse().solve(J, twist, REST)
    np.testing.assert_allclose(J @ result.q_dot, twist, atol=ROUNDING)
    assert result.lost < ROUNDING


def test_height_at_the_nearly_stretched_goal_is_not_slowed_by_damping():
    kinematics = arm()
    J = kinematics.jacobian(kinematics.vector(GOAL))
    q_dot = inverse().solve(J, np.array([0, 0, 0.001, 0, 0, 0]), REST).q_dot
    assert (J @ q_dot)[2] == pytest.approx(0.001, rel=1e-9)  # 1 % would do; nothing is damped above the threshold
    assert np.abs(q_dot).max() > 0.1  # which takes about 0.2 rad/s of the elbow


def test_lost_tilt_gets_no_motion_and_is_reported():
    kinematics = arm()
    J = kinematics.jacobian(kinematics.vector(GOAL))
    result = inverse().solve(J, np.array([0, 0, 0, 0.1, 0, 0]), REST)  # about the camera's x: in the arm's plane
    np.testing.assert_allclose(result.q_dot, 0.0, atol=ROUNDING)
    assert result.lost == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("tilt", [1e-6, 1e-4, 1e-3, 5e-3, 1e-2])
def test_near_the_lost_direction_joint_speeds_stay_bounded(tilt):
    kinematics = arm()
    q = kinematics.vector(GOAL)
    q[kinematics.joint_names.index("J5")] += tilt
    q_dot = inverse().solve(kinematics.jacobian(q), np.array([0, 0, 0, 0.01, 0, 0]), REST).q_dot
    # sigma / (sigma^2 + lambda^2) is at most 1 / threshold for lambda = threshold; J2 and J3 compensate little
    assert np.abs(q_dot).max() <= 0.01 / THRESHOLD


def test_gain_does_not_jump_at_the_threshold():
    gains = []
    for sigma in (THRESHOLD * (1.0 - 1e-9), THRESHOLD * (1.0 + 1e-9)):
        J = np.diag([0.05, 0.05, 0.05 * sigma, 1.0, 1.0, 1.0])
        gains.append(inverse().solve(J, np.array([0, 0, 1.0, 0, 0, 0]), REST).q_dot[2])
    assert gains[0] == pytest.approx(gains[1], rel=1e-8)  # slope of the rule times the distance, 2e-9


@pytest.mark.parametrize("place", [GOAL, START])
def test_free_motion_centres_the_first_joint_and_does_not_move_the_camera(place):
    kinematics = arm()
    q = kinematics.vector({**place, "J1": 0.3})
    J = kinematics.jacobian(q)
    wish = Wish(kinematics.lower, kinematics.upper, 0.5, 0.0, 0.2)(q, kinematics.vector(place))
    null = inverse().solve(J, REST, wish).null
    assert null[0] < -0.01
    np.testing.assert_allclose(J @ null, 0.0, atol=ROUNDING)


@pytest.mark.parametrize("tilt", [1e-5, 1e-4, 1e-3, 1e-2])
def test_free_motion_disturbs_less_than_its_documented_bound_when_tilted(tilt):
    kinematics = arm()
    q = kinematics.vector({**START, "J1": 0.3})
    q[3] += tilt
    J = kinematics.jacobian(q)
    null = inverse().solve(J, REST, np.array([-0.2, 0, 0, 0, 0, 0])).null
    moved = J @ null / np.array([0.05] * 3 + [1.0] * 3)
    assert np.linalg.norm(moved) <= FREE * THRESHOLD * 0.2


def test_costly_joint_moves_less():
    kinematics = arm()
    J = kinematics.jacobian(kinematics.vector(START))
    spin = np.array([0, 0, 0, 0, 0, 0.1])
    even, costly = inverse().solve(J, spin, REST).q_dot, inverse((5.0, 1, 1, 1, 1, 1)).solve(J, spin, REST).q_dot
    assert abs(costly[0]) < 0.1 * abs(even[0])
    np.testing.assert_allclose(J @ costly, spin, atol=ROUNDING)


def test_manipulability_leaves_the_lost_tilt_out_and_falls_with_the_elbow():
    kinematics = arm()
    values = [
        inverse().solve(kinematics.jacobian(kinematics.vector(place)), REST, REST).manipulability
        for place in ({**GOAL, "J3": q3, "J5": 0.09 - q3} for q3 in (0.3, 0.045, 0.005))
    ]
    assert values[0] > values[1] > values[2] > 0.0
    assert values[1] == pytest.approx(0.0698, abs=5e-5)  # as printed by numpy for the published goal


def test_inverse_of_a_five_joint_arm_reports_what_it_cannot_do():
    J = np.eye(6)[:, :5]
    result = Solver(np.ones(5), 1.0).solve(J, np.array([1.0, 2, 3, 4, 5, 6]), np.zeros(5))
    np.testing.assert_allclose(result.q_dot, [1, 2, 3, 4, 5], atol=ROUNDING)
    assert result.lost == pytest.approx(6.0, abs=ROUNDING)


def test_seventh_joint_is_free():
    J = np.hstack([np.eye(6), np.zeros((6, 1))])
    result = Solver(np.ones(7), 1.0).solve(J, np.zeros(6), np.full(7, 0.1))
    np.testing.assert_allclose(result.null, [0, 0, 0, 0, 0, 0, 0.1], atol=ROUNDING)


@pytest.mark.parametrize("tilt", [0.0, 1e-3, 1e-2, 0.1])
def test_achieved_part_is_what_the_joint_velocities_do(tilt):
    kinematics = arm()
    q = kinematics.vector(GOAL)
    q[3] += tilt
    J, twist = kinematics.jacobian(q), np.array([0.01, -0.02, 0.001, 0.1, -0.05, 0.2])
    result = inverse().solve(J, twist, REST)
    np.testing.assert_allclose(J @ result.q_dot, result.achieved, atol=ROUNDING)
    missed = (twist - result.achieved) / np.array([0.05] * 3 + [1.0] * 3)
    assert result.lost == pytest.approx(np.linalg.norm(missed), abs=ROUNDING)


def test_a_jacobian_of_other_joints_or_with_nan_is_refused():
    with pytest.raises(ShapeError, match="jacobian: 5 columns, expected 6"):
        inverse().invert(np.eye(6)[:, :5])
    with pytest.raises(ShapeError, match="joint velocities: 5 values, expected 6"):
        inverse().invert(np.eye(6)).free(np.zeros(5))
    with pytest.raises(NotFiniteError, match="jacobian"):
        inverse().invert(np.full((6, 6), np.nan))


def test_equal_jacobians_give_equal_bytes_whatever_their_layout():
    J = arm().jacobian(np.linspace(-0.3, 0.4, 6))
    twist, wish = np.linspace(0.1, 0.6, 6), np.linspace(-0.2, 0.1, 6)
    one, other = (inverse().solve(like(J), twist, wish) for like in (np.ascontiguousarray, np.asfortranarray))
    assert one.q_dot.tobytes() == other.q_dot.tobytes() and one.null.tobytes() == other.null.tobytes()


LOWER, UPPER = np.array([-1.0, -np.inf]), np.array([3.0, np.inf])


def test_wish_leaves_limits_with_the_cube_of_the_distance_from_the_middle():
    wish = Wish(LOWER, UPPER, 0.0, 0.5, 10.0)
    np.testing.assert_allclose(wish(np.array([3.0, 9.0])), [-1.0, 0.0], atol=ROUNDING)
    np.testing.assert_allclose(wish(np.array([2.0, 9.0])), [-0.125, 0.0], atol=ROUNDING)


def test_wish_returns_to_the_posture_within_its_speed():
    wish = Wish(LOWER, UPPER, 2.0, 0.0, 0.5)
    np.testing.assert_allclose(wish(np.array([1.1, 9.0]), np.array([1.0, 9.1])), [-0.2, 0.2], atol=ROUNDING)
    np.testing.assert_allclose(wish(np.array([3.0, 9.0]), np.array([1.0, 9.1])), [-0.5, 0.025], atol=ROUNDING)


def test_a_turn_about_a_point_is_what_the_arm_achieves_of_it_and_keeps_the_point():
    kinematics, turn, point = arm(), (0.03, -0.05), np.array([0.1, -0.2, 0.6])
    found = TwistInverse((1.0,) * 6)(kinematics.jacobian(kinematics.vector(GOAL)))
    twist = found.turn_about(turn, point)
    achieved = found.achieved(np.array([0.0, 0.0, 0.0, *turn, 0.0]))
    assert twist[3:].tolist() == [achieved[3], achieved[4], 0.0] and not np.allclose(twist[3:5], turn)
    np.testing.assert_allclose(twist[:3] + np.cross(twist[3:], point), 0.0, atol=ROUNDING)


@pytest.mark.parametrize("most_part", [1e-3, 10.0])
def test_the_correction_for_another_jacobian_is_the_inverse_of_the_difference_and_bounded(most_part):
    kinematics = arm()
    q, q_dot = kinematics.vector(START), np.array([0.3, -0.1, 0.2, 0.4, -0.3, 0.1])
    J, half_way = kinematics.jacobian(q), kinematics.jacobian(q + 0.01 * q_dot)
    found = TwistInverse((1.0,) * 6)(J)
    wanted = found.joint_velocity((J - half_way) @ q_dot)
    assert 1e-3 < np.linalg.norm(wanted) / np.linalg.norm(q_dot) < 10.0  # so that one bound acts, the other does not
    wanted *= min(1.0, most_part * np.linalg.norm(q_dot) / np.linalg.norm(wanted))
    np.testing.assert_allclose(found.turning(J, half_way, q_dot, most_part), wanted, atol=ROUNDING)
    with pytest.raises(ShapeError, match="jacobian: 6 and 5 columns"):
        found.turning(J, half_way[:, :5], q_dot, most_part)


@pytest.mark.parametrize("more", [None, np.array([0.3, -0.2, 0.1, 0.4, -0.5, 0.05])])
@pytest.mark.parametrize("posture", [None, np.array([0.1, 0.4, -0.3, 0.2, 0.5, -0.1])])
def test_velocities_with_a_wish_are_those_of_the_twist_and_the_free_part_of_it_bit_for_bit(posture, more):
    kinematics = arm()
    q = kinematics.vector(GOAL)
    inverse = TwistInverse((1.0,) * 6, 0.05, THRESHOLD, 0.02)(kinematics.jacobian(q))
    wish, twist = Wish(kinematics.lower, kinematics.upper, 0.5, 0.2, 1.0), np.array([0.02, -0.01, 0.03, 0, 0, 0.2])
    found = inverse.with_wish(twist, wish, q, posture, more)
    np.testing.assert_array_equal(found, inverse.joint_velocity(twist) + inverse.free(wish(q, posture, more)))
    assert (found != inverse.joint_velocity(twist)).any()
