"""The solver of quadratic programs: conditions of Karush, Kuhn and Tucker, and two solvers of scipy beside it."""

import numpy as np
import pytest
from scipy.optimize import linprog, minimize

from aras_visual_servo._kinematics import solve_program
from aras_visual_servo.ground.errors import NotFiniteError, ShapeError

#: Of sums of at most 70 products near 1 with a condition number near 100, many times over.
ROUNDING = 1e-9
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
        np.testing.assert_allclose(H @ x + g, A.T @ y, atol=ROUNDING)
        assert (A @ x - b).min() > -ROUNDING
        np.testing.assert_allclose(y * (A @ x - b), 0.0, atol=ROUNDING)
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
    np.testing.assert_allclose(H @ x, -g, atol=ROUNDING)
    assert feasible and iterations == 0 and not y.any()


def test_rows_that_repeat_each_other_and_rows_of_zeros_do_no_harm():
    H, g, A, b = program(1, 6, 16)
    alone = solve_program(H, g, A, b)[0]
    again = solve_program(H, g, np.vstack([A, A, np.zeros((2, 6))]), np.concatenate([b, b, [0.0, -1.0]]))
    assert again[3]
    np.testing.assert_allclose(again[0], alone, atol=ROUNDING)
    assert not solve_program(H, g, np.zeros((1, 6)), np.array([1.0]))[3]


def test_wrong_shapes_and_numbers_are_told():
    H, g, A, b = program(2, 3, 4)
    with pytest.raises(ShapeError, match="found H 3 x 3, g 3, A 4 x 3, b 5"):
        solve_program(H, g, A, np.zeros(5))
    with pytest.raises(NotFiniteError, match="finite"):
        solve_program(H, g * np.nan, A, b)
    with pytest.raises(NotFiniteError, match="positive definite"):
        solve_program(-H, g, A, b)
