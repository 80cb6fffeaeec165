"""Damping of the inverse, and the quadratic programs that joints with limits lead to."""

import numpy as np
import pytest
from scipy.optimize import linprog, minimize
from toy_plant import arm, GOAL, START

from aras_visual_servo import NotFiniteError, ShapeError, TwistInverse
from aras_visual_servo._kinematics import solve_program
from aras_visual_servo.arm.damping import FILTER_PART, RULES
from aras_visual_servo.arm.redundancy import METHODS, norm_part

ROUNDING = 1e-10  # as in test_redundancy.py
THRESHOLD, DAMPING = 0.02, 0.03
#: Bent, turned and tilted: no row or column of the Jacobian vanishes.
POSE = {"gantry": 0.3, "J1": 0.4, "J2": -0.5, "J3": 0.8, "J5": 0.3, "J6": 0.6}
TWIST = np.array([0.02, -0.03, 0.01, 0.1, -0.2, 0.15])


def inverse(method, J, length_m=1.0):
    return TwistInverse(np.ones(J.shape[1]), length_m, THRESHOLD, DAMPING, method)(J)


def gains(method, sigmas):
    """Of a Jacobian with these singular values: joint rate by unit twist, direction by direction."""
    J = np.diag(sigmas)
    return [float(inverse(method, J).joint_velocity(row)[i]) for i, row in enumerate(np.eye(6))]


@pytest.mark.parametrize("method", [method for method in METHODS if method not in ("transpose", "constant")])
def test_far_from_singularities_every_rule_is_the_plain_inverse(method):
    J = arm().jacobian(arm().vector(POSE))
    np.testing.assert_allclose(J @ inverse(method, J, 0.05).joint_velocity(TWIST), TWIST, atol=ROUNDING)


WEAK = 0.5 * THRESHOLD
LARGE = [3.0, 2.0, 1.5, 1.0, 0.5]


@pytest.mark.parametrize("method, last, first", [
    ("damped", WEAK / (WEAK**2 + 0.75 * DAMPING**2), 1.0 / 3.0),  # 1 - (1/2)^2 of the damping, on the weak one only
    ("naive", 0.0, 1.0 / 3.0),
    ("plain", 1.0 / WEAK, 1.0 / 3.0),
    ("constant", WEAK / (WEAK**2 + DAMPING**2), 3.0 / (9.0 + DAMPING**2)),
    ("nakamura_hanafusa", WEAK / (WEAK**2 + 0.25 * DAMPING**2), 3.0 / (9.0 + 0.25 * DAMPING**2)),
    ("maciejewski_klein", WEAK / (WEAK**2 + (1.0 + FILTER_PART**2) * DAMPING**2),
     3.0 / (9.0 + (FILTER_PART * DAMPING)**2)),
    ("chiaverini", WEAK / (WEAK**2 + 0.75 * (1.0 + FILTER_PART**2) * DAMPING**2),
     3.0 / (9.0 + 0.75 * (FILTER_PART * DAMPING)**2))])
def test_gains_of_a_weak_and_of_a_strong_direction_are_those_of_the_rule(method, last, first):
    found = gains(method, [*LARGE, WEAK])
    assert found[-1] == pytest.approx(last, rel=1e-12) and found[0] == pytest.approx(first, rel=1e-12)


@pytest.mark.parametrize("method", [m for m in RULES if m != "plain"])
def test_a_lost_direction_gets_no_motion(method):
    assert gains(method, [*LARGE, 0.0])[-1] == 0.0
    assert gains(method, [*LARGE, 1e-13])[-1] < 1e-9


@pytest.mark.parametrize("method", ["damped", "nakamura_hanafusa", "chiaverini"])
def test_smooth_rules_do_not_jump_at_the_threshold(method):
    below, above = (gains(method, [*LARGE, THRESHOLD * factor])[-1] for factor in (1.0 - 1e-9, 1.0 + 1e-9))
    assert below == pytest.approx(above, rel=1e-7)  # slope of the rules, up to 1e2, times the distance


def test_transpose_goes_along_the_twist_as_far_as_one_step_can():
    J = arm().jacobian(arm().vector(POSE))
    made = inverse("transpose", J, 0.05)
    q_dot = made.joint_velocity(TWIST)
    rows = np.array([20.0] * 3 + [1.0] * 3)
    direction = (rows[:, None] * J).T @ (rows * TWIST)
    np.testing.assert_allclose(q_dot / np.linalg.norm(q_dot), direction / np.linalg.norm(direction), atol=ROUNDING)
    np.testing.assert_allclose(J @ q_dot, made.achieved(TWIST), atol=ROUNDING)
    sizes = [np.linalg.norm(rows * (TWIST - factor * (J @ q_dot))) for factor in (0.99, 1.0, 1.01)]
    assert sizes[1] < min(sizes[0], sizes[2])
    assert made.lost(TWIST) == pytest.approx(sizes[1], rel=1e-12)


def test_projection_onto_the_norm_keeps_the_rate_along_the_twist_and_nothing_else():
    J, wish = arm().jacobian(arm().vector(POSE)), np.array([0.1, -0.2, 0.3, 0.1, -0.1, 0.05])
    made, rows = inverse("damped", J, 0.05), np.array([20.0] * 3 + [1.0] * 3)
    assert np.linalg.norm(made.free(wish)) < ROUNDING  # six rows, six joints: gradient projection has nothing to spare
    free = made.free_of_norm(wish, TWIST)
    moved = rows * (J @ free)
    assert abs(moved @ (rows * TWIST)) < 1e-8 * np.linalg.norm(moved) * np.linalg.norm(rows * TWIST)
    assert np.linalg.norm(free) > 0.5 * np.linalg.norm(wish) and np.linalg.norm(moved) > 0.1
    np.testing.assert_allclose(made.free_of_norm(free, TWIST), free, atol=ROUNDING)  # a projection
    np.testing.assert_allclose(made.free_of_norm(wish, np.zeros(6)), wish, atol=ROUNDING)


def test_weight_of_the_norm_rises_smoothly_between_its_bounds():
    weights = [norm_part(size, 0.1, 0.5) for size in (0.0, 0.1, 0.1 + 1e-9, 0.3, 0.5 - 1e-9, 0.5, 9.0)]
    np.testing.assert_allclose(weights, [0, 0, 0, 0.5, 1, 1, 1], atol=1e-8)
    assert norm_part(0.2, 0.1, 0.5) < norm_part(0.4, 0.1, 0.5)


@pytest.mark.parametrize("rows", [[0, 1, 2, 5], [0, 1, 2, 3, 4, 5], [2]])
@pytest.mark.parametrize("place", [POSE, {**START, "J1": 0.3, "J5": 0.2}])
def test_gradient_of_the_manipulability_is_that_of_central_differences(rows, place):
    kinematics, step = arm(), 1e-5
    q = kinematics.vector(place)
    w, gradient = kinematics.manipulability(q, 0.05, rows)
    A = (kinematics.jacobian(q) / np.array([0.05] * 3 + [1.0] * 3)[:, None])[rows]
    assert w == pytest.approx(np.sqrt(np.linalg.det(A @ A.T)), rel=1e-9)
    for i, unit in enumerate(np.eye(6)):
        ends = [np.log(kinematics.manipulability(q + sign * step * unit, 0.05, rows)[0]) for sign in (1, -1)]
        # truncation: step^2 times the third derivative, which at these poses is below 1e2; rounding: 1e-13 / step
        assert gradient[i] == pytest.approx((ends[0] - ends[1]) / (2 * step), abs=1e-7, rel=1e-6)


def test_manipulability_that_vanishes_has_no_gradient():
    kinematics = arm()
    straight = kinematics.vector({**GOAL, "J2": 0.0, "J3": 0.0, "J5": 0.0})
    w, gradient = kinematics.manipulability(straight, 0.05, list(range(6)))
    assert w == 0.0 and not gradient.any()


@pytest.mark.parametrize("rows", [[], [6], [0] * 7])
def test_manipulability_refuses_rows_that_are_none(rows):
    with pytest.raises(ShapeError, match="rows"):
        arm().manipulability(np.zeros(6), 0.05, rows)


#: Of sums of at most 70 products near 1 with a condition number near 100, many times over.
PROGRAM_ROUNDING = 1e-9
#: SLSQP ends when the cost changes by less than 1e-12, so x is right to about its root.
SLSQP = 1e-5


def program(seed, n, m, shift=0.0):
    """H, g, A, b; for shift 0 some x keeps all rows."""
    random = np.random.default_rng(seed)
    Q = random.normal(size=(n, n))
    A = random.normal(size=(m, n))
    b = A @ random.normal(size=n) - 0.5 * np.abs(random.normal(size=m)) + shift * random.normal(size=m)
    return Q @ Q.T / n + 0.1 * np.eye(n), 3.0 * random.normal(size=n), A, b


@pytest.mark.parametrize("n, m", [(1, 3), (6, 16), (7, 40), (20, 60), (70, 200)])
def test_the_answer_meets_the_conditions_of_a_minimum(n, m):
    for seed in range(5):
        H, g, A, b = program(seed, n, m)
        x, y, _, feasible = solve_program(H, g, A, b)
        assert feasible and y.min() >= 0.0
        np.testing.assert_allclose(H @ x + g, A.T @ y, atol=PROGRAM_ROUNDING)
        assert (A @ x - b).min() > -PROGRAM_ROUNDING
        np.testing.assert_allclose(y * (A @ x - b), 0.0, atol=PROGRAM_ROUNDING)
        assert n == 1 or (y > 0.0).any()


def test_a_second_solver_finds_the_same_minimum():
    for seed in range(10):
        H, g, A, b = program(seed, 6, 16)
        x = solve_program(H, g, A, b)[0]
        other = minimize(lambda z: 0.5 * z @ H @ z + g @ z, np.zeros(6), jac=lambda z: H @ z + g, method="SLSQP",
                         constraints={"type": "ineq", "fun": lambda z: A @ z - b, "jac": lambda z: A},
                         options={"ftol": 1e-12, "maxiter": 1000})
        assert other.success
        np.testing.assert_allclose(x, other.x, atol=SLSQP)


def test_infeasible_is_what_a_linear_program_finds_infeasible_too():
    found = []
    for seed in range(40):
        H, g, A, b = program(seed, 5, 14, shift=1.0)
        found.append(solve_program(H, g, A, b)[3])
        assert found[-1] == (linprog(np.zeros(5), A_ub=-A, b_ub=-b, bounds=[(None, None)] * 5).status == 0)
    assert True in found and False in found


def test_without_a_binding_row_it_is_the_plain_minimum_in_no_iteration():
    H, g, A, _ = program(0, 6, 16)
    x, y, iterations, feasible = solve_program(H, g, A, np.full(16, -np.inf))
    np.testing.assert_allclose(H @ x, -g, atol=PROGRAM_ROUNDING)
    assert feasible and iterations == 0 and not y.any()


def test_rows_that_repeat_each_other_and_rows_of_zeros_do_no_harm():
    H, g, A, b = program(1, 6, 16)
    alone = solve_program(H, g, A, b)[0]
    again = solve_program(H, g, np.vstack([A, A, np.zeros((2, 6))]), np.concatenate([b, b, [0.0, -1.0]]))
    assert again[3]
    np.testing.assert_allclose(again[0], alone, atol=PROGRAM_ROUNDING)
    assert not solve_program(H, g, np.zeros((1, 6)), np.array([1.0]))[3]


def test_wrong_shapes_and_numbers_are_told():
    H, g, A, b = program(2, 3, 4)
    with pytest.raises(ShapeError, match="found H 3 x 3, g 3, A 4 x 3, b 5"):
        solve_program(H, g, A, np.zeros(5))
    with pytest.raises(NotFiniteError, match="finite"):
        solve_program(H, g * np.nan, A, b)
    with pytest.raises(NotFiniteError, match="positive definite"):
        solve_program(-H, g, A, b)
