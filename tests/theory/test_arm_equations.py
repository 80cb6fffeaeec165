"""T16, T17, T40 to T44: the arm, against the kinematics of its URDF, closed forms and the product."""
import functools

import numpy as np
import product
import views
from equations import THEORY, equation, formula, paragraphs, same
from scenes import SEEDS, derivative, in_product, moments_of, pose, rows_same, seen
from test_interaction_equations import product_centred, product_of
from toy_plant import picture

from aras_visual_servo.arm.damping import RULES
from aras_visual_servo.arm.kinematics import Kinematics
from aras_visual_servo.arm.redundancy import TwistInverse, norm_part
from aras_visual_servo.config.files import load_yaml
from aras_visual_servo.features import interaction
from aras_visual_servo.servo.visibility import VisibilitySettings, keep_in_view

SOURCE = THEORY.parents[1] / "src"
URDF = (SOURCE / "aras_description" / "urdf" / "aras_arm.urdf").read_text()
SCENARIO = load_yaml(SOURCE / "aras_visual_servo/config/scenarios/experiment_1.yaml")
GOAL = SCENARIO["experiment"]["goal"]["joints"]
#: Bent, turned and tilted: no row or column of the Jacobian vanishes.
BENT = {"gantry": 0.3, "J1": 0.4, "J2": -0.5, "J3": 0.8, "J5": 0.3, "J6": 0.6}
L2, L3 = 0.25, 0.16  # between the axes of J2, J3 and J5 [m]
CAMERA, WRIST = (Kinematics(URDF, "world", tip) for tip in ("camera_optical_frame", "link5"))
LENGTH_M = 0.05
ROWS = np.array([1.0 / LENGTH_M] * 3 + [1.0] * 3)
#: Step of the differences over joints [rad]: the third derivatives here are below 1e2, and rounding 1e-15 / step.
STEP, DIFFERENCES = 1e-5, 1e-7


@formula("T16")
def det_J(L2, L3, q1, q2, q3, q5):
    """det J = L2 L3 sin q3 cos q1 sin(q2 + q3 + q5)"""
    return L2 * L3 * np.sin(q3) * np.cos(q1) * np.sin(q2 + q3 + q5)


@functools.lru_cache(maxsize=None)
def jacobian(**joints):
    return CAMERA.jacobian(CAMERA.vector(joints))


@equation("T16")
def test_determinant_is_that_of_the_urdf():
    for turn in (0.0, 0.5, -1.2):
        q = {name: value + turn for name, value in BENT.items()}
        same(det_J(L2, L3, q["J1"], q["J2"], q["J3"], q["J5"]), np.linalg.det(jacobian(**q)))


@equation("T16")
def test_looking_straight_down_the_tilt_about_the_axis_in_the_arms_plane_is_lost():
    for q in (GOAL, {**BENT, "J5": -BENT["J2"] - BENT["J3"]}):
        U, sigmas, _ = np.linalg.svd(jacobian(**q))
        assert sigmas[5] < 1e-12 < 1e-3 < sigmas[4]
        R_WC = CAMERA.pose(CAMERA.vector(q))[:3, :3]
        # The pitch axes stand across the arm's plane: z of the world and what stands across both lie in it.
        pitch = WRIST.pose(WRIST.vector(q))[:3, 1]
        same(np.abs(U[:3, 5]).max() + 1.0, 1.0)
        same(np.abs(np.cross(pitch, [0.0, 0.0, 1.0]) @ R_WC @ U[3:, 5]), 1.0)


@formula("T17")
def rise(L2, L3, q2, q3):
    """L2 L3 sin q3 / (L2 cos q2 + L3 cos(q2 + q3))"""
    return L2 * L3 * np.sin(q3) / (L2 * np.cos(q2) + L3 * np.cos(q2 + q3))


@functools.lru_cache(maxsize=None)
def rise_of_the_urdf(**joints):
    """dz/dq3 of the wrist with J2 holding its distance from the shoulder: differences of its place."""
    slopes, q = [], WRIST.vector(joints)
    shoulder = WRIST.pose(WRIST.vector({**joints, "J2": 0.0, "J3": 0.0}))[:3, 3]
    for name in ("J2", "J3"):
        step = STEP * np.eye(len(q))[WRIST.joint_names.index(name)]
        ahead, behind = (WRIST.pose(end)[:3, 3] - shoulder for end in (q + step, q - step))
        away = ahead + behind
        level = np.array([away[0], away[1], 0.0]) / np.hypot(*away[:2])
        slopes.append([level @ (ahead - behind) / (2 * STEP), (ahead - behind)[2] / (2 * STEP)])
    (x2, z2), (x3, z3) = slopes
    return z3 - z2 * x3 / x2


@equation("T17")
def test_the_wrist_rises_with_the_elbow_as_in_the_urdf():
    for q in (GOAL, {**GOAL, "J2": 0.35, "J3": -0.26}, {**GOAL, "J2": -0.4, "J3": 0.9}):
        same(rise(L2, L3, q["J2"], q["J3"]), rise_of_the_urdf(**q), DIFFERENCES)


@equation("T17")
def test_numbers_of_the_goal_are_those_of_the_text():
    slope = rise_of_the_urdf(**GOAL)
    text = " ".join(paragraphs(THEORY.read_text())["T17"].split())
    assert f"it is {slope:.5f} m/rad" in text and f"asks for {1e-3 / slope:.3f} rad of the elbow" in text
    same(rise(L2, L3, GOAL["J2"], GOAL["J3"]), slope, DIFFERENCES)


# --- T40: damping -----------------------------------------------------------------------------------------------------

S0, DAMPING = 0.02, 0.03
SIGMAS = [3.0, 1.5, 1.0, 0.5, 0.6 * S0, 0.4 * S0]


@formula("T40")
def gain(sigma, lambda_i):
    """sigma_i / (sigma_i^2 + lambda_i^2)"""
    return sigma / (sigma**2 + lambda_i**2)


@formula("T40")
def damped(sigma, s0, lam):
    """(1 - (sigma_i/s0)^2) lambda^2"""
    return (1 - (sigma / s0) ** 2) * lam**2


@formula("T40")
def nakamura_hanafusa(w_w0, lam):
    """(1 - w/w0)^2 lambda^2"""
    return (1 - w_w0) ** 2 * lam**2


@formula("T40")
def manipulability_part(sigma_m, s0):
    """w/w0 = sigma_m/s0"""
    return sigma_m / s0


@formula("T40")
def weakest(lam):
    """(1 + 1/20^2) lambda^2"""
    return (1 + 1 / 20**2) * lam**2


@formula("T40")
def others(lam):
    """1/20^2 lambda^2"""
    return 1 / 20**2 * lam**2


@formula("T40")
def chiaverini_part(sigma_m, s0):
    """1 - (sigma_m/s0)^2"""
    return 1 - (sigma_m / s0) ** 2


@formula("T40")
def transposed(alpha, J, V):
    """alpha J^T V"""
    return alpha * J.T @ V


@formula("T40")
def best_alpha(J, V):
    """alpha = V^T J J^T V / (V^T J J^T J J^T V)"""
    return V @ J @ J.T @ V / (V @ J @ J.T @ J @ J.T @ V)


@equation("T40")
def test_gain_is_that_of_the_damped_least_squares():
    for sigma, lam in ((0.5, 0.1), (0.01, 0.03), (0.0, 0.02)):
        # q that makes (sigma q - 1)^2 + (lambda q)^2 least, found as least squares of two equations.
        expected = np.linalg.lstsq(np.array([[sigma], [lam]]), np.array([1.0, 0.0]), rcond=None)[0][0]
        same(gain(sigma, lam) + 1.0, expected + 1.0)


@functools.lru_cache(maxsize=None)
def of_the_product(rule):
    """(lambda_i^2, gains of the joints) by a rule for SIGMAS."""
    joints = TwistInverse(np.ones(6), 1.0, S0, DAMPING, rule)(np.diag(SIGMAS))
    return RULES[rule](SIGMAS, S0, DAMPING**2), [joints.joint_velocity(row)[i] for i, row in enumerate(np.eye(6))]


@equation("T40")
def test_rules_are_those_of_the_product():
    part = manipulability_part(SIGMAS[-1], S0)
    filtered = [others(DAMPING)] * 5 + [weakest(DAMPING)]
    expected = {
        "damped": [damped(sigma, S0, DAMPING) if sigma < S0 else 0.0 for sigma in SIGMAS],
        "nakamura_hanafusa": [nakamura_hanafusa(part, DAMPING)] * 6,
        "maciejewski_klein": filtered,
        "chiaverini": [chiaverini_part(SIGMAS[-1], S0) * one for one in filtered],
        "constant": [DAMPING**2] * 6, "plain": [0.0] * 6}
    for rule, lambdas in expected.items():
        for sigma, found, wanted, joint in zip(SIGMAS, lambdas, *of_the_product(rule)):
            same(found + 1.0, wanted + 1.0, 1e-14, rule)
            same(gain(sigma, np.sqrt(found)), joint, what=rule)
    assert of_the_product("naive")[1][-2:] == [0.0, 0.0]
    same(of_the_product("naive")[1][:4], [gain(sigma, 0.0) for sigma in SIGMAS[:4]])


@equation("T40")
def test_smooth_rules_begin_at_the_threshold_and_damp_in_full_at_zero():
    assert abs(damped(S0, S0, DAMPING)) < 1e-15 and abs(chiaverini_part(S0, S0)) < 1e-12
    assert abs(nakamura_hanafusa(manipulability_part(S0, S0), DAMPING)) < 1e-15
    same([damped(0.0, S0, DAMPING), nakamura_hanafusa(0.0, DAMPING)], [DAMPING**2] * 2)


TWIST = np.array([0.02, -0.03, 0.01, 0.1, -0.2, 0.15])


@equation("T40")
def test_transpose_goes_as_far_as_is_best():
    J, V = ROWS[:, None] * jacobian(**BENT), ROWS * TWIST
    along = (J @ (J.T @ V))[:, None]
    alpha = best_alpha(J, V)
    same(alpha, np.linalg.lstsq(along, V, rcond=None)[0][0])
    same(transposed(alpha, J, V), transposed_by_the_product())


@functools.lru_cache(maxsize=None)
def transposed_by_the_product():
    return TwistInverse(np.ones(6), LENGTH_M, S0, DAMPING, "transpose")(jacobian(**BENT)).joint_velocity(TWIST)


# --- T41, T42: what is done beside ------------------------------------------------------------------------------------


@formula("T41")
def onto_the_norm(I, J_e, e):
    """P_|e| = I - J_e^T e e^T J_e / (e^T J_e J_e^T e)"""
    return I - np.outer(J_e.T @ e, e @ J_e) / (e @ J_e @ J_e.T @ e)


@formula("T41")
def null_space(I, J):
    """I - J^+ J"""
    return I - np.linalg.pinv(J) @ J


@formula("T41")
def rate_left(e, J_e, P):
    """e^T J_e P = 0"""
    return 0 + e @ J_e @ P


@formula("T41")
def S(u):
    """S(u) = 1 / (1 + exp(6 - 12 u))"""
    return 1 / (1 + np.exp(6 - 12 * u))


@formula("T41")
def between(e, lower, upper):
    """u = (|e| - lower) / (upper - lower)"""
    return (abs(e) - lower) / (upper - lower)


@formula("T41")
def weight(S, u):
    """(S(u) - S(0)) / (S(1) - S(0))"""
    return (S(u) - S(0)) / (S(1) - S(0))


WISH = np.array([0.1, -0.2, 0.3, 0.1, -0.1, 0.05])


@functools.lru_cache(maxsize=None)
def free_in_the_product():
    one = TwistInverse(np.ones(6), LENGTH_M, S0, DAMPING)(jacobian(**BENT))
    seven = TwistInverse(np.ones(7), 1.0, S0, DAMPING)(SEVEN)
    return one.free_of_norm(WISH, TWIST), seven.free(np.r_[WISH, 0.2])


SEVEN = np.random.default_rng(5).normal(size=(6, 7))


@equation("T41")
def test_projection_onto_the_norm_takes_one_direction_and_the_null_space_all_but_one():
    J, e = ROWS[:, None] * jacobian(**BENT), ROWS * TWIST
    P = onto_the_norm(np.eye(6), J, e)
    assert np.abs(rate_left(e, J, P)).max() < 1e-12 * np.abs(e @ J).max()
    same(rate_left(e, J, np.eye(6)), e @ J)
    same(P @ P, P)
    assert np.linalg.matrix_rank(P) == 5
    same(P @ WISH, free_in_the_product()[0])
    N = null_space(np.eye(7), SEVEN)
    same(SEVEN @ N + 1.0, np.ones((6, 7)))
    same(N @ N, N)
    same(N @ np.r_[WISH, 0.2], free_in_the_product()[1])
    assert np.abs(null_space(np.eye(6), J)).max() < 1e-12


@equation("T41")
def test_the_hand_over_is_the_sigmoid_from_zero_to_one():
    for size in (0.1, 0.17, 0.3, 0.42, 0.5):
        same(weight(S, between(size, 0.1, 0.5)) + 1.0, norm_part(size, 0.1, 0.5) + 1.0, 1e-12)
    # The logistic function of twelve units' width: symmetric about the middle, with a slope of 3 there.
    same(S(0.5), 0.5)
    same((S(0.5 + STEP) - S(0.5 - STEP)) / (2 * STEP), 3.0, DIFFERENCES)
    same(S(0.2) + S(0.8), 1.0)


@formula("T42")
def w(A):
    """w = sqrt(det(A A^T))"""
    return np.sqrt(np.linalg.det(A @ A.T))


@formula("T42")
def slope_of_ln_w(A, dA):
    """d(ln w)/dq_i = tr((A A^T)^-1 dA/dq_i A^T)"""
    return np.trace(np.linalg.inv(A @ A.T) @ dA @ A.T)


@formula("T42")
def slope_of_J(J_i, J_j, bracket):
    """dJ_j/dq_i = -[J_i, J_j]"""
    return -bracket(J_i, J_j)


@formula("T42")
def bracket(v_a, w_a, v_b, w_b):
    """[a, b] = (w_a x v_b + v_a x w_b, w_a x w_b)"""
    return np.cross(w_a, v_b) + np.cross(v_a, w_b), np.cross(w_a, w_b)


def bracket_of(a, b):
    return np.concatenate(bracket(a[:3], a[3:], b[:3], b[3:]))


ORDER = ("gantry", "J1", "J2", "J3", "J5", "J6")  # from the base to the camera


@functools.lru_cache(maxsize=None)
def slopes_of_the_jacobian():
    """[dJ/dq_i] by differences."""
    q = CAMERA.vector(BENT)
    return [(CAMERA.jacobian(q + STEP * unit) - CAMERA.jacobian(q - STEP * unit)) / (2 * STEP) for unit in np.eye(6)]


@functools.lru_cache(maxsize=None)
def manipulability_of_the_product(rows):
    """(w, gradient of ln w), and that gradient by differences of the product's w."""
    q = CAMERA.vector(BENT)
    value, gradient = CAMERA.manipulability(q, LENGTH_M, list(rows))
    ends = [[np.log(CAMERA.manipulability(q + sign * STEP * unit, LENGTH_M, list(rows))[0]) for sign in (1, -1)]
            for unit in np.eye(6)]
    return value, gradient, np.array([(ahead - behind) / (2 * STEP) for ahead, behind in ends])


@equation("T42")
def test_columns_of_the_jacobian_turn_by_the_bracket():
    J = jacobian(**BENT)
    for i, slope in enumerate(slopes_of_the_jacobian()):
        for j in range(6):
            nearer = ORDER.index(CAMERA.joint_names[i]) > ORDER.index(CAMERA.joint_names[j])
            expected = slope_of_J(J[:, i], J[:, j], bracket_of) if nearer else np.zeros(6)
            same(expected + 1.0, slope[:, j] + 1.0, DIFFERENCES)


@equation("T42")
def test_manipulability_and_its_gradient_are_those_of_the_product():
    for rows in ((0, 1, 2, 5), (0, 1, 2, 3, 4, 5), (2,)):
        A = (ROWS[:, None] * jacobian(**BENT))[list(rows)]
        value, gradient, differences = manipulability_of_the_product(rows)
        same(w(A), np.prod(np.linalg.svd(A)[1]))
        same(w(A), value)
        found = np.array([slope_of_ln_w(A, (ROWS[:, None] * slope)[list(rows)]) for slope in slopes_of_the_jacobian()])
        same(found, differences, DIFFERENCES)
        same(found, gradient, DIFFERENCES)


# --- T43, T44: limits of the view and of the joints -------------------------------------------------------------------

EXTENT, GAMMA = 2.0, 3.0


@formula("T43")
def edge(xg, k, n20):
    """x = xg + k sqrt(n20)"""
    return xg + k * np.sqrt(n20)


@formula("T43")
def L_edge(L_xg, k, L_n20, n20):
    """L_x = L_xg + k L_n20 / (2 sqrt(n20))"""
    return L_xg + k * L_n20 / (2 * np.sqrt(n20))


@formula("T43")
def L_n20(L_mu20, n20, L_a, a):
    """L_n20 = (L_mu20 - n20 L_a) / a"""
    return (L_mu20 - n20 * L_a) / a


@formula("T43")
def stays_inside(x_dot, gamma, h):
    """x_dot <= gamma h"""
    return x_dot <= gamma * h


@formula("T43")
def room_left(gamma, t):
    """exp(-gamma t)"""
    return np.exp(-gamma * t)


def right_edge(m, mu):
    return m[1, 0] / m[0, 0] + EXTENT * np.sqrt(mu[2, 0] / m[0, 0])


@equation("T43")
def test_row_of_an_edge_is_its_derivative():
    for seed in SEEDS:
        m, mu, _ = seen(seed)
        n20 = mu[2, 0] / m[0, 0]
        same(edge(m[1, 0] / m[0, 0], EXTENT, n20), right_edge(m, mu))
        of_n20 = L_n20(product_centred(seed, 2, 0), n20, product_of(interaction.area, seed), m[0, 0])
        rows_same(of_n20, derivative(lambda m, mu: mu[2, 0] / m[0, 0], seed)[0])
        rows_same(L_edge(product_of(interaction.centroid, seed)[0], EXTENT, of_n20, n20), derivative(right_edge, seed))


@functools.lru_cache(maxsize=None)
def kept_in_view():
    """(m, mu, rows of centroid, area and mu20, room, twist asked for, twist as the product bends it)."""
    m, mu = moments_of(picture(views.parallel_pose()))
    view = in_product(m, mu, (0.0, 0.0, 1.0 / 0.6), an=0.6)
    centroid, area = interaction.centroid(view.m, view.plane)[0], view.L_area()
    room = 0.05
    config = VisibilitySettings(half_width=right_edge(m, mu) + room, half_height=5.0, margin=0.0, extent=EXTENT,
                                rate_per_s=GAMMA)
    twist = np.array([-0.4, 0.0, 0.1, 0.0, 0.0, 0.2])
    return m, mu, (centroid, area, view.L_mu(2, 0)), room, twist, keep_in_view(config, view.features, twist)[0]


@equation("T43")
def test_the_product_lets_an_edge_come_nearer_as_fast_as_it_may_and_no_faster():
    m, mu, (of_xg, of_a, of_mu20), room, asked, twist = kept_in_view()
    n20 = mu[2, 0] / m[0, 0]
    row = L_edge(of_xg, EXTENT, L_n20(of_mu20, n20, of_a, m[0, 0]), n20)
    assert not stays_inside(row @ asked, GAMMA, room)
    for part, expected in ((0.9999, True), (1.0001, False)):
        assert stays_inside(part * (row @ twist), GAMMA, room) == expected
    assert not (twist - asked)[1:].any()


@equation("T43")
def test_room_that_is_used_up_as_fast_as_it_may_be_decays_exponentially():
    h, steps, t = 0.3, 400, 0.5
    for _ in range(steps):  # x_dot = gamma h, h_dot = -x_dot, by the midpoint rule
        h -= t / steps * GAMMA * (h - 0.5 * t / steps * GAMMA * h)
    same(room_left(GAMMA, t), h / 0.3, 1e-5)


@formula("T44")
def held(room, horizon):
    """q_dot_k = room / horizon"""
    return room / horizon


@formula("T44")
def the_others(J, W, V, J_k, q_dot_k):
    """(J W)^+ (V - J_k q_dot_k)"""
    return np.linalg.pinv(J @ W) @ (V - J_k * q_dot_k)


@functools.lru_cache(maxsize=None)
def at_limit():
    return product.at_limit(URDF, BENT, "J3", 0.01, 1.0 / 30.0)


@equation("T44")
def test_a_joint_at_its_limit_uses_its_room_and_the_others_do_what_is_left():
    q_dot, V, J, room, horizon_s, k = at_limit()
    same(q_dot[k], held(room, horizon_s))
    J, V = ROWS[:, None] * J, ROWS * V
    W = np.eye(6) - np.outer(np.eye(6)[k], np.eye(6)[k])
    rest = the_others(J, W, V, J[:, k], held(room, horizon_s))
    assert abs(rest[k]) < 1e-12
    same(np.delete(rest, k), np.delete(q_dot, k), 1e-9)
    # Nothing that the others could do instead comes nearer.
    missed = V - J[:, k] * q_dot[k] - J @ rest
    assert np.abs((J @ W).T @ missed).max() < 1e-9 * np.abs(V).max()


def test_poses_are_where_something_can_be_seen():
    assert abs(det_J(L2, L3, 0.4, -0.5, 0.8, 0.3)) > 1e-3 and pose(1)[2, 3] > 0.0
