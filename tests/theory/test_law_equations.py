"""T12 to T15, T20 to T23: laws on a camera that does exactly as it is told."""
import functools

import numpy as np
import product
from equations import equation, formula, same
from scenes import moved
from toy_plant import OUTLINE, angle_between
from views import STEP, parallel_pose, plane_of, tilted_pose, view

from aras_visual_servo.features.base import FeatureSet
from aras_visual_servo.laws.base import adaptive_factor, sampled_gains
from aras_visual_servo.laws.setup import AdaptiveGainSettings

GAINS = np.array([3.0, 2.0, 4.0, 1.5])
GOAL = parallel_pose()
#: Still parallel to the target, moved and turned.
HERE = moved(GOAL, [0.04, -0.05, 0.07, 0.0, 0.0, 0.3])
#: Of e_dot: truncation and rounding of differences over the camera's motion.
RATE = 1e-7


def values(X):
    """(xn, yn, an, alpha), the first three with the true depth as an."""
    f = view(X).features
    factor = X[2, 3] / f.an
    return np.array([factor * f.xn, factor * f.yn, X[2, 3], f.alpha])


def error(X):
    e = values(X) - values(GOAL)
    return np.r_[e[:3], angle_between(e[3], 0.0)]


def six(v):
    return np.array([v[0], v[1], v[2], 0.0, 0.0, v[3]])


def rate_of_error(X, v):
    """de/dt while the camera moves with v."""
    ahead, behind = (error(moved(X, t * six(v))) for t in (STEP, -STEP))
    return np.r_[(ahead - behind)[:3], angle_between(ahead[3], behind[3])] / (2.0 * STEP)


@functools.lru_cache(maxsize=None)
def here():
    """e, L by differences, and the twists of the product's laws for the rates GAINS."""
    e, s_star = error(HERE), values(GOAL)
    L = np.column_stack([rate_of_error(HERE, axis) for axis in np.eye(4)])
    return e, L, {name: product.four_features(name, GAINS, s_star + e, s_star, 0.0) for name in ("paper", "decoupled")}


@formula("T12")
def published_law(Lambda, L, e):
    """v = -Lambda L^-1 e"""
    return -Lambda @ np.linalg.inv(L) @ e


@formula("T12")
def coupled(Lambda, L, e):
    """e_dot = -L Lambda L^-1 e"""
    return -L @ Lambda @ np.linalg.inv(L) @ e


@equation("T12")
def test_the_published_law_couples_the_features():
    e, L, laws = here()
    v = published_law(np.diag(GAINS), L, e)
    same(v, laws["paper"], RATE)
    same(coupled(np.diag(GAINS), L, e), rate_of_error(HERE, laws["paper"]), RATE)
    assert np.abs(coupled(np.diag(GAINS), L, e) + GAINS * e)[:2].max() > 0.01 * np.abs(e).max()
    same(coupled(2.0 * np.eye(4), L, e), -2.0 * e)


@formula("T13")
def decoupled_law(Lambda, L, e):
    """v = -L^-1 Lambda e"""
    return -np.linalg.inv(L) @ Lambda @ e


@formula("T13")
def alone(lam, e):
    """e_dot = -lambda e"""
    return -lam * e


@equation("T13")
def test_the_decoupled_law_makes_each_error_decay_on_its_own():
    e, L, laws = here()
    same(decoupled_law(np.diag(GAINS), L, e), laws["decoupled"], RATE)
    same(alone(GAINS, e), rate_of_error(HERE, laws["decoupled"]), RATE)


@formula("T14")
def moved_by(g, dt, e):
    """-g dt e"""
    return -g * dt * e


@formula("T14")
def g(lam, dt):
    """g = (1 - exp(-lambda dt)) / dt"""
    return (1 - np.exp(-lam * dt)) / dt


@formula("T14")
def decay(lam, t):
    """exp(-lambda t)"""
    return np.exp(-lam * t)


@functools.lru_cache(maxsize=None)
def after_one_twist(dt_s):
    """e left when the product's decoupled law held one twist for dt_s."""
    e, s_star = error(HERE), values(GOAL)
    return error(moved(HERE, dt_s * six(product.four_features("decoupled", GAINS, s_star + e, s_star, dt_s))))


@equation("T14")
def test_a_twist_held_for_any_time_leaves_what_the_exponential_leaves():
    e = error(HERE)
    for dt_s in (0.01, 1.0 / 30.0, 0.2):
        same(g(GAINS, dt_s), sampled_gains(GAINS, dt_s))
        same(e + moved_by(g(GAINS, dt_s), dt_s, e), after_one_twist(dt_s))
        same(decay(GAINS, dt_s) * e, after_one_twist(dt_s))


@formula("T15")
def part_of_error(lam, T):
    """lambda T"""
    return lam * T


@formula("T15")
def converges_without_delay(lambda_T):
    """lambda T < 2"""
    return lambda_T < 2


@formula("T15")
def converges_one_period_late(lambda_T):
    """lambda T < 1"""
    return lambda_T < 1


def largest_root(lambda_T, delay):
    """Of z^(d+1) - z^d + lambda T: the error of e_{k+1} = e_k - lambda T e_{k-d} shrinks where it is below 1."""
    return np.abs(np.roots([1.0, -1.0, *[0.0] * (delay - 1), lambda_T] if delay else [1.0, lambda_T - 1.0])).max()


@equation("T15")
def test_one_look_moves_by_its_part_of_the_error():
    for gain, part in zip((90.0, 70.0, 50.0, 30.0), (0.9, 0.7, 0.5, 0.3)):
        same(part_of_error(gain, 0.01), part)
    # On the true set-point: height alone, where the feature is linear in the motion.
    X = moved(GOAL, [0.0, 0.0, 0.1, 0.0, 0.0, 0.0])
    e, s_star = error(X), values(GOAL)
    step = 0.01 * product.four_features("paper", (90.0, 70.0, 50.0, 30.0), s_star + e, s_star, 0.0)
    same(error(moved(X, six(step)))[2], e[2] - part_of_error(50.0, 0.01) * e[2], 1e-9)


@equation("T15")
def test_sampled_loops_converge_below_their_limits():
    for lambda_T in (0.5, 0.9995, 1.0005, 1.5, 1.9995, 2.0005, 3.0):
        assert converges_without_delay(lambda_T) == (largest_root(lambda_T, 0) < 1.0), lambda_T
        assert converges_one_period_late(lambda_T) == (largest_root(lambda_T, 1) < 1.0), lambda_T
    at_30_hz = [gain / 30.0 for gain in (90.0, 70.0, 50.0, 30.0)]
    assert [largest_root(one, 0) < 1.0 for one in at_30_hz] == [False, False, True, True]
    assert [largest_root(one, 1) < 1.0 - 1e-9 for one in at_30_hz] == [False] * 4
    same(largest_root(at_30_hz[3], 1), 1.0)


# --- T20, T21: any features, the plane --------------------------------------------------------------------------------

FAR = {size: 0.05 * size * np.array([0.4, -0.6, 0.8, 0.5, -0.7, 1.0]) for size in (1.0, 0.5)}
RATES = np.array([3.0, 2.0, 4.0, 1.5, 2.5, 1.0])


@formula("T20")
def any_features(Lambda, L, e):
    """v = -L^+ Lambda e"""
    return -np.linalg.pinv(L) @ Lambda @ e


@formula("T20")
def mean_of_both(L, L_star):
    """(L + L*) / 2"""
    return (L + L_star) / 2


@functools.lru_cache(maxsize=None)
def six_features(size):
    """e, L, L* of six features of moments, and the product's twist with each matrix, from exp(FAR) of the goal."""
    goal, names = tilted_pose(1), product.SIX
    X = moved(goal, FAR[size])
    matrices = [FeatureSet(names).matrix(view(at, plane=plane_of(at))) for at in (X, goal)]
    made = {}
    for interaction in ("current", "desired", "mean"):
        law = product.law_of("ibvs", RATES, goal, names, interaction=interaction)
        made[interaction], _, e = product.twist_of(law, goal, X)
    return e, *matrices, made


@equation("T20")
def test_law_on_any_features_is_that_of_the_product_with_each_matrix():
    e, L, L_star, twists = six_features(1.0)
    for which, matrix in (("current", L), ("desired", L_star), ("mean", mean_of_both(L, L_star))):
        same(any_features(np.diag(RATES), matrix, e), twists[which], 1e-9)


@equation("T20")
def test_with_the_current_matrix_each_error_decays_and_with_the_mean_the_step_is_of_second_order():
    names, goal = product.SIX, tilted_pose(1)
    e, L, _, _ = six_features(1.0)
    v, X = any_features(np.diag(RATES), L, e), moved(goal, FAR[1.0])
    ends = [np.array(FeatureSet(names).values(view(moved(X, t * v)))) for t in (STEP, -STEP)]
    same((ends[0] - ends[1]) / (2 * STEP), -RATES * e, 1e-6)
    left = {}
    for size, xi in FAR.items():
        e, L, L_star, _ = six_features(size)
        for name, matrix in (("mean", mean_of_both(L, L_star)), ("desired", L_star)):
            left[name, size] = np.linalg.norm(any_features(np.eye(6), matrix, e) + xi)
    assert 6.0 < left["mean", 1.0] / left["mean", 0.5] < 10.0, left
    assert 3.0 < left["desired", 1.0] / left["desired", 0.5] < 5.0, left


@equation("T20")
def test_a_pure_turn_stays_one_with_points_and_the_mean_but_not_with_moments():
    points = tuple(f"{axis}{k + 1}" for k in range(4) for axis in "xy")
    for names, stays in ((points, True), (product.SIX, False)):
        (s, L), (s_star, L_star) = [(np.array(FeatureSet(names).values(view(X))),
                                     FeatureSet(names).matrix(view(X, plane=plane_of(X))))
                                    for X in (moved(GOAL, [0, 0, 0, 0, 0, 1.5]), GOAL)]
        v = any_features(np.eye(len(s)), mean_of_both(L, L_star), s - s_star)
        assert (np.abs(v[:5]).max() < 1e-9) == stays, v


@formula("T21")
def plane_there(R, t, p_star):
    """(A, B, C) = R^T p* / (1 - p* . t)"""
    return R.T @ p_star / (1 - p_star @ t)


@formula("T21")
def plane_at_goal(n, t):
    """p* = n / (n . t)"""
    return n / (n @ t)


@equation("T21")
def test_the_plane_moves_with_the_camera():
    for seed in (1, 2):
        goal, X = tilted_pose(seed), tilted_pose(seed + 5)
        X_CgC, X_CgW = np.linalg.inv(goal) @ X, np.linalg.inv(goal)
        p_star = plane_at_goal(X_CgW[:3, 2], X_CgW[:3, 3])
        for x_W, y_W in OUTLINE:  # of any point of the plane
            x, y, z = (X_CgW @ [x_W, y_W, 0.0, 1.0])[:3]
            same(p_star @ [x / z, y / z, 1.0], 1.0 / z)
        same(plane_there(X_CgC[:3, :3], X_CgC[:3, 3], p_star), plane_of(X))
    p_star, X_CgC, plane = product.plane_by_kinematics()
    same(plane_there(X_CgC[:3, :3], X_CgC[:3, 3], p_star), plane)


# --- T22, T23: adaptive gain, smooth start ----------------------------------------------------------------------------


@formula("T22")
def f(x, r, s):
    """f(x) = (1 - r) exp(-s x / (1 - r)) + r"""
    return (1 - r) * np.exp(-s * x / (1 - r)) + r


@formula("T22")
def largest(e):
    """x = max |e_i|"""
    return np.max(np.abs(e))


@functools.lru_cache(maxsize=None)
def slowed(r, s):
    """e, and the product's twist with adaptive gain against that without."""
    twists = []
    for adaptive in (None, AdaptiveGainSettings(r, s)):
        law = product.law_of("ibvs", GAINS, GOAL, product.FOUR, adaptive_gain=adaptive)
        twist, _, e = product.twist_of(law, GOAL, HERE)
        twists.append(twist)
    return e, twists[1] @ twists[0] / (twists[0] @ twists[0])


@equation("T22")
def test_adaptive_gain_has_the_three_parameters_that_are_published():
    r, s = 0.2, 8.0
    at_zero, far, slope = 2.5, r * 2.5, s * 2.5  # lambda(0), lambda(infinity), -lambda'(0)
    for x in (0.0, 0.01, 0.1, 0.5, 3.0):
        published = (at_zero - far) * np.exp(-slope / (at_zero - far) * x) + far
        same(f(x, r, s) * at_zero, published)
        same(f(x, r, s), adaptive_factor(x, r, s))
    e, factor = slowed(r, s)
    same(f(largest(e), r, s), factor)


@formula("T23")
def let_in(v_law_t, v_law_0, mu, t):
    """v(t) = v_law(t) - exp(-mu t) v_law(0)"""
    return v_law_t - np.exp(-mu * t) * v_law_0


@functools.lru_cache(maxsize=None)
def smooth_start(mu, dt_s):
    """Twists of the product for one view again and again, without smooth start and with it."""
    twists = []
    for rate in (0.0, mu):
        law = product.law_of("ibvs", GAINS, GOAL, product.FOUR, smooth_start_per_s=rate)
        twists.append([product.twist_of(law, GOAL, HERE, dt_s)[0] for _ in range(6)])
    return twists


@equation("T23")
def test_smooth_start_is_from_rest_and_solves_the_published_equation():
    lam, mu, e_0 = 2.0, 5.0, 0.3
    # e_dot = -lambda e + exp(-mu t) lambda e(0), from rest: by hand, for a feature that moves with v.
    for t in (0.0, 0.1, 0.7):
        e = e_0 * (mu * np.exp(-lam * t) - lam * np.exp(-mu * t)) / (mu - lam)
        e_dot = -e_0 * lam * mu * (np.exp(-lam * t) - np.exp(-mu * t)) / (mu - lam)
        assert abs(let_in(-lam * e, -lam * e_0, mu, t) - e_dot) < 1e-12
    plain, smooth = smooth_start(mu, 0.05)
    for k, twist in enumerate(smooth):
        same(let_in(plain[k], plain[0], mu, 0.05 * (k + 1)), twist, what="at the end of the time the twist is held")
