"""T49 to T53: the simulated robot, contacts, and the fisheye. The simulator is C++, and its own tests hold it to these
closed forms; here they are worked out another way: constrained least squares, small simulations, differences."""
import functools

import numpy as np
from equations import equation, formula, same

RNG = np.random.default_rng(7)
G = 9.81


def mass_matrix(n, seed):
    """A symmetric, positive definite one."""
    A = np.random.default_rng(seed).normal(size=(n, n))
    return A @ A.T + n * np.eye(n)


# --- T49, T50: what is eliminated -------------------------------------------------------------------------------------


@formula("T49")
def joints(K, q_c, c):
    """q = K q_c + c"""
    return K @ q_c + c


@formula("T49")
def M_c(K, M):
    """M_c = K^T M K"""
    return K.T @ M @ K


@formula("T49")
def momentum_c(K, M, v_free):
    """M_c v_c = K^T M v_free"""
    return K.T @ M @ v_free


@formula("T49")
def effort_c(K, effort):
    """Efforts go by K^T"""
    return K.T @ effort


#: J2 follows J1 by -2, J4 follows J3 by 0.5.
K = np.array([[1.0, 0.0], [-2.0, 0.0], [0.0, 1.0], [0.0, 0.5]])


@equation("T49")
def test_followers_move_as_the_principle_of_least_constraint_says():
    M, v_free = mass_matrix(4, 1), np.array([0.3, -0.5, 0.8, 0.1])
    v_c = np.linalg.solve(M_c(K, M), momentum_c(K, M, v_free))
    # Of all motions K v_c the one nearest to v_free, measured by the masses: Gauss.
    root = np.linalg.cholesky(M).T
    same(v_c, np.linalg.lstsq(root @ K, root @ v_free, rcond=None)[0])
    # And with the constraint as an equation and its multipliers.
    N = np.array([[2.0, 1.0, 0.0, 0.0], [0.0, 0.0, -0.5, 1.0]])  # N K = 0
    system = np.block([[M, N.T], [N, np.zeros((2, 2))]])
    same(joints(K, v_c, np.zeros(4)), np.linalg.solve(system, np.r_[M @ v_free, 0.0, 0.0])[:4])


@equation("T49")
def test_joints_follow_and_efforts_do_the_same_work():
    q_c, c = np.array([0.4, -0.7]), np.array([0.0, 0.1, 0.0, -0.2])
    same(joints(K, q_c, c), [0.4, -2.0 * 0.4 + 0.1, -0.7, 0.5 * -0.7 - 0.2])
    effort, v_c = np.array([1.0, -3.0, 0.5, 2.0]), np.array([0.3, 0.8])
    same(effort_c(K, effort) @ v_c, effort @ (K @ v_c))
    # Damping of a follower counts by the square of its multiplier: two gears of inertia 3 and 5, ratio -2.
    same(M_c(K[:2, :1], np.diag([3.0, 5.0])), [[3.0 + 4.0 * 5.0]])


@formula("T50")
def schur(M_jj, M_jb, M_bb, M_bj):
    """M_jj - M_jb M_bb^-1 M_bj"""
    return M_jj - M_jb @ np.linalg.inv(M_bb) @ M_bj


@formula("T50")
def base(v_b_free, M_bb, M_bj, v_j, v_j_free):
    """v_b = v_b,free - M_bb^-1 M_bj (v_j - v_j,free)"""
    return v_b_free - np.linalg.inv(M_bb) @ M_bj @ (v_j - v_j_free)


@equation("T50")
def test_a_free_base_follows_what_the_joints_do():
    M, v_free = mass_matrix(9, 2), RNG.normal(size=9)
    effort = np.array([0.7, -0.4, 1.1])  # impulses of the joints, none on the base
    v = v_free + np.linalg.solve(M, np.r_[np.zeros(6), effort])
    v_j = v_free[6:] + np.linalg.solve(schur(M[6:, 6:], M[6:, :6], M[:6, :6], M[:6, 6:]), effort)
    same(v_j, v[6:])
    same(base(v_free[:6], M[:6, :6], M[:6, 6:], v_j, v_free[6:]), v[:6])


# --- T51, T52: contact ------------------------------------------------------------------------------------------------


@formula("T51")
def normal_impulse(dt, k, d, b, u_n):
    """lambda_n = dt max(0, k (d - dt u_n) - b u_n)"""
    return dt * max(0, k * (d - dt * u_n) - b * u_n)


@formula("T51")
def in_cone(lambda_t, mu, lambda_n):
    """|lambda_t| <= mu lambda_n"""
    return abs(lambda_t) <= mu * lambda_n


@formula("T51")
def rest_depth(m, g, n, k):
    """m g / (n k)"""
    return m * g / (n * k)


@formula("T51")
def holds(angle, mu):
    """tan(angle) <= mu"""
    return np.tan(angle) <= mu


@formula("T51")
def sliding(g, angle, mu):
    """g (sin(angle) - mu cos(angle))"""
    return g * (np.sin(angle) - mu * np.cos(angle))


@formula("T51")
def rolling(g, angle):
    """5/7 g sin(angle)"""
    return 5 / 7 * g * np.sin(angle)


@formula("T51")
def rolling_speed(v):
    """5/7 v"""
    return 5 / 7 * v


@formula("T51")
def bounce(zeta, omega, dt):
    """exp(-pi (zeta + omega dt / 2))"""
    return np.exp(-np.pi * (zeta + omega * dt / 2))


@formula("T51")
def omega_zeta(k, m, b):
    """omega = sqrt(k / m)
    zeta = b / (2 sqrt(k m))"""
    return np.sqrt(k / m), b / (2 * np.sqrt(k * m))


def stepped(u_free, m, dt, k, d, b):
    """Velocity of a point mass after a step in which its contact acts at the velocity of the step's end."""
    here, before = normal_impulse(dt, k, d, b, u_free), normal_impulse(dt, k, d, b, u_free - 1.0)
    if here <= 0.0:
        return u_free
    return u_free + here / (m + before - here)  # the impulse is linear where it acts


@equation("T51")
def test_the_impulse_is_that_of_spring_and_damper_at_the_end_of_the_step_and_never_pulls():
    dt, k, d, b = 1e-3, 1e5, 1e-3, 30.0
    for u_n in (-0.4, 0.0, 0.3):
        deeper = d - dt * u_n
        same(normal_impulse(dt, k, d, b, u_n), dt * (k * deeper - b * u_n))
    assert normal_impulse(dt, k, d, b, 2.0) == 0.0
    same(1.0 + normal_impulse(dt, k, -1e-3, b, 0.5), 1.0)


@equation("T51")
def test_a_body_rests_at_its_depth():
    m, n, k, b, dt = 2.0, 4, 1e5, 200.0, 1e-3
    d = rest_depth(m, G, n, k)
    same(n * normal_impulse(dt, k, d, b, 0.0), m * G * dt)
    same(1.0 + stepped(-G * dt, m / n, dt, k, d, b), 1.0)


@equation("T51")
def test_a_dropped_mass_bounces_with_the_exponential():
    for k, b, dt in ((1e4, 0.0, 1e-4), (1e4, 1.0, 2e-6), (4e4, 0.6, 1e-5)):
        m, v = 1.0, 1.0
        depth, u, omega = 0.0, -v, np.sqrt(k / m)
        for _ in range(round(2.0 * np.pi / omega / dt)):
            u = stepped(u, m, dt, k, depth, b)
            depth -= dt * u
            if depth <= 0.0:
                break
        w, zeta = omega_zeta(k, m, b)
        # The exponent to a few thousandths: it is the first term of a series in zeta and omega dt.
        same(np.log(bounce(zeta, w, dt)), np.log(u / v), 4e-3)


@equation("T51")
def test_omega_and_zeta_are_those_of_the_oscillator():
    k, m, b = 300.0, 2.0, 5.0
    w, zeta = omega_zeta(k, m, b)
    root = np.roots([m, b, k])[0]  # of m s^2 + b s + k = 0
    same([w, -zeta * w], [abs(root), root.real])


@equation("T51")
def test_a_body_on_an_incline_holds_or_slides():
    m, dt, mu = 2.0, 1e-3, 0.5
    for angle in (0.3, np.arctan(mu) - 1e-3, np.arctan(mu) + 1e-3, 0.8):
        normal, along = m * G * np.cos(angle) * dt, m * G * np.sin(angle) * dt  # what gravity does in a step
        assert holds(angle, mu) == in_cone(along, mu, normal), angle
        assert holds(angle, mu) == (sliding(G, angle, mu) <= 0.0), angle
        same(sliding(G, angle, mu), (along - mu * normal) / (m * dt))


@equation("T51")
def test_a_sphere_rolls_with_five_sevenths():
    m, r, angle, v = 3.0, 0.07, 0.3, 1.4
    inertia = 2.0 / 5.0 * m * r * r
    # m a = m g sin - f, inertia a / r = f r.
    a, _ = np.linalg.solve([[m, 1.0], [inertia / r, -r]], [m * G * np.sin(angle), 0.0])
    same(rolling(G, angle), a)
    # Friction slows it and spins it up until it rolls: v' = v - p / m, inertia v' / r = p r.
    end, _ = np.linalg.solve([[1.0, 1.0 / m], [inertia / r, -r]], [v, 0.0])
    same(rolling_speed(v), end)


@formula("T52")
def velocities(u_free, D, impulses):
    """u = u_free + D lambda"""
    return u_free + D @ impulses


@formula("T52")
def answers(J, M, dt, slopes):
    """D = J (M + dt G)^-1 J^T"""
    return J @ np.linalg.inv(M + dt * slopes) @ J.T


@formula("T52")
def next_normal(lambda_n, u_n, c, w, D_nn):
    """lambda_n <- max(0, lambda_n - (u_n + c lambda_n - w) / (D_nn + c))"""
    return max(0, lambda_n - (u_n + c * lambda_n - w) / (D_nn + c))


@formula("T52")
def c_w(dt, k, b, d):
    """c = 1 / (dt (dt k + b))
    w = k d / (dt k + b)"""
    return 1 / (dt * (dt * k + b)), k * d / (dt * k + b)


@formula("T52")
def next_tangential(lambda_t, u_t, D_t):
    """lambda_t - u_t / D_t"""
    return lambda_t - u_t / D_t


DT, STIFFNESS, LOSS, MU = 1e-3, 1e6, 2000.0, 0.4


@functools.lru_cache(maxsize=None)
def island():
    """J, M, G, u_free, depths of three points of a system of nine coordinates; rows (n, t1, t2) of each point."""
    rng = np.random.default_rng(11)
    J = np.eye(9) + 0.2 * rng.normal(size=(9, 9))
    u_free = np.array([-0.8, 0.05, 0.02, -0.3, 0.9, -0.7, 0.6, 0.3, 0.1])
    return J, mass_matrix(9, 3), np.diag(rng.uniform(10.0, 500.0, 9)), u_free, (2e-4, 1e-4, 0.0)


def nearest_in_cone(lambda_t, radius):
    length = np.hypot(*lambda_t)
    return lambda_t if length <= radius else lambda_t * (radius / length)


@equation("T52")
def test_answers_are_those_of_an_implicit_step():
    J, M, slopes, *_ = island()
    impulses = np.linspace(-1.0, 1.0, 9)
    # M dv = J^T lambda - dt G dv: drives and frictions act at the velocity of the step's end.
    dv = np.linalg.lstsq(M + DT * slopes, J.T @ impulses, rcond=None)[0]
    same(velocities(np.zeros(9), answers(J, M, DT, slopes), impulses), J @ dv)
    same(velocities(np.arange(9.0), answers(J, M, DT, slopes), np.zeros(9)), np.arange(9.0))


@equation("T52")
def test_a_sweep_solves_the_equation_of_its_point():
    for lambda_n, u_n, d, D_nn in ((0.1, -0.4, 1e-4, 0.3), (0.0, -0.2, 0.0, 0.7)):
        c, w = c_w(DT, STIFFNESS, LOSS, d)
        found = next_normal(lambda_n, u_n, c, w, D_nn)
        after = u_n + D_nn * (found - lambda_n)
        same(found, DT * (STIFFNESS * (d - DT * after) - LOSS * after))
    c, w = c_w(DT, STIFFNESS, LOSS, 0.0)
    assert next_normal(0.0, 0.5, c, w, 0.3) == 0.0  # coming apart
    lambda_t, u_t = np.array([0.02, -0.01]), np.array([0.3, 0.4])
    same(1.0 + u_t + 0.7 * (next_tangential(lambda_t, u_t, 0.7) - lambda_t), np.ones(2))


@functools.lru_cache(maxsize=None)
def answers_of_the_island():
    J, M, slopes, *_ = island()
    return J @ np.linalg.solve(M + DT * slopes, J.T)


@equation("T52")
def test_fixed_points_of_the_sweeps_are_the_contacts_of_T51():
    D, (*_, u_free, depths), impulses = answers_of_the_island(), island(), np.zeros(9)
    for _ in range(200):
        before = impulses.copy()
        for point, d in enumerate(depths):
            n, t = 3 * point, slice(3 * point + 1, 3 * point + 3)
            c, w = c_w(DT, STIFFNESS, LOSS, d)
            impulses[n] = next_normal(impulses[n], u_free[n] + D[n] @ impulses, c, w, D[n, n])
            u_t = u_free[t] + D[t] @ impulses
            impulses[t] = nearest_in_cone(next_tangential(impulses[t], u_t, np.linalg.norm(D[t, t], 2)),
                                          MU * impulses[n])
        if np.abs(impulses - before).max() <= 1e-14 * np.abs(impulses).max():
            break
    u, cases = u_free + D @ impulses, []
    for point, d in enumerate(depths):
        n, t = 3 * point, slice(3 * point + 1, 3 * point + 3)
        normal = DT * max(0.0, STIFFNESS * (d - DT * u[n]) - LOSS * u[n])
        same(1.0 + impulses[n], 1.0 + normal, 1e-9)
        sticks = np.hypot(*impulses[t]) < (1.0 - 1e-9) * MU * impulses[n]
        if sticks:
            assert np.abs(u[t]).max() < 1e-9
        elif impulses[n] > 0.0:
            same(impulses[t] / np.hypot(*impulses[t]), -u[t] / np.hypot(*u[t]), 1e-6)
        cases.append("sticks" if sticks else "slides" if impulses[n] > 0.0 else "apart")
    assert sorted(cases) == ["apart", "slides", "sticks"], cases


# --- T53: the fisheye -------------------------------------------------------------------------------------------------

LENS = (-0.03, 0.004, -0.0005, 0.00002)


@formula("T53")
def from_axis(X, Y, Z):
    """theta = atan2(sqrt(X^2 + Y^2), Z)"""
    return np.arctan2(np.sqrt(X**2 + Y**2), Z)


@formula("T53")
def radius(theta, k1, k2, k3, k4):
    """r = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)"""
    return theta * (1 + k1 * theta**2 + k2 * theta**4 + k3 * theta**6 + k4 * theta**8)


@formula("T53")
def drawn_at(f, r, X, Y):
    """f r (X, Y) / sqrt(X^2 + Y^2)"""
    return f * r * np.array([X, Y]) / np.sqrt(X**2 + Y**2)


@formula("T53")
def slope(theta, k1, k2, k3, k4):
    """dr/dtheta = 1 + 3 k1 theta^2 + 5 k2 theta^4 + 7 k3 theta^6 + 9 k4 theta^8"""
    return 1 + 3 * k1 * theta**2 + 5 * k2 * theta**4 + 7 * k3 * theta**6 + 9 * k4 * theta**8


@formula("T53")
def farthest_of_five_faces():
    """pi - atan(sqrt(2))"""
    return np.pi - np.arctan(np.sqrt(2))


@equation("T53")
def test_a_point_is_drawn_in_its_direction_and_as_far_out_as_its_angle_says():
    for X, Y, Z in np.array([[0.3, -0.4, 1.2], [0.3, -0.4, -0.2], [-0.1, 0.2, 0.01]]):
        ray = np.array([X, Y, Z]) / np.linalg.norm([X, Y, Z])
        theta = from_axis(X, Y, Z)
        same(np.cos(theta), ray[2])
        assert theta >= 0.0
        u, v = drawn_at(195.0, theta, X, Y)
        same(np.hypot(u, v), 195.0 * np.arccos(ray[2]))
        same([u * Y, u], [v * X, abs(u) * np.sign(X)])


@equation("T53")
def test_the_slope_of_the_lens_is_its_derivative():
    step = 1e-5
    for theta in (0.0, 0.4, 1.1, 2.0):
        for lens in (LENS, (0.2, 0.0, 0.0, 0.0), (0.0, 0.2, 0.0, 0.0), (0.0, 0.0, 0.2, 0.0), (0.0, 0.0, 0.0, 0.2)):
            expected = (radius(theta + step, *lens) - radius(theta - step, *lens)) / (2 * step)
            same(slope(theta, *lens), expected, 1e-7)
    same([radius(0.5, 0.0, 0.0, 0.0, 0.0), radius(1.0, *LENS)], [0.5, 1.0 + sum(LENS)])


@equation("T53")
def test_five_faces_of_a_cube_hold_every_ray_up_to_the_corners_of_the_sixth():
    corner = np.array([1.0, 1.0, -1.0]) / np.sqrt(3.0)
    same(farthest_of_five_faces(), np.arccos(corner[2]))
    same(np.degrees(farthest_of_five_faces()), 125.3, 1e-3)
    rays = np.random.default_rng(1).normal(size=(20000, 3))
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    in_the_sixth = rays[:, 2] <= -np.abs(rays[:, :2]).max(axis=1)
    nearest = np.arccos(rays[in_the_sixth, 2]).min()
    assert 0.0 < nearest - farthest_of_five_faces() < 0.02


@equation("T53")
def test_a_straight_line_is_a_great_circle():
    a, b = np.array([0.4, -0.3, 0.8]), np.array([-0.6, 0.5, -0.7])
    normal = np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    for part in np.linspace(0.0, 1.0, 9):
        p = a + part * (b - a)
        theta = from_axis(*p)
        ray = np.r_[np.sin(theta) * p[:2] / np.hypot(*p[:2]), np.cos(theta)]
        assert abs(normal @ ray) < 1e-12
