"""Null-space bars: what each joint does for the camera, and what it does while the camera rests."""

import numpy as np
import pytest
from bench import config
from toy_plant import GOAL, START, arm

from aras_visual_servo_controller.nodes.null_space_bars import CAMERA, NULL_SPACE, draw, shares
from aras_visual_servo.arm.redundancy import FREE
from aras_visual_servo.servo.servo import Servo

ROUNDING = 1e-10  # eps times the largest 1 / sigma and the largest scaled entry, with room for the SVD
LENGTH_M, THRESHOLD = 0.05, 0.02
SCALE = np.array([1.0 / LENGTH_M] * 3 + [1.0] * 3)
Q_DOT = np.array([0.3, -0.2, 0.4, 0.1, -0.5, 0.25])
WEIGHTS = {"J1": 3.0, "gantry": 2.0}


def servo(**changes):
    kinematics = arm()
    return kinematics, Servo(kinematics, config(**changes))


@pytest.mark.parametrize("place", [GOAL, START, {**START, "J5": START["J5"] + 0.0004}])
@pytest.mark.parametrize("weights", [{}, WEIGHTS])
def test_parts_sum_to_the_velocity_and_the_null_part_leaves_the_camera_at_rest(place, weights):
    kinematics, split_by = servo(inverse={"joint_weights": weights})
    q = kinematics.vector(place)
    camera, null = split_by.split(q, Q_DOT)
    np.testing.assert_allclose(camera + null, Q_DOT, rtol=0.0, atol=1e-15)
    assert np.linalg.norm(null) > 0.1  # looking straight down, J1 and J6 may turn against each other
    # FREE says how much of a free motion the camera may see; with weights its size is that of the weighted joints.
    size = np.linalg.norm(null * [weights.get(name, 1.0) for name in kinematics.joint_names])
    assert np.linalg.norm(SCALE * (kinematics.jacobian(q) @ null)) <= FREE * THRESHOLD * size + ROUNDING
    np.testing.assert_allclose(split_by.split(q, null)[1], null, atol=ROUNDING)
    np.testing.assert_allclose(split_by.split(q, camera)[1], 0.0, atol=ROUNDING)


def test_an_arm_that_has_nothing_to_spare_shows_no_null_space_motion():
    kinematics, split_by = servo()
    q = kinematics.vector({**START, "J5": START["J5"] + 0.3})  # tilted: six joints for six degrees of freedom
    camera, null = split_by.split(q, Q_DOT)
    assert (null == 0.0).all() and (camera == Q_DOT).all()


def test_the_twist_of_the_inverse_is_camera_motion_and_its_free_part_is_not():
    kinematics, _ = servo()
    arm_motion = Servo(kinematics, config())._arm
    q = kinematics.vector(START)
    inverse = arm_motion.at(q)[1]
    of_twist, free = inverse.joint_velocity(np.array([0.02, -0.01, 0.03, 0.0, 0.0, 0.2])), inverse.free(Q_DOT)
    camera, null = arm_motion.split(q, of_twist + free)
    np.testing.assert_allclose(camera, of_twist, atol=ROUNDING)
    np.testing.assert_allclose(null, free, atol=ROUNDING)


def test_shares_are_parts_of_the_velocity_limits():
    limits = np.array([2.0, 4.0, np.inf])
    q_dot = np.array([1.0, -2.0, 0.5])
    camera, null = shares(lambda q, q_dot: (0.75 * q_dot, 0.25 * q_dot), np.zeros(3), q_dot, limits)
    np.testing.assert_allclose(camera, [0.375, -0.375, 0.375])
    np.testing.assert_allclose(null, [0.125, -0.125, 0.125])


@pytest.mark.parametrize("q, q_dot", [([], []), ([np.nan, 0.0], [0.0, 0.0]), ([0.0, 0.0], [np.inf, 0.0])])
def test_without_positions_or_velocities_there_are_no_bars(q, q_dot):
    camera, null = shares(None, q, q_dot, np.ones(2))  # nothing to split: it is not called
    assert (camera == 0.0).all() and (null == 0.0).all() and len(camera) == len(null) == 2


def area(picture, colour, columns):
    return int((picture[80:, columns] == colour).all(axis=2).sum())


def test_bars_point_to_the_side_of_the_sign_and_stay_in_the_picture():
    names, still = ("J1", "J2"), np.zeros(2)
    left, right, rest = slice(74, 223), slice(228, 377), draw(names, still, still)
    one, two = draw(names, np.array([0.25, 0.0]), still), draw(names, np.array([1.0, 0.0]), still)
    assert one.shape == rest.shape == (90 + 2 * 40 + 6, 440, 3) and one.dtype == np.uint8
    assert area(one, CAMERA, right) > 1000 and area(one, CAMERA, left) == area(rest, CAMERA, left)
    assert area(two, CAMERA, right) == pytest.approx(2 * area(one, CAMERA, right), rel=0.05)  # square root of 4
    assert (draw(names, np.array([9.0, 0.0]), still)[:, :377] == two[:, :377]).all()  # longer than the axis: cut there
    both = draw(names, still, np.array([0.0, -0.25]))
    assert area(both, NULL_SPACE, left) > 1000 and area(both, NULL_SPACE, right) == area(rest, NULL_SPACE, right)
