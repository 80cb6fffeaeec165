"""T24, T25, T29, T30, T45: the pose of a target, laws on it, and targets that move."""
import functools

import numpy as np
import product
import views
from equations import equation, formula, same
from scenes import moments_of, moved, pose, rows_same
from scipy.spatial.transform import Rotation
from toy_plant import OUTLINE, Camera, picture
from views import STEP, exponential, parallel_pose, plane_of, tilted_pose

from aras_visual_servo.features.target.points_pose import PlanarPoints
from aras_visual_servo.features.target.target_pose import PlanarTarget

MEASURED = [(i, k - i) for k in (2, 3) for i in range(k, -1, -1)]
AWAY = np.array([0.02, -0.03, 0.04, 0.05, -0.06, 0.08])


def rotation_vector(R):
    return Rotation.from_matrix(R).as_rotvec()


# --- T24: pose of a known outline -------------------------------------------------------------------------------------


@formula("T24")
def measures(a, xg, yg, mu):
    """xg / sqrt(a)
    yg / sqrt(a)
    ln sqrt(a)
    mu_ij / a^((i+j+2)/2)"""
    return np.array([xg / np.sqrt(a), yg / np.sqrt(a), np.log(np.sqrt(a)),
                     *[mu[i, j] / a ** ((i + j + 2) / 2) for i, j in MEASURED]])


@formula("T24")
def explained(L, measured, predicted):
    """xi = L^+ (measured - predicted)"""
    return np.linalg.pinv(L) @ (measured - predicted)


@formula("T24")
def step(xi, X_CT, exp):
    """X_CT <- exp(-xi) X_CT"""
    return exp(-xi) @ X_CT


def exp(xi):
    return exponential(xi, 1.0)


def of_picture(xy):
    m, mu = moments_of(xy, 3)
    return measures(m[0, 0], m[1, 0] / m[0, 0], m[0, 1] / m[0, 0], mu)


@functools.lru_cache(maxsize=None)
def predicted(seed):
    """X_CT, and the product's measures and matrix there."""
    X_CT = np.linalg.inv(pose(seed))
    return (X_CT, *PlanarTarget([OUTLINE]).predicted(X_CT))


@functools.lru_cache(maxsize=None)
def improved(size):
    """The product's pose after one step from exp(size AWAY) beside the true one."""
    X_CT, value, _ = predicted(1)
    return PlanarTarget([OUTLINE]).improve(exp(size * AWAY) @ X_CT, value)[0]


@equation("T24")
def test_measures_are_those_of_the_product_and_only_one_tells_how_large_an_image_is():
    for seed in (1, 2):
        _, value, _ = predicted(seed)
        same(of_picture(picture(pose(seed))), value)
    magnified = of_picture(1.7 * picture(pose(1))) - of_picture(picture(pose(1)))
    same(magnified, np.log(1.7) * np.eye(10)[2])


@equation("T24")
def test_the_matrix_is_the_derivative_of_the_measures():
    slopes = views.differences(lambda X: of_picture(picture(X)), pose(1))
    rows_same(slopes, predicted(1)[2])


@equation("T24")
def test_a_step_leaves_the_square_of_what_was_wrong():
    X_CT, value, _ = predicted(1)
    left = []
    for size in (0.2, 0.1):
        start = exp(size * AWAY) @ X_CT
        here, L = PlanarTarget([OUTLINE]).predicted(start)
        found = step(explained(L, value, here), start, exp)
        same(found, improved(size), 1e-9)
        left.append(np.abs(found - X_CT).max())
    assert 3.0 < left[0] / left[1] < 5.0, left


# --- T25, T30: laws on the pose ---------------------------------------------------------------------------------------

GAINS = np.array([3.0, 2.0, 4.0, 1.5, 2.5, 1.0])
GOAL = tilted_pose(1)
HERE = moved(GOAL, [0.05, -0.04, 0.06, 0.2, -0.1, 0.5])


@formula("T25")
def home(R_CgC, Lambda, t):
    """v = -R_CgC^T Lambda t"""
    return -R_CgC.T @ Lambda @ t


@formula("T25")
def turn_home(Lambda, theta_u):
    """w = -Lambda theta u"""
    return -Lambda @ theta_u


def displacement(X):
    X_CgC = np.linalg.inv(GOAL) @ X
    return np.r_[X_CgC[:3, 3], rotation_vector(X_CgC[:3, :3])]


@functools.lru_cache(maxsize=None)
def pose_twist():
    """Twist and s of the product's law, by points in the taught plane."""
    law = product.law_of("pbvs", GAINS, GOAL, product.POSE, pose_from="points")
    return product.twist_of(law, GOAL, HERE)[:2]


@equation("T25")
def test_the_camera_goes_straight_home_and_turns_about_one_axis():
    X_CgC, (twist, s) = np.linalg.inv(GOAL) @ HERE, pose_twist()
    there = displacement(HERE)
    V = np.r_[home(X_CgC[:3, :3], np.diag(GAINS[:3]), there[:3]), turn_home(np.diag(GAINS[3:]), there[3:])]
    same(s, there, 1e-7)
    same(V, twist, 1e-7)  # of the pose found
    V = np.r_[home(X_CgC[:3, :3], 2.0 * np.eye(3), there[:3]), turn_home(2.0 * np.eye(3), there[3:])]
    rate = (displacement(moved(HERE, STEP * V)) - displacement(moved(HERE, -STEP * V))) / (2.0 * STEP)
    same(rate, -2.0 * there, 1e-7)


@formula("T30")
def hybrid_features(x, y, Z, Z_star, theta_u):
    """s = (x, y, ln(Z/Z*), theta u)"""
    return np.array([x, y, np.log(Z / Z_star), *theta_u])


@formula("T30")
def L_z(x, y, Z):
    """L_z = [0, 0, -1/Z, -y, x, 0]"""
    return np.array([0, 0, -1 / Z, -y, x, 0])


@formula("T30")
def hybrid_turn(Lambda, theta_u):
    """w = -Lambda theta u"""
    return -Lambda @ theta_u


@functools.lru_cache(maxsize=None)
def reference_point():
    """(4,) point of the target's plane seen at the centroid of the goal's view, in the world; its depth there."""
    m, _ = moments_of(picture(GOAL), 1)
    ray = np.array([m[1, 0], m[0, 1], m[0, 0]]) / m[0, 0]
    Z_star = 1.0 / (plane_of(GOAL) @ ray)
    return GOAL @ [*(Z_star * ray), 1.0], Z_star


@functools.lru_cache(maxsize=None)
def hybrid_twist():
    law = product.law_of("hybrid", GAINS, GOAL, product.HYBRID, pose_from="points")
    return product.twist_of(law, GOAL, HERE)


def seen_point(X):
    x, y, z = (np.linalg.inv(X) @ reference_point()[0])[:3]
    return x / z, y / z, z


@equation("T30")
def test_row_of_the_logarithm_of_the_depth_is_its_derivative():
    slopes = views.differences(lambda X: np.log(seen_point(X)[2]), HERE)
    rows_same(L_z(*seen_point(HERE)), slopes)


@equation("T30")
def test_the_point_goes_straight_home_and_the_twist_is_that_of_the_product():
    (x, y, Z), (twist, s, e) = seen_point(HERE), hybrid_twist()
    theta_u = displacement(HERE)[3:]
    same(hybrid_features(x, y, Z, reference_point()[1], theta_u), s, 1e-7)
    w = hybrid_turn(np.diag(GAINS[3:]), theta_u)
    L = np.array([[-1 / Z, 0, x / Z, x * y, -(1 + x**2), y], [0, -1 / Z, y / Z, 1 + y**2, -x * y, -x], L_z(x, y, Z)])
    v = np.linalg.solve(L[:, :3], -GAINS[:3] * e[:3] - L[:, 3:] @ w)
    same(np.r_[v, w], twist, 1e-6)
    ends = [np.array(seen_point(moved(HERE, t * twist))[:2]) for t in (STEP, -STEP)]
    same((ends[0] - ends[1]) / (2.0 * STEP), -GAINS[:2] * e[:2], 1e-6)


# --- T29: pose of points ----------------------------------------------------------------------------------------------


@formula("T29")
def mirrored(I, s):
    """I - 2 s s^T"""
    return I - 2 * np.outer(s, s)


@formula("T29")
def place(x_star, y_star, A, B, C):
    """P = (x*, y*, 1) / (A x* + B y* + C)"""
    return np.array([x_star, y_star, 1]) / (A * x_star + B * y_star + C)


@equation("T29")
def test_taught_points_lie_where_rays_meet_the_plane():
    X_CW = np.linalg.inv(GOAL)
    corners = (np.c_[OUTLINE, np.zeros(len(OUTLINE)), np.ones(len(OUTLINE))] @ X_CW.T)[:, :3]
    found = np.array([place(*xy, *plane_of(GOAL)) for xy in picture(GOAL)])
    same(found, corners)
    # A depth that is wrong by a factor makes the way as much longer, and leaves the rotation.
    X_CCg, residual, _ = PlanarPoints(1.25 * found).follow(np.eye(4), picture(HERE))
    X_true = np.linalg.inv(HERE) @ GOAL
    assert residual < 1e-9
    same(X_CCg[:3, 3], 1.25 * X_true[:3, 3], 1e-7)
    same(X_CCg[:3, :3], X_true[:3, :3], 1e-7)


@equation("T29")
def test_seen_from_afar_the_mirrored_pose_looks_the_same():
    s = np.array([0.1, -0.2, 1.0]) / np.linalg.norm([0.1, -0.2, 1.0])
    axes = np.linalg.inv(GOAL)[:3, :2]
    there = mirrored(np.eye(3), s) @ axes
    across = np.eye(3) - np.outer(s, s)  # what a view from afar sees of a direction
    same(across @ there, across @ axes)
    same(s @ there, -(s @ axes))
    X_CT = PlanarPoints(np.c_[OUTLINE, np.zeros(len(OUTLINE))]).find(picture(GOAL))
    same(X_CT, np.linalg.inv(GOAL), 1e-7)


# --- T45: targets that move -------------------------------------------------------------------------------------------


@formula("T45")
def goal_of_parallel(e_alpha, s, s_star, Rz):
    """(Rz(e_alpha), s - Rz(e_alpha) s*)"""
    return Rz(e_alpha), s - Rz(e_alpha) @ s_star


@formula("T45")
def goal_nearby(L_star, e, exp):
    """exp(-L*^+ e)"""
    return exp(-np.linalg.pinv(L_star) @ e)


@formula("T45")
def F(dt):
    """F = [[1, dt], [0, 1]]"""
    return np.array([[1, dt], [0, 1]])


@formula("T45")
def Q(sigma_a, dt):
    """Q = sigma_a^2 [[dt^4/4, dt^3/2], [dt^3/2, dt^2]]"""
    return sigma_a**2 * np.array([[dt**4 / 4, dt**3 / 2], [dt**3 / 2, dt**2]])


@formula("T45")
def along(R_CB, omega, v_P, p_CP):
    """w = R_CB omega
    v = R_CB v_P - w x p_CP"""
    w = R_CB @ omega
    v = R_CB @ v_P - np.cross(w, p_CP)
    return v, w


@formula("T45")
def by_share(L, s_dot, V):
    """-L^+ (s_dot - L V)"""
    return -np.linalg.pinv(L) @ (s_dot - L @ V)


def Rz(angle):
    return Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()


LEVEL = parallel_pose()
NEAR = moved(LEVEL, [0.04, -0.05, 0.07, 0.0, 0.0, 0.3])


def level_features(X):
    """(xn, yn, an) with the true depth as an, and alpha."""
    f = Camera(None).features(X)
    return np.array([X[2, 3] * f.xg, X[2, 3] * f.yg, X[2, 3]]), f.alpha


@functools.lru_cache(maxsize=None)
def goals_of_the_product(size):
    """(R_CG, p_CP, point_G) by six features from exp(size AWAY) beside the tilted goal, their L* and e."""
    here, names = moved(GOAL, size * AWAY), product.SIX
    features = product.FeatureSet(names)
    s, s_star = (np.array(features.values(views.view(X))) for X in (here, GOAL))
    L_star = features.matrix(views.view(GOAL, plane=plane_of(GOAL)))
    return product.goal_from_error(names, GOAL, here), L_star, s - s_star


@equation("T45")
def test_the_error_says_where_the_goal_is():
    X_CG = np.linalg.inv(NEAR) @ LEVEL
    (s, alpha), (s_star, alpha_star) = level_features(NEAR), level_features(LEVEL)
    R, t = goal_of_parallel(alpha - alpha_star, s, s_star, Rz)
    same(R, X_CG[:3, :3])
    same(t, X_CG[:3, 3])
    same(R, product.goal_from_error(product.FOUR, LEVEL, NEAR)[0])
    left = []
    for size in (0.2, 0.1):
        (R_CG, p_CP, point_G), L_star, e = goals_of_the_product(size)
        found = goal_nearby(L_star, e, exp)
        same(found[:3, :3], R_CG, 1e-8)
        same(found[:3, :3] @ point_G + found[:3, 3], p_CP, 1e-8)
        left.append(np.abs(found - np.linalg.inv(moved(GOAL, size * AWAY)) @ GOAL).max())
    assert 3.0 < left[0] / left[1] < 5.0, left


@equation("T45")
def test_filter_is_that_of_an_even_motion_with_white_acceleration():
    sigma_a, noise, speed, dt = 0.5, 0.0003, 0.1, 0.04
    by_acceleration = np.array([0.5 * dt**2, dt])  # of place and velocity, while it lasts from image to image
    same(Q(sigma_a, dt), sigma_a**2 * np.outer(by_acceleration, by_acceleration))
    same(F(dt) @ [0.3, 0.7], [0.3 + 0.7 * dt, 0.7])
    P = np.diag([noise**2, speed**2])
    for gains in filter_gains(sigma_a, noise, speed, dt, 20):
        P = F(dt) @ P @ F(dt).T + Q(sigma_a, dt)
        K = P[:, 0] / (P[0, 0] + noise**2)
        P = (np.eye(2) - np.outer(K, [1.0, 0.0])) @ P
        same(gains, K)


@functools.lru_cache(maxsize=None)
def filter_gains(*arguments):
    return product.filter_gains(*arguments)


TURN, SPEED = np.array([0.0, 0.0, 0.6]), np.array([0.05, -0.08, 0.02])  # of a target that stays level


def target_at(t, turn=TURN, speed=SPEED):
    """Pose in the base of a target's frame, at first the base's own: its origin moves evenly, and it turns evenly."""
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = Rotation.from_rotvec(t * turn).as_matrix(), t * speed
    return X


@functools.lru_cache(maxsize=None)
def share():
    """L, s_dot, V for a target and a camera that both move, and the twist of a camera that is fixed to the target."""
    V, turn = np.array([0.1, 0.2, -0.1, 0.3, -0.2, 0.4]), np.array([0.2, -0.3, 0.6])
    features = product.FeatureSet(product.SIX)

    def s(t):  # only where the camera is, seen from the target, matters
        return np.array(features.values(views.view(np.linalg.inv(target_at(t, turn)) @ moved(GOAL, t * V))))

    L = features.matrix(views.view(GOAL, plane=plane_of(GOAL)))
    X = [np.linalg.inv(GOAL) @ target_at(t, turn) @ GOAL for t in (STEP, -STEP)]
    fixed = (X[0] - X[1]) / (2.0 * STEP)
    return L, (s(STEP) - s(-STEP)) / (2.0 * STEP), V, np.r_[fixed[:3, 3], fixed[2, 1], fixed[0, 2], fixed[1, 0]], turn


@equation("T45")
def test_a_camera_fixed_to_the_target_moves_so():
    L, s_dot, V, fixed, turn = share()
    R_CB = GOAL[:3, :3].T
    v, w = along(R_CB, turn, SPEED, R_CB @ (np.zeros(3) - GOAL[:3, 3]))  # the point is the origin of the target's frame
    same(np.r_[v, w], fixed, 1e-8)
    same(by_share(L, s_dot, V), fixed, 1e-6)


@equation("T45")
def test_the_product_goes_along_so():
    twist, p_CP, X_BC = going_along()
    v, w = along(X_BC[:3, :3].T, TURN, SPEED, p_CP)
    same(np.r_[v, w], twist, 1e-8)


@functools.lru_cache(maxsize=None)
def going_along():
    """Twist that the product adds for a target whose centroid moves with SPEED, p_CP and X_BC, at the second image."""
    dt_s = 0.05
    m, _ = moments_of(OUTLINE, 1)
    middle = np.array([m[1, 0], m[0, 1], 0.0]) / m[0, 0]
    first, cameras = np.eye(4), (NEAR, moved(NEAR, [0.01, 0.02, 0.01, 0, 0, 0.1]))
    second = target_at(dt_s)
    second[:3, 3] = middle + dt_s * SPEED - second[:3, :3] @ middle
    twist = product.along_with_target(LEVEL, cameras, (first, second), dt_s, SPEED, TURN)
    X_CT = np.linalg.inv(cameras[1]) @ second
    return twist, (X_CT @ [*middle, 1.0])[:3], cameras[1]
