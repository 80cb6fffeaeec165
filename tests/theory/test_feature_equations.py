"""T26, T27, T28, T47: points, segments, ellipses and kernels, against differences of exact pictures and the product."""
import functools

import numpy as np
import views
from equations import equation, formula, same
from scenes import SEEDS, derivative, in_product, moments_of, pose, rows_same, seen
from test_interaction_equations import product_centred, product_of
from toy_plant import OUTLINE, Camera, picture
from views import plane_of

from aras_visual_servo.features import interaction
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.features.kinds.kernel import kernel_row
from aras_visual_servo.features.target.target_pose import PlanarTarget

ENDS = ((0, 1), (2, 3), (4, 0))  # of segments of the outline


@formula("T26")
def L_point(x, y, Z):
    """L_x = [ -1/Z, 0, x/Z, x y, -(1 + x^2), y ]          L_y = [ 0, -1/Z, y/Z, 1 + y^2, -x y, -x ]"""
    return np.array([[-1 / Z, 0, x / Z, x * y, -(1 + x**2), y],
                     [0, -1 / Z, y / Z, 1 + y**2, -x * y, -x]])


@functools.lru_cache(maxsize=None)
def points(seed):
    """(x, y, Z) of the corners, their differences (5, 2, 6), and the product's rows."""
    X_CW = np.linalg.inv(pose(seed))
    Z = [float((X_CW @ [*corner, 0.0, 1.0])[2]) for corner in OUTLINE]
    xy = picture(pose(seed))
    slopes = views.differences(lambda X: picture(X).ravel(), pose(seed)).reshape(-1, 2, 6)
    view = View(Camera(None).features(pose(seed)), plane_of(pose(seed)))
    names = [f"{axis}{k + 1}" for k in range(len(xy)) for axis in "xy"]
    return np.column_stack([xy, Z]), slopes, FeatureSet(names).matrix(view).reshape(-1, 2, 6)


@equation("T26")
def test_rows_of_a_point_are_its_derivatives():
    for seed in SEEDS:
        corners, slopes, product = points(seed)
        for corner, slope, wanted in zip(corners, slopes, product):
            rows_same(L_point(*corner), slope)
            rows_same(L_point(*corner), wanted, 1e-12)


@formula("T27")
def L_middle(L_x1, L_x2, L_y1, L_y2):
    """L_xm = (L_x1 + L_x2)/2
    L_ym = (L_y1 + L_y2)/2"""
    return (L_x1 + L_x2) / 2, (L_y1 + L_y2) / 2


@formula("T27")
def L_length_direction(L_p1, L_p2, alpha, l):
    """d = L_p2 - L_p1
    L_l = cos(alpha) d_x + sin(alpha) d_y
    L_alpha = (cos(alpha) d_y - sin(alpha) d_x)/l"""
    d_x, d_y = L_p2 - L_p1
    return np.array([np.cos(alpha) * d_x + np.sin(alpha) * d_y, (np.cos(alpha) * d_y - np.sin(alpha) * d_x) / l])


@functools.lru_cache(maxsize=None)
def segments(seed):
    """For each of ENDS: alpha, l, differences of (xm, ym, l, alpha), and the product's rows of them."""
    xy, made = picture(pose(seed)), []
    view = View(Camera(None).features(pose(seed)), plane_of(pose(seed)))
    for first, last in ENDS:
        def values(X):
            (x1, y1), (x2, y2) = picture(X)[[first, last]]
            return np.array([(x1 + x2) / 2, (y1 + y2) / 2, np.hypot(x2 - x1, y2 - y1), np.arctan2(y2 - y1, x2 - x1)])

        (x1, y1), (x2, y2) = xy[[first, last]]
        number = first + 1
        product = FeatureSet([f"{name}{number}" for name in ("xm", "ym", "l", "alpha")]).matrix(view)
        made.append((np.arctan2(y2 - y1, x2 - x1), np.hypot(x2 - x1, y2 - y1), views.differences(values, pose(seed)),
                     product))
    return made


@equation("T27")
def test_rows_of_a_segment_are_its_derivatives():
    for seed in SEEDS:
        _, slopes, rows = points(seed)
        for (first, last), (alpha, length, expected, product) in zip(ENDS, segments(seed)):
            L = rows[[first, last]]
            found = np.vstack([L_middle(L[0, 0], L[1, 0], L[0, 1], L[1, 1]), L_length_direction(*L, alpha, length)])
            rows_same(found, expected)
            rows_same(found, product, 1e-10)


@formula("T28")
def n(mu_ij, a):
    """n_ij = mu_ij / a"""
    return mu_ij / a


@formula("T28")
def L_n(n_ij, a, L_mu, L_a):
    """L_nij = (L_mu_ij - n_ij L_a) / a"""
    return (L_mu - n_ij * L_a) / a


def second_order(m, mu):
    return np.array([mu[i, j] / m[0, 0] for i, j in ((2, 0), (1, 1), (0, 2))])


@functools.lru_cache(maxsize=None)
def product_ellipse(seed):
    view, features = in_product(*seen(seed)), FeatureSet(("n20", "n11", "n02"))
    return features.values(view), features.matrix(view)


@equation("T28")
def test_rows_of_normalised_second_moments_are_their_derivatives():
    for seed in SEEDS:
        m, mu, _ = seen(seed)
        L_a, a = product_of(interaction.area, seed), m[0, 0]
        values = [n(mu[ij], a) for ij in ((2, 0), (1, 1), (0, 2))]
        same(values, second_order(m, mu))
        same(values, product_ellipse(seed)[0])
        rows = [L_n(value, a, product_centred(seed, *ij), L_a) for value, ij in zip(values, ((2, 0), (1, 1), (0, 2)))]
        rows_same(rows, derivative(second_order, seed))
        rows_same(rows, product_ellipse(seed)[1], 1e-10)


@equation("T28")
def test_an_object_of_central_symmetry_on_the_axis_tells_four_motions_and_a_disc_three():
    angle = np.linspace(0.0, 2.0 * np.pi, 360, endpoint=False)
    disc = 0.06 * np.column_stack([np.cos(angle), np.sin(angle)])
    slab = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])
    for outline, on_axis in ((slab, 4), (disc, 3)):
        for away_m, told in ((0.0, on_axis), (0.1, 5)):
            X = np.diag([1.0, -1.0, -1.0, 1.0])
            X[:3, 3] = away_m, 0.0 if outline is disc else 0.5 * away_m, 0.6
            view = in_product(*moments_of(picture(X, None, outline)), tuple(plane_of(X)))
            L = FeatureSet(("xg", "yg", "n20", "n11", "n02")).matrix(view)
            assert np.linalg.matrix_rank(L, 1e-8) == told, (len(outline), away_m)


# --- T47: kernels -----------------------------------------------------------------------------------------------------

P, X0 = 1.5, -0.9
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)
NODES, WEIGHTS = 0.5 * (NODES + 1.0), 0.5 * WEIGHTS


@formula("T47")
def kernel(x, x0, p):
    """kx = integral over the object of X^-p dA
    X = x - x0"""
    X = x - x0
    return X**-p


@formula("T47")
def slope_of_kernel(X, p):
    """f_x = -p X^-(p+1)"""
    return -p * X ** -(p + 1)


@formula("T47")
def change(grad_f, x_dot, f, div_x_dot):
    """d/dt integral f dA = integral (grad f . x_dot + f div x_dot) dA"""
    return grad_f @ x_dot + f * div_x_dot


@formula("T47")
def L_kx(mean, f, f_x, x, y, over_Z, plane):
    """L = [ -<f_x / Z> - A <f>, -B <f>, <f_x x / Z> + 3 <f / Z> - C <f>, <f_x x y> + 3 <f y>,
    -<f_x (1 + x^2)> - 3 <f x>, <f_x y> ]"""
    A, B, C = plane
    return np.array([-mean(f_x * over_Z) - A * mean(f), -B * mean(f),
                     mean(f_x * x * over_Z) + 3 * mean(f * over_Z) - C * mean(f), mean(f_x * x * y) + 3 * mean(f * y),
                     -mean(f_x * (1 + x**2)) - 3 * mean(f * x), mean(f_x * y)])


def rule(xy):
    """(x, y, weight) that integrates smooth functions over a convex polygon to rounding: a fan of triangles."""
    u, v = np.meshgrid(NODES, NODES)
    parts = []
    for b, c in zip(xy[1:-1], xy[2:]):
        p = xy[0] + u[..., None] * (b - xy[0]) + (u * v)[..., None] * (c - b)
        parts.append(np.dstack([p, np.outer(WEIGHTS, WEIGHTS) * u * np.cross(b - xy[0], c - xy[0])]).reshape(-1, 3))
    x, y, weight = np.concatenate(parts).T
    return x, y, weight * np.sign(weight.sum())


def by_contour(xy, exponent, powers_of_y=0):
    """Integral of X^-exponent y^j over a polygon by Green's theorem, along its outline."""
    way = np.roll(xy, -1, axis=0) - xy
    on = xy[:, None, :] + NODES[:, None] * way[:, None, :]
    X, y, dx = on[..., 0] - X0, on[..., 1], way[:, :1] * WEIGHTS
    area = np.sum(y * dx)
    return np.sign(area) * np.sum(X**-exponent * y ** (powers_of_y + 1) * dx) / (powers_of_y + 1)


@functools.lru_cache(maxsize=None)
def kernel_truth(seed):
    """Rule over the view, plane, 1/Z at its nodes, kx by contour, its differences, the product's row."""
    xy, plane = picture(pose(seed)), tuple(plane_of(pose(seed)))
    x, y, weight = rule(xy)
    slopes = views.differences(lambda X: by_contour(picture(X), P), pose(seed))
    sums = [by_contour(xy, P - 1 + k, j) for k in range(3) for j in range(2)]
    return (x, y, weight, plane, plane[0] * x + plane[1] * y + plane[2], by_contour(xy, P), slopes,
            kernel_row(sums, P, X0, plane))


@equation("T47")
def test_kernel_projection_and_its_row_are_integrals_and_derivatives():
    for seed in SEEDS[:2]:
        x, y, weight, plane, over_Z, expected, slopes, product = kernel_truth(seed)
        f, f_x = kernel(x, X0, P), slope_of_kernel(x - X0, P)
        same(np.sum(weight * f), expected)
        row = L_kx(lambda values: np.sum(weight * values), f, f_x, x, y, over_Z, plane)
        rows_same(row, slopes)
        rows_same(row, product, 1e-10)


@equation("T47")
def test_slope_of_the_kernel_is_its_derivative():
    X, step = np.array([0.5, 0.9, 1.4]), 1e-5
    expected = ((X + step) ** -P - (X - step) ** -P) / (2 * step)
    same(slope_of_kernel(X, P), expected, 1e-8)  # step^2 f''' / 6


@equation("T47")
def test_change_of_an_integral_over_a_moving_plane():
    # Any smooth f, and the motion of the points of the plane by (T26): its divergence by differences.
    seed, twist, step = 1, np.array([0.3, -0.2, 0.4, 0.5, -0.6, 0.7]), 1e-5
    x, y, weight, plane, *_ = kernel_truth(seed)

    def f(x, y):
        return np.sin(3.0 * x) * np.cos(2.0 * y) + x * y

    def flow(x, y):
        over_Z = plane[0] * x + plane[1] * y + plane[2]
        zero = np.zeros_like(x)
        L_x = np.array([-over_Z, zero, x * over_Z, x * y, -(1 + x**2), y])
        L_y = np.array([zero, -over_Z, y * over_Z, 1 + y**2, -x * y, -x])
        return np.array([twist @ L_x, twist @ L_y])

    div = ((flow(x + step, y) - flow(x - step, y))[0] + (flow(x, y + step) - flow(x, y - step))[1]) / (2 * step)
    grad = np.array([3 * np.cos(3 * x) * np.cos(2 * y) + y, -2 * np.sin(3 * x) * np.sin(2 * y) + x])
    found = sum(w * change(grad[:, k], flow(x[k], y[k]), f(x[k], y[k]), div[k]) for k, w in enumerate(weight))
    same(found, change_by_differences(seed, tuple(twist), f), 1e-7)


_CHANGES = {}


def change_by_differences(seed, twist, f):
    if (seed, twist) not in _CHANGES:
        ends = []
        for t in (views.STEP, -views.STEP):
            x, y, weight = rule(picture(pose(seed) @ views.exponential(twist, t)))
            ends.append(np.sum(weight * f(x, y)))
        _CHANGES[seed, twist] = (ends[0] - ends[1]) / (2 * views.STEP)
    return _CHANGES[seed, twist]


def test_the_rules_agree_on_what_is_known():
    xy = picture(pose(1))
    x, y, weight = rule(xy)
    same(np.sum(weight), moments_of(xy)[0][0, 0])
    same(np.sum(weight * x * y), PlanarTarget([OUTLINE]).moments(np.linalg.inv(pose(1)))[1, 1])
