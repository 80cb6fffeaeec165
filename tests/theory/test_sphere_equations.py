"""T70 to T74: circles, spheres, rays on the unit sphere, and points with depths. Depths and keypoints are read in C++,
whose own tests hold it to these equations (camera `rigid_motion_test.cpp`, `depth_reader_test.cpp`)."""
import functools

import numpy as np
import round_views as rounds
import views
from equations import equation, formula, same
from scenes import SEEDS, pose, rows_same
from views import exponential, plane_of

from aras_visual_servo_camera import MomentExtractor
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.features.kinds import circle as circles
from aras_visual_servo.features.points import ray_rows
from aras_visual_servo.features.target.solid_points import SolidPoints
from aras_visual_servo.ground.types import Features

RADIUS, CENTRE = 0.07, (0.03, -0.02, 0.05)
BOARD = np.array([[-0.09, -0.05, 0.0], [0.09, -0.05, 0.0], [0.08, 0.06, 0.0], [-0.09, 0.05, 0.0], [0.02, 0.01, 0.0]])
SPACE = np.array([[-0.1, -0.08, 0.0], [0.1, -0.06, 0.12], [0.08, 0.09, 0.05], [-0.07, 0.05, 0.2], [0.01, 0.0, 0.1]])


def skew(a):
    """[a]x"""
    return np.cross(np.eye(3), a).T @ np.diag([-1.0, -1.0, -1.0])


def in_camera(points, X_WC):
    return (np.c_[points, np.ones(len(points))] @ np.linalg.inv(X_WC).T)[:, :3]


# --- T70: circles -----------------------------------------------------------------------------------------------------


@formula("T70")
def L_ellipse(x, y, n20, n11, n02, plane):
    """1/Z = A x + B y + C
    p = A n20 + B n11
    q = A n11 + B n02
    L_x   = [ -1/Z, 0, x/Z + 4 p, x y + 4 n11, -(1 + x^2 + 4 n20), y ]
    L_y   = [ 0, -1/Z, y/Z + 4 q, 1 + y^2 + 4 n02, -(x y + 4 n11), -x ]
    L_n20 = [ -2 p, 0, 2 (n20/Z + x p), 2 (y n20 + x n11), -4 x n20, 2 n11 ]
    L_n11 = [ -q, -p, 2 n11/Z + x q + y p, x n02 + 3 y n11, -(y n20 + 3 x n11), n02 - n20 ]
    L_n02 = [ 0, -2 q, 2 (n02/Z + y q), 4 y n02, -2 (x n02 + y n11), -2 n11 ]"""
    A, B, C = plane
    Z = 1 / (A * x + B * y + C)
    p = A * n20 + B * n11
    q = A * n11 + B * n02
    return np.array([
        [-1 / Z, 0, x / Z + 4 * p, x * y + 4 * n11, -(1 + x**2 + 4 * n20), y],
        [0, -1 / Z, y / Z + 4 * q, 1 + y**2 + 4 * n02, -(x * y + 4 * n11), -x],
        [-2 * p, 0, 2 * (n20 / Z + x * p), 2 * (y * n20 + x * n11), -4 * x * n20, 2 * n11],
        [-q, -p, 2 * n11 / Z + x * q + y * p, x * n02 + 3 * y * n11, -(y * n20 + 3 * x * n11), n02 - n20],
        [0, -2 * q, 2 * (n02 / Z + y * q), 4 * y * n02, -2 * (x * n02 + y * n11), -2 * n11]])


@formula("T70")
def area_of_ellipse(n20, n11, n02):
    """4 pi sqrt(n20 n02 - n11^2)"""
    return 4 * np.pi * np.sqrt(n20 * n02 - n11**2)


def of_circle(X):
    return rounds.circle(X, RADIUS, CENTRE[:2])


@functools.lru_cache(maxsize=None)
def circle_truth(seed):
    """Differences of (x, y, n20, n11, n02) of a circle's image, and the product's rows."""
    view = rounds.as_view(of_circle(pose(seed)), plane_of(pose(seed)))
    return views.differences(of_circle, pose(seed)), FeatureSet(("xe", "ye", "e20", "e11", "e02")).matrix(view)


@equation("T70")
def test_rows_of_a_circle_are_its_derivatives():
    for seed in SEEDS:
        found, (slopes, product) = L_ellipse(*of_circle(pose(seed)), plane_of(pose(seed))), circle_truth(seed)
        rows_same(found, slopes)
        rows_same(found, product, 1e-12)


@equation("T70")
def test_area_tells_an_ellipse_from_a_square():
    angle = 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    n = turn @ np.diag([0.3**2, 0.2**2]) @ turn.T / 4  # half axes 0.3 and 0.2
    same(area_of_ellipse(n[0, 0], n[0, 1], n[1, 1]), np.pi * 0.3 * 0.2)
    same(1.0 / area_of_ellipse(1 / 12, 0.0, 1 / 12), 0.955, 1e-3)  # of the unit square
    assert 1.0 - 0.955 > circles.NOT_ELLIPTIC


# --- T71: spheres -----------------------------------------------------------------------------------------------------


@formula("T71")
def on_cone(s, c, xi):
    """s . c = cos xi |s|"""
    return s @ c, np.cos(xi) * np.linalg.norm(s)


@formula("T71")
def axis_and_sine(R, O):
    """c = O / |O|
    sin xi = R / |O|"""
    return O / np.linalg.norm(O), R / np.linalg.norm(O)


@formula("T71")
def on_ellipse(p, g, E):
    """(p - g)^T E (p - g) = 1"""
    return (p - g) @ E @ (p - g), 1


@formula("T71")
def of_moments(n20, n11, n02):
    """E = [n20 n11; n11 n02]^-1 / 4"""
    return np.linalg.inv([[n20, n11], [n11, n02]]) / 4


@formula("T71")
def matrices(E, g, xi, c):
    """[E, -E g; -(E g)^T, g^T E g - 1]
    cos^2 xi 1 - c c^T"""
    return (np.block([[E, -(E @ g)[:, None]], [-(E @ g)[None, :], g @ E @ g - 1]]),
            np.cos(xi) ** 2 * np.diag([1, 1, 1]) - np.outer(c, c))


@formula("T71")
def ratio(xi):
    """-tan^2 xi"""
    return -np.tan(xi) ** 2


@formula("T71")
def o(c, xi, O, R):
    """o = c / sin xi = O / R"""
    return c / np.sin(xi), O / R


@formula("T71")
def L_o(R, o):
    """L_o = [ -1/R 1, [o]x ]"""
    return np.hstack([-1 / R * np.eye(3), skew(o)])


@formula("T71")
def distance(plane, c):
    """|O| = 1 / ((A, B, C) . c)"""
    return 1 / (plane @ c)


def centre(X):
    return np.linalg.inv(X)[:3] @ [*CENTRE, 1.0]


def rim(O):
    """Points of the sphere where the ray from the camera touches it, X . (X - O) = 0."""
    far = np.linalg.norm(O)
    _, _, axes = np.linalg.svd(O[None, :])
    radius = RADIUS * np.sqrt(1.0 - (RADIUS / far) ** 2)
    return [O * (1.0 - (RADIUS / far) ** 2) + radius * (np.cos(t) * axes[1] + np.sin(t) * axes[2]) for t in range(6)]


@functools.lru_cache(maxsize=None)
def sphere_truth(seed):
    """O, a plane through it, (x, y, n20, n11, n02); differences of O / R; the product's o, its sine, and its rows."""
    ellipse, O = rounds.sphere(pose(seed), RADIUS, CENTRE)
    plane = plane_of(pose(seed))
    plane = plane / (plane @ O)
    view = rounds.as_view(ellipse, plane)
    return (O, plane, ellipse, views.differences(lambda X: centre(X) / RADIUS, pose(seed)), *circles.sphere(view),
            FeatureSet(("ox", "oy", "oz")).matrix(view))


@equation("T71")
def test_the_rim_of_a_sphere_is_seen_on_a_cone_and_on_an_ellipse():
    for seed in SEEDS:
        O, _, (x, y, *n), *_ = sphere_truth(seed)
        xi, c, g, E = np.arcsin(RADIUS / np.linalg.norm(O)), O / np.linalg.norm(O), np.array([x, y]), of_moments(*n)
        for s in rim(O):
            for left, right in (on_cone(s, c, xi), on_ellipse(s[:2] / s[2], g, E)):
                same(left, right, 1e-9)


@equation("T71")
def test_the_matrix_of_the_ellipse_is_that_of_the_cone():
    for seed in SEEDS:
        O, _, (x, y, *n), *_ = sphere_truth(seed)
        xi, c, g = np.arcsin(RADIUS / np.linalg.norm(O)), O / np.linalg.norm(O), np.array([x, y])
        of_ellipse, of_cone = matrices(of_moments(*n), g, xi, c)
        same([x, y, 1.0] @ of_ellipse @ [x, y, 1.0], -1.0, 1e-8)
        same(of_ellipse / np.linalg.norm(of_ellipse), of_cone / np.linalg.norm(of_cone), 1e-8)
        same(np.linalg.eigvalsh(of_cone), [-np.sin(xi) ** 2, np.cos(xi) ** 2, np.cos(xi) ** 2])
        values, axes = np.linalg.eigh(of_ellipse)
        same(values[0] / values[1:], [ratio(xi), ratio(xi)], 1e-7)
        same(axes[:, 0] * np.sign(axes[2, 0]), c, 1e-8)


@equation("T71")
def test_features_of_a_sphere_and_their_rows_are_those_of_its_place():
    for seed in SEEDS:
        O, plane, _, slopes, product_o, product_sine, product_L = sphere_truth(seed)
        c = O / np.linalg.norm(O)
        for found, expected in zip(axis_and_sine(RADIUS, O), (product_o * product_sine, product_sine)):
            same(found, expected, 1e-8)
        for one in o(c, np.arcsin(RADIUS / np.linalg.norm(O)), O, RADIUS):
            same(one, product_o, 1e-8)
        same(distance(plane, c), np.linalg.norm(O))
        found = L_o(RADIUS, O / RADIUS)
        rows_same(found, slopes)
        rows_same(found, product_L, 1e-8)


# --- T72: rays on the unit sphere -------------------------------------------------------------------------------------


@formula("T72")
def ray(P, r, plane):
    """s = P / r
    1/r = (A, B, C) . s"""
    s = P / r
    return s, plane @ s


@formula("T72")
def L_s(s, r):
    """L_s = [ -(1 - s s^T) / r, [s]x ]"""
    return np.hstack([-(np.diag([1, 1, 1]) - np.outer(s, s)) / r, skew(s)])


@formula("T72")
def middle(m100, m010, m001, N):
    """(ug, vg, wg) = (m100, m010, m001) / N"""
    return np.array([m100, m010, m001]) / N


@formula("T72")
def invariant(m200, m020, m002, m110, m101, m011):
    """I = m200 m020 + m200 m002 + m020 m002 - m110^2 - m101^2 - m011^2"""
    return m200 * m020 + m200 * m002 + m020 * m002 - m110**2 - m101**2 - m011**2


@formula("T72")
def invariant_of_pairs(s, N):
    """I = (N^2 - sum_ab (s_a . s_b)^2) / 2 = sum_(a < b) |s_a x s_b|^2"""
    return ((N**2 - sum((a @ b) ** 2 for a in s for b in s)) / 2,
            sum(np.linalg.norm(np.cross(s[a], s[b])) ** 2 for b in range(N) for a in range(b)))


@formula("T72")
def cosine(s_a, s_b):
    """c_ab = s_a . s_b"""
    return s_a @ s_b


@formula("T72")
def change(c, s, ds):
    """dI = -2 sum_(a < b) c_ab (s_b . ds_a + s_a . ds_b)"""
    return -2 * sum(c[a][b] * (s[b] @ ds[a] + s[a] @ ds[b]) for b in range(len(s)) for a in range(b))


@formula("T72")
def linear(I):
    """I^(-1/2)"""
    return I ** (-1 / 2)


@formula("T72")
def solid_angle(theta, slope, r, fx, fy):
    """sin(theta) theta'(r) / (r fx fy)"""
    return np.sin(theta) * slope / (r * fx * fy)


def rays_of(X, points=BOARD):
    P = in_camera(points, X)
    return P / np.linalg.norm(P, axis=1)[:, None]


def moment(s, i, j, k):
    return np.sum(s[:, 0] ** i * s[:, 1] ** j * s[:, 2] ** k)


def second_order(s):
    return [moment(s, *ijk) for ijk in ((2, 0, 0), (0, 2, 0), (0, 0, 2), (1, 1, 0), (1, 0, 1), (0, 1, 1))]


def by_tensor(s):
    """The second invariant of sum s s^T, by its eigenvalues."""
    a, b, c = np.linalg.eigvalsh(s.T @ s)
    return a * b + b * c + c * a


@functools.lru_cache(maxsize=None)
def ray_truth(seed):
    """P, differences of the rays, (N, 3, 6), and of I, (6,); the product's rays, middle and `is`, and their rows."""
    X = pose(seed)
    P = in_camera(BOARD, X)
    view = View(Features(point_x=tuple(P[:, 0] / P[:, 2]), point_y=tuple(P[:, 1] / P[:, 2])), plane_of(X))
    one = FeatureSet(("ug", "vg", "wg", "is"))
    rays = FeatureSet([f"{axis}s{k + 1}" for k in range(len(P)) for axis in "uvw"]).values(view)
    return (P, views.differences(lambda X: rays_of(X).ravel(), X).reshape(-1, 3, 6),
            views.differences(lambda X: by_tensor(rays_of(X)), X)[0], np.reshape(rays, (-1, 3)), ray_rows(view),
            np.array(one.values(view)), one.matrix(view))


@equation("T72")
def test_rays_and_their_rows_are_those_of_the_points():
    for seed in SEEDS:
        P, slopes, _, product_s, product_L, *_ = ray_truth(seed)
        for k, point in enumerate(P):
            r = np.linalg.norm(point)
            s, over_r = ray(point, r, plane_of(pose(seed)))
            same(s, product_s[k])
            same(over_r, 1.0 / r)
            rows_same(L_s(point / r, r), slopes[k])
            rows_same(L_s(point / r, r), product_L[k], 1e-12)


@equation("T72")
def test_moments_on_the_sphere_and_their_rows_are_those_of_the_product():
    for seed in SEEDS:
        P, _, slope, s, L, values, rows = ray_truth(seed)
        N = len(s)
        same(middle(*(moment(s, *ijk) for ijk in np.eye(3, dtype=int)), N), values[:3])
        same(np.trace(s.T @ s), N)
        I = invariant(*second_order(s))
        for one in (*invariant_of_pairs(s, N), by_tensor(s)):
            same(one, I, 1e-9)  # 1 - cos^2 of some 0.1 rad
        same(linear(I), values[3], 1e-9)
        cosines = [[cosine(a, b) for b in s] for a in s]
        dI = change(cosines, s, L)
        rows_same(dI, slope, 1e-6)
        rows_same(-0.5 * I**-1.5 * dI, rows[3], 1e-9)
        assert np.abs(dI[3:]).max() < 1e-12 * np.abs(dI).max()


@equation("T72")
def test_the_invariant_does_not_change_in_a_turn_and_its_root_grows_with_the_distance():
    X = pose(1)
    turned = X @ exponential([0, 0, 0, 0.3, -0.2, 1.0], 1.0)
    same(invariant(*second_order(rays_of(turned))), invariant(*second_order(rays_of(X))), 1e-9)
    near, far, farther = (linear(by_tensor(rays_of(X @ exponential([0, 0, -d, 0, 0, 0], 1.0)))) for d in (40, 80, 120))
    same(farther - far, far - near, 1e-4)


FX, FY, K1, SIZE = 130.0, 120.0, -0.02, 480


def through_fisheye(u, v):
    """(s, r, theta, theta'(r)) of places (...) from the principal point [px]; (T53) solved by repetition."""
    x, y = u / FX, v / FY
    r = theta = np.hypot(x, y)
    for _ in range(60):
        theta = r / (1.0 + K1 * theta**2)
    s = np.stack([np.sin(theta) * x / r, np.sin(theta) * y / r, np.cos(theta)], axis=-1)
    return s, r, theta, 1.0 / (1.0 + 3.0 * K1 * theta**2)


@functools.lru_cache(maxsize=None)
def ray_of_blob(u, v):
    """The product's ray of a dark blob of 50 x 30 pixels whose first one is at (u, v) from the principal point."""
    info = {"width": SIZE, "height": SIZE, "K": [FX, 0.0, 239.5, 0.0, FY, 239.5, 0.0, 0.0, 1.0],
            "D": [K1, 0.0, 0.0, 0.0], "distortion_model": "equidistant"}
    vision = {"object": "dark", "segmentation": "coverage", "object_grey": 20, "background_grey": 230, "rays": True,
              "points": "blobs", "point_count": 1}
    image = np.full((SIZE, SIZE), 230, np.uint8)
    image[int(v + 239.5):, int(u + 239.5):][:30, :50] = 20
    seen = MomentExtractor(info, vision).process(image)
    return np.ravel([seen.ray_x, seen.ray_y, seen.ray_z])


@equation("T72")
def test_solid_angle_of_a_pixel_is_that_between_its_rays_and_weighs_them_in_the_product():
    for u0, v0 in ((20.5, -60.5), (60.5, 90.5), (-190.5, 30.5)):  # the last reaches behind the image plane
        u, v = np.meshgrid(u0 + np.arange(50), v0 + np.arange(30))
        s, r, theta, slope = through_fisheye(u, v)
        assert (s[..., 2] < 0.0).any() == (u0 < 0.0)
        found, step = solid_angle(theta, slope, r, FX, FY), 1e-3
        along, across = ((through_fisheye(u + a, v + b)[0] - through_fisheye(u - a, v - b)[0]) / (2 * step)
                         for a, b in ((step, 0), (0, step)))
        same(found, np.linalg.norm(np.cross(along, across), axis=-1), 1e-7)
        mean = np.sum(found[..., None] * s, axis=(0, 1))
        same(mean / np.linalg.norm(mean), ray_of_blob(u0, v0), 1e-9)


# --- T73, T74: points with depths -------------------------------------------------------------------------------------


@formula("T73")
def in_space(Z, x, y):
    """P_i = Z_i (x_i, y_i, 1)"""
    return Z * np.array([x, y, 1])


@formula("T73")
def scatter(P_i, Q_i, P, Q):
    """sum (P_i - P)(Q_i - Q)^T"""
    return sum(np.outer(a - P, b - Q) for a, b in zip(P_i, Q_i))


@formula("T73")
def pose_of(U, Vt, P, Q):
    """D = diag(1, 1, det U det V)
    R = U D V^T
    t = P - R Q"""
    D = np.diag([1, 1, np.linalg.det(U) * np.linalg.det(Vt)])
    R = U @ D @ Vt
    return R, P - R @ Q


def oriented(P_i, Q_i):
    P, Q = P_i.mean(axis=0), Q_i.mean(axis=0)
    U, _, Vt = np.linalg.svd(scatter(P_i, Q_i, P, Q))
    return pose_of(U, Vt, P, Q)


@functools.lru_cache(maxsize=None)
def solid(flat, noise):
    """(points P_i seen, Q_i of the target, the product's X_CT) of points in space or in a plane, seen with errors."""
    Q = SPACE * [1.0, 1.0, 1.0 - flat]
    P = in_camera(Q, pose(2)) + noise * np.random.default_rng(1).normal(size=Q.shape)
    x, y = P[:, 0] / P[:, 2], P[:, 1] / P[:, 2]
    seen = SolidPoints.measured(Features(point_x=tuple(x), point_y=tuple(y), point_z=tuple(P[:, 2])))
    return P, Q, seen, SolidPoints(Q).find(seen)


@equation("T73")
def test_the_points_lie_where_their_depths_say():
    P, _, product, _ = solid(False, 0.0)
    for point, found in zip(P, product):
        same(in_space(point[2], *(point[:2] / point[2])), found)


@equation("T73")
def test_the_scatter_about_the_middles_is_that_of_all_pairs():
    P_i, Q_i, *_ = solid(False, 0.01)
    N, P, Q, p, q = len(P_i), P_i.mean(axis=0), Q_i.mean(axis=0), np.array([0.1, 0.2, 0.3]), np.array([0.3, -0.1, 0.2])
    pairs = sum(np.outer(P_i[a] - P_i[b], Q_i[a] - Q_i[b]) for a in range(N) for b in range(a)) / N
    same(scatter(P_i, Q_i, P, Q), pairs)
    same(scatter(P_i, Q_i, p, q), pairs + N * np.outer(P - p, Q - q))


@equation("T73")
def test_absolute_orientation_is_the_product_s_has_the_least_squares_and_is_no_mirror_image():
    for flat, noise in ((False, 0.0), (True, 0.0), (False, 0.01), (True, 0.05)):
        P, Q, seen, X_CT = solid(flat, noise)
        R, t = oriented(P, Q)
        same(np.c_[R, t], X_CT[:3])
        same(np.linalg.det(R), 1.0)
        if not noise:
            same(np.c_[R, t], np.linalg.inv(pose(2))[:3])

        def cost(X):
            return np.sum((Q @ X[:3, :3].T + X[:3, 3] - P) ** 2)

        for axis in np.eye(6):
            assert cost(X_CT) < min(cost(exponential(axis, d) @ X_CT) for d in (1e-3, -1e-3))


@formula("T74")
def L_lnZ(x, y, Z):
    """L_lnZ = [0, 0, -1/Z, -y, x, 0]"""
    return np.array([0, 0, -1 / Z, -y, x, 0])


@functools.lru_cache(maxsize=None)
def slopes_of_lnZ(seed):
    return views.differences(lambda X: np.log(in_camera(SPACE, X)[:, 2]), pose(seed))


@equation("T74")
def test_row_of_the_logarithm_of_a_depth_is_its_derivative():
    for seed in SEEDS:
        P = in_camera(SPACE, pose(seed))
        rows_same([L_lnZ(*(p[:2] / p[2]), p[2]) for p in P], slopes_of_lnZ(seed))


@equation("T74")
def test_steps_on_image_and_a_tenth_of_the_depths_leave_less_of_wrong_depths():
    truth = np.linalg.inv(pose(3))
    P = in_camera(SPACE, pose(3))
    seen = P * (1.0 + 0.02 * np.random.default_rng(2).normal(size=(len(P), 1)))  # wrong along the rays
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = oriented(seen, SPACE)
    first = np.linalg.norm(X - truth)
    for _ in range(10):
        p = SPACE @ X[:3, :3].T + X[:3, 3]
        L, left = [], []
        for (a, b, Z), (u, v, W) in zip(p, seen):
            x, y = a / Z, b / Z
            L += [[-1 / Z, 0, x / Z, x * y, -(1 + x**2), y], [0, -1 / Z, y / Z, 1 + y**2, -x * y, -x],
                  0.1 * L_lnZ(x, y, Z)]
            left += [u / W - x, v / W - y, 0.1 * np.log(W / Z)]
        X = exponential(-np.linalg.lstsq(np.array(L), np.array(left), rcond=None)[0], 1.0) @ X
    assert np.linalg.norm(X - truth) < 0.2 * first
