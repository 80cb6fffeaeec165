"""T31, T32, T46, T60 to T62: sliding mode, learning without calibration, luminance; and when the servo has arrived."""
import functools

import numpy as np
import product
from bench import Bench
from equations import equation, formula, same
from scenes import moved
from toy_plant import OUTLINE
from views import exponential as exponential_of
from views import parallel_pose, plane_of, tilted_pose, view

from aras_visual_servo.laws.broyden import BroydenSettings
from aras_visual_servo.laws.sliding import SlidingSettings
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.spatial import exponential as pose_by
from aras_visual_servo.spatial import rotation_vector
from aras_visual_servo.laws.sliding import _rate
from aras_visual_servo.servo.stop_rule import GoalPose, StopRule, StopSettings

GAINS = np.array([3.0, 2.0, 4.0, 1.5])
GOAL = parallel_pose()
#: Still parallel to the target, moved and turned.
HERE = moved(GOAL, [0.04, -0.05, 0.07, 0.0, 0.0, 0.3])
SEEN = [0, 1, 2, 5]  # the twist that four features tell


@formula("T31")
def sliding(e, lam, kappa, phi, sat):
    """e_dot = -lambda e - kappa phi sat(e / phi)"""
    return -lam * e - kappa * phi * sat(e / phi)


@formula("T31")
def sliding_twist(L, e_dot):
    """v = L^+ e_dot"""
    return np.linalg.pinv(L) @ e_dot


@formula("T31")
def reaching_time(E, lam, kappa, phi):
    """ln((lambda E + kappa phi) / (lambda phi + kappa phi)) / lambda"""
    return np.log((lam * E + kappa * phi) / (lam * phi + kappa * phi)) / lam


@formula("T31")
def left_by(d, lam, kappa):
    """|e| = d / (lambda + kappa)"""
    return d / (lam + kappa)


def sat(ratio):
    return min(1.0, max(-1.0, ratio))


def integrated(e, rate, duration_s, steps=200):
    """e after that time, by Runge and Kutta."""
    h = duration_s / steps
    for _ in range(steps):
        a = rate(e)
        b = rate(e + 0.5 * h * a)
        c = rate(e + 0.5 * h * b)
        e = e + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(e + h * c))
    return e


@equation("T31")
def test_the_layer_is_reached_in_its_time_and_a_disturbance_leaves_its_part():
    lam, kappa, phi, E, d = 1.5, 4.0, 0.02, 0.3, 0.05

    def rate(e):
        return sliding(e, lam, kappa, phi, sat)

    same(integrated(E, rate, reaching_time(E, lam, kappa, phi)), phi, 1e-8)
    same(rate(left_by(d, lam, kappa)) + d + 1.0, 1.0, 1e-12, "at rest under the disturbance")
    for e in (E, -0.5 * E, 0.5 * phi):
        same(e - 0.1 * _rate(e, lam, kappa, phi, 0.1), integrated(e, rate, 0.1), 1e-6)  # the layer's kink in a step
        same(rate(e), -_rate(e, lam, kappa, phi, 0.0))


@functools.lru_cache(maxsize=None)
def sliding_of_the_product(kappa, phi):
    law = product.law_of("sliding", GAINS, GOAL, product.FOUR, interaction="current",
                         settings={"sliding": SlidingSettings(kappa, (phi,) * 4)})
    twist, _, e = product.twist_of(law, GOAL, HERE)
    return twist[SEEN], e, FeatureSet(product.FOUR).matrix(view(HERE, plane=plane_of(HERE)))[:, SEEN]


@equation("T31")
def test_twist_of_the_sliding_law_is_that_of_the_product():
    kappa, phi = 4.0, 0.02
    twist, e, L = sliding_of_the_product(kappa, phi)
    same(sliding_twist(L, [sliding(one, gain, kappa, phi, sat) for one, gain in zip(e, GAINS)]), twist, 1e-9)


@formula("T32")
def learn_J(J, P, h, ds, rho):
    """J <- J + (ds - J h) h^T P / (rho + h^T P h)"""
    return J + np.outer(ds - J @ h, h @ P) / (rho + h @ P @ h)


@formula("T32")
def learn_P(P, h, rho):
    """P <- (P - P h h^T P / (rho + h^T P h)) / rho"""
    return (P - np.outer(P @ h, h @ P) / (rho + h @ P @ h)) / rho


@formula("T32")
def largest_trace(n, move):
    """trace P <= n / move^2"""
    return n / move**2


@formula("T32")
def first_P(move):
    """1 / move^2"""
    return 1 / move**2


@formula("T32")
def broyden(J, h, ds):
    """J + (ds - J h) h^T / (h^T h)"""
    return J + np.outer(ds - J @ h, h) / (h @ h)


@formula("T32")
def longest(move):
    """5 move"""
    return 5 * move


RHO, MOVE = 0.9, 0.01


@functools.lru_cache(maxsize=None)
def lesson():
    """Motions, changes of the features, and (J, P) of the product as it learns from them."""
    rng, outline = np.random.default_rng(3), OUTLINE[:4]
    motions = 2.0 * MOVE * rng.normal(size=(12, 6))
    changes = rng.normal(size=(12, 8)) * 0.01
    return motions, changes, product.learnt(tilted_pose(1), outline, motions, changes, RHO, MOVE)


@equation("T32")
def test_what_is_learnt_is_the_least_squares_that_forgets():
    # All motions at once: weights rho^(age), and the first J with the weight of `move` in all directions.
    motions, changes, states = lesson()
    J = first = states[0][0]
    P = first_P(MOVE) * np.eye(6)
    same(P, states[0][1])
    for k, (h, ds) in enumerate(zip(motions, changes), start=1):
        J, P = learn_J(J, P, h, ds, RHO), learn_P(P, h, RHO)
        weights = RHO ** np.arange(k - 1, -1, -1)
        information = (motions[:k].T * weights) @ motions[:k] + RHO**k * MOVE**2 * np.eye(6)
        moments = (changes[:k].T * weights) @ motions[:k] + RHO**k * MOVE**2 * first
        same(J, moments @ np.linalg.inv(information), 1e-9)
        same(P, np.linalg.inv(information), 1e-9)


@equation("T32")
def test_the_product_learns_so_and_grows_no_surer_of_its_ignorance_than_it_was():
    motions, changes, states = lesson()
    for h, ds, (J, P), (J_next, P_next) in zip(motions, changes, states, states[1:]):
        same(learn_J(J, P, h, ds, RHO), J_next, 1e-9)
        grown = learn_P(P, h, RHO)
        same(grown * min(1.0, largest_trace(6, MOVE) / np.trace(grown)), P_next, 1e-9)
    _, resting = product.learnt(tilted_pose(1), OUTLINE[:4], np.zeros((1, 6)), np.zeros((1, 8)), RHO, MOVE)
    same(np.trace(resting[1]), largest_trace(6, MOVE))


@equation("T32")
def test_at_first_and_without_memory_it_is_the_update_of_broyden():
    motions, changes, states = lesson()
    J = states[0][0]
    for h, ds in zip(motions[:3], changes[:3]):
        same(broyden(J, h, ds), learn_J(J, 7.0 * np.eye(6), h, ds, 1e-15), 1e-8)
        # The least change of J that explains ds.
        same(broyden(J, h, ds) - J, (ds - J @ h)[:, None] * np.linalg.pinv(h[:, None]))


@functools.lru_cache(maxsize=None)
def longest_step():
    """Motion, in radians and parts of Z*, that the product asks for in one image far away."""
    goal, outline, dt_s = tilted_pose(1), OUTLINE[:4], 0.1
    names = tuple(f"{axis}{k + 1}" for k in range(4) for axis in "xy")
    law = product.law_of("broyden", [30.0] * 8, goal, names, outline,
                         settings={"broyden": BroydenSettings("desired", RHO, MOVE)})
    twist, _, _ = product.twist_of(law, goal, moved(goal, [0.1, -0.1, 0.1, 0.2, 0.1, 0.5]), dt_s, outline)
    return np.linalg.norm(twist / [*[view(goal, outline).features.z_star_m] * 3, 1.0, 1.0, 1.0]) * dt_s


@equation("T32")
def test_one_image_asks_for_five_moves_at_most():
    same(longest(MOVE), longest_step())


@formula("T46")
def levenberg(lam, H, mu, b):
    """v = -lambda (H + mu diag(H))^-1 b"""
    return -lam * np.linalg.inv(H + mu * np.diag(np.diag(H))) @ b


@formula("T46")
def mu(damping, rms, rms_0):
    """mu = damping rms^2 / rms_0^2"""
    return damping * rms**2 / rms_0**2


@functools.lru_cache(maxsize=None)
def normal_equations():
    """L, e of made-up images, and the product's twists for three of them with the rms given."""
    rng = np.random.default_rng(2)
    L, e = rng.normal(size=(50, 6)) * [200, 180, 60, 110, 120, 40], rng.normal(size=50) * 20
    return L, e, product.photometric_twist(L.T @ L, L.T @ e, (20.0, 10.0, 40.0), 3.0, 0.5)


@equation("T46")
def test_photometric_law_is_the_damped_least_squares():
    L, e, twists = normal_equations()
    H, b = L.T @ L, L.T @ e
    for rms, twist in zip((20.0, 10.0, 40.0), twists):
        damping = min(0.5, mu(0.5, rms, 20.0))
        same(levenberg(3.0, H, damping, b), twist, 1e-9)
        # Least squares with a row more for each motion, as long as its column of L.
        more = np.vstack([L, np.sqrt(damping) * np.diag(np.linalg.norm(L, axis=0))])
        xi = np.linalg.lstsq(more, -np.r_[e, np.zeros(6)], rcond=None)[0]
        same(levenberg(3.0, H, damping, b), 3.0 * xi, 1e-9)


# --- T60 to T62: when the servo has arrived ---------------------------------------------------------------------------

TILT, OTHERS = [3, 4], [0, 1, 2, 5]
#: (T60) is of first order: the displacements here are of 1e-6, and what is left of 1e-11.
SMALL, FIRST_ORDER = 1e-6, 1e-10


@formula("T60")
def displacement(p_CgC, theta_u):
    """d = (p_CgC, theta u)"""
    return np.concatenate([p_CgC, theta_u])


@formula("T60")
def displacement_of(L_star, e):
    """d = L*^+ e"""
    return np.linalg.pinv(L_star) @ e


@formula("T60")
def displacement_beside_tilt(L_o, L_t, e, t):
    """d_o = L*_o^+ (e - L*_t t)"""
    return np.linalg.pinv(L_o) @ (e - L_t @ t)


def seen(names):
    """(bench, features, L*, error of a camera displaced by a known twist, that displacement)."""
    bench, features = Bench(), FeatureSet(names)
    reference = bench.servo.as_reference(bench.camera.features(bench.X_WG), bench.goal_q, bench.camera.star[0])
    L = features.matrix(View(reference.view, reference.plane_C))
    X_CgC = exponential_of(SMALL * np.array([1.0, -2.0, 0.5, 0.7, -0.4, 1.3]), 1.0)
    values = features.values(View(bench.camera.features(bench.X_WG @ X_CgC)))
    e = np.array(features.error(values, features.values(View(reference.view)), False))
    d = displacement(X_CgC[:3, 3], rotation_vector(X_CgC[:3, :3]))
    return reference, features, L, e, d


@equation("T60")
def test_the_errors_of_six_features_stand_for_the_displacement():
    reference, features, L, e, d = seen(("xn", "yn", "an", "px", "py", "alpha"))
    np.testing.assert_allclose(displacement_of(L, e), d, rtol=0.0, atol=1e2 * FIRST_ORDER)
    np.testing.assert_allclose(GoalPose(features, reference).of(e, None), displacement_of(L, e), rtol=1e-9)


@equation("T60")
def test_the_errors_of_four_features_and_the_tilt_of_the_joints_do():
    reference, features, L, e, d = seen(("xn", "yn", "an", "alpha"))
    found = displacement_beside_tilt(L[:, OTHERS], L[:, TILT], e, d[TILT])
    np.testing.assert_allclose(found, d[OTHERS], rtol=0.0, atol=FIRST_ORDER)
    np.testing.assert_allclose(GoalPose(features, reference).of(e, d[TILT])[OTHERS], found, rtol=1e-9)


@formula("T61")
def counted(mean, sigma, n, m):
    """sqrt(mean^2 + 4 sigma^2 (1/n + 1/m))"""
    return np.sqrt(mean**2 + 4.0 * sigma**2 * (1.0 / n + 1.0 / m))


@equation("T61")
def test_noise_of_images_and_goal_counts_as_distance():
    n, m, rng = 40, 5, np.random.default_rng(3)
    rule = StopRule(("a",), (1.0,), 0.0, StopSettings(position_m=1.0, rotation_rad=1.0), False, m)
    poses = rng.normal(size=n)[:, None] * np.array([0.01, 0.0, 0.0, 0.0, 0.02, 0.0])
    ways = np.linspace(0.3, 0.0, n)[:, None] * np.array([0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    for i, (pose, way) in enumerate(zip(poses, ways)):  # the camera ends at the goal, its joints say from where it came
        rule.arrived(i * 33_000_000, (0.0,), None, pose + way, pose_by(way))
    expected = counted(poses.mean(axis=0), poses.std(axis=0), n, m)
    same(rule.judged[1:], [expected[0], expected[4]])
    # It is a bound: of many goals and means of this kind, all but one in twenty lie nearer.
    goals, means = rng.normal(size=20000) / m**0.5, rng.normal(size=20000) / n**0.5
    assert 0.04 < np.mean(np.abs(means - goals) > counted(0.0, 1.0, n, m)) < 0.05


@formula("T62")
def lag(F, p):
    """F / p"""
    return F / p


@formula("T62")
def creep(i, F, p):
    """c = i F / p^2"""
    return i * F / p**2


@formula("T62")
def left(c, lam):
    """e = c / lambda"""
    return c / lam


def joint(F, p, i, lam, seconds, dt=1e-4):
    """(lag at first, speed at first, place at the end) of a joint pushed against friction, its set-point servoed to 0.

    Without mass it is where the controller's effort is F, or it sticks where it is less.
    """
    set_point, q, integral = lag_at_first(F, p, i), 0.0, 0.0
    first, speed = set_point - q, None
    for _ in range(round(seconds / dt)):
        integral += i * (set_point - q) * dt
        effort = p * (set_point - q) + integral
        step = (effort - np.clip(effort, -F, F)) / p
        q += step
        speed = step / dt if speed is None else speed
        set_point -= dt * lam * q
    return first, speed, q


def lag_at_first(F, p, i):
    """Set-point at which a joint at rest at 0 is about to slide, by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if p * middle < F else (low, middle)
    return high


@equation("T62")
def test_a_joint_creeps_and_the_law_holds_an_error():
    F, p, i, lam = 0.9, 70.0, 2.0, 3.0
    first, speed, q = joint(F, p, i, lam, 2.0)
    same([first], [lag(F, p)])
    np.testing.assert_allclose(speed, creep(i, F, p), rtol=1e-3)
    # The lag shrinks as the integral takes over, by i / p = 0.03 of it a second.
    np.testing.assert_allclose(q, left(creep(i, F, p), lam) * np.exp(-2.0 * i / p), rtol=0.02)
    same([left(creep(i, F, p), lam) * 1e3], [0.1224], 2e-3)
