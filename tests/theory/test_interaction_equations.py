"""T6 to T11: interaction matrices of moments, against central differences of exact pictures and against the product."""
import functools

import numpy as np
import views
from equations import equation, formula, same
from scenes import AREA_STAR, SEEDS, Z_STAR, derivative, in_product, moments_of, pose, rows_same, seen
from toy_plant import OUTLINE, angle_between, picture

from aras_visual_servo.features import interaction

CENTRED = [(i, k - i) for k in (2, 3, 4) for i in range(k + 1)]


@formula("T6")
def L_m(m, i, j, plane):
    """k = i + j + 3
    L_mij = [ -(i+1) A m_ij - i B m_{i-1,j+1} - i C m_{i-1,j},
              -j A m_{i+1,j-1} - (j+1) B m_ij - j C m_{i,j-1},
              k (A m_{i+1,j} + B m_{i,j+1}) + (k-1) C m_ij,
              k m_{i,j+1} + j m_{i,j-1},  -k m_{i+1,j} - i m_{i-1,j},  i m_{i-1,j+1} - j m_{i+1,j-1} ]"""
    A, B, C = plane
    k = i + j + 3
    return np.array([-(i + 1) * A * m[i, j] - i * B * m[i - 1, j + 1] - i * C * m[i - 1, j],
                     -j * A * m[i + 1, j - 1] - (j + 1) * B * m[i, j] - j * C * m[i, j - 1],
                     k * (A * m[i + 1, j] + B * m[i, j + 1]) + (k - 1) * C * m[i, j],
                     k * m[i, j + 1] + j * m[i, j - 1],
                     -k * m[i + 1, j] - i * m[i - 1, j],
                     i * m[i - 1, j + 1] - j * m[i + 1, j - 1]])


@functools.lru_cache(maxsize=None)
def slope_of_raw(seed, i, j):
    return derivative(lambda m, mu: m[i, j], seed)[0]


@functools.lru_cache(maxsize=None)
def slope_of_centred(seed, i, j):
    return derivative(lambda m, mu: mu[i, j], seed)[0]


def by_name(moments):
    return {f"{i}{j}": value for (i, j), value in moments.items()}


@functools.lru_cache(maxsize=None)
def product_raw(seed, i, j):
    return interaction.raw_moment(by_name(seen(seed)[0]), i, j, seen(seed)[2])


@functools.lru_cache(maxsize=None)
def product_centred(seed, i, j):
    m, mu, plane = seen(seed)
    return interaction.centred_moment(by_name(m), by_name(mu), i, j, plane)


@equation("T6")
def test_rows_of_raw_moments_are_their_derivatives():
    for seed in SEEDS:
        m, _, plane = seen(seed)
        for i, j in [(i, j) for i in range(4) for j in range(4 - i)]:
            found = L_m(m, i, j, plane)
            rows_same(found, slope_of_raw(seed, i, j), what=f"m_{i}{j}")
            same(found, product_raw(seed, i, j), what=f"m_{i}{j} of the product")


@formula("T7")
def L_mu(mu, i, j, xg, yg, n20, n11, n02, plane):
    """vx = -(i+1) A mu_ij - i B mu_{i-1,j+1}          vy = -j A mu_{i+1,j-1} - (j+1) B mu_ij
    wx = (i+j+3) mu_{i,j+1} + i xg mu_{i-1,j+1} + (i+2j+3) yg mu_ij - 4 i n11 mu_{i-1,j} - 4 j n02 mu_{i,j-1}
    wy = -(i+j+3) mu_{i+1,j} - (2i+j+3) xg mu_ij - j yg mu_{i+1,j-1} + 4 i n20 mu_{i-1,j} + 4 j n11 mu_{i,j-1}
    vz = -A wy + B wx + (i+j+2) C mu_ij             wz = i mu_{i-1,j+1} - j mu_{i+1,j-1}"""
    A, B, C = plane
    vx = -(i + 1) * A * mu[i, j] - i * B * mu[i - 1, j + 1]
    vy = -j * A * mu[i + 1, j - 1] - (j + 1) * B * mu[i, j]
    wx = ((i + j + 3) * mu[i, j + 1] + i * xg * mu[i - 1, j + 1] + (i + 2 * j + 3) * yg * mu[i, j]
          - 4 * i * n11 * mu[i - 1, j] - 4 * j * n02 * mu[i, j - 1])
    wy = (-(i + j + 3) * mu[i + 1, j] - (2 * i + j + 3) * xg * mu[i, j] - j * yg * mu[i + 1, j - 1]
          + 4 * i * n20 * mu[i - 1, j] + 4 * j * n11 * mu[i, j - 1])
    vz = -A * wy + B * wx + (i + j + 2) * C * mu[i, j]
    wz = i * mu[i - 1, j + 1] - j * mu[i + 1, j - 1]
    return np.array([vx, vy, vz, wx, wy, wz])


def shape_of(m, mu):
    """xg, yg, n20, n11, n02 (T2)."""
    return (m[1, 0] / m[0, 0], m[0, 1] / m[0, 0], *(mu[i, 2 - i] / m[0, 0] for i in (2, 1, 0)))


@equation("T7")
def test_rows_of_centred_moments_are_their_derivatives():
    for seed in SEEDS:
        m, mu, plane = seen(seed)
        for i, j in CENTRED:
            found = L_mu(mu, i, j, *shape_of(m, mu), plane)
            rows_same(found, slope_of_centred(seed, i, j), what=f"mu_{i}{j}")
            same(found, product_centred(seed, i, j), what=f"mu_{i}{j} of the product")


@formula("T8")
def L_a(a, xg, yg, Zg, plane):
    """L_a  = a [ -A, -B, 3/Zg - C, 3 yg, -3 xg, 0 ]"""
    A, B, C = plane
    return a * np.array([-A, -B, 3 / Zg - C, 3 * yg, -3 * xg, 0])


@formula("T8")
def L_xg(xg, yg, n20, n11, n02, Zg, plane):
    """L_xg = [ -1/Zg, 0, xg/Zg + 4(A n20 + B n11), xg yg + 4 n11, -(1 + xg^2 + 4 n20), yg ]"""
    A, B, C = plane
    return np.array([-1 / Zg, 0, xg / Zg + 4 * (A * n20 + B * n11), xg * yg + 4 * n11,
                     -(1 + xg**2 + 4 * n20), yg])


@formula("T8")
def L_yg(xg, yg, n20, n11, n02, Zg, plane):
    """L_yg = [ 0, -1/Zg, yg/Zg + 4(A n11 + B n02), 1 + yg^2 + 4 n02, -xg yg - 4 n11, -xg ]"""
    A, B, C = plane
    return np.array([0, -1 / Zg, yg / Zg + 4 * (A * n11 + B * n02), 1 + yg**2 + 4 * n02,
                     -xg * yg - 4 * n11, -xg])


def area_and_centroid(m, mu):
    return np.array([m[0, 0], m[1, 0] / m[0, 0], m[0, 1] / m[0, 0]])


@functools.lru_cache(maxsize=None)
def product_of(function, seed, *more):
    """Rows of the product's function of raw moments and plane."""
    m, _, plane = seen(seed)
    return function(by_name(m), plane, *more)


def parts(seed):
    """a, (xg, yg, n20, n11, n02), Zg, plane of a view."""
    m, mu, plane = seen(seed)
    xg, yg, *n = shape_of(m, mu)
    return m[0, 0], (xg, yg, *n), 1.0 / (plane[0] * xg + plane[1] * yg + plane[2]), plane


@equation("T8")
def test_rows_of_area_and_centroid_are_their_derivatives():
    for seed in SEEDS:
        a, shape, Zg, plane = parts(seed)
        found = np.array([L_a(a, *shape[:2], Zg, plane), L_xg(*shape, Zg, plane), L_yg(*shape, Zg, plane)])
        rows_same(found, derivative(area_and_centroid, seed))
        same(found[0], product_of(interaction.area, seed))
        same(found[1:], product_of(interaction.centroid, seed))


@formula("T9")
def L_an(an, a, L_a):
    """L_an = -(an / 2a) L_a"""
    return -(an / (2 * a)) * L_a


@formula("T9")
def L_xn(an, xg, L_xg, L_an):
    """L_xn = an L_xg + xg L_an"""
    return an * L_xg + xg * L_an


@formula("T9")
def L_yn(an, yg, L_yg, L_an):
    """L_yn = an L_yg + yg L_an"""
    return an * L_yg + yg * L_an


def normalised(m, mu):
    """(xn, yn, an) (T4)."""
    return Z_STAR * np.sqrt(AREA_STAR / m[0, 0]) * np.array([m[1, 0] / m[0, 0], m[0, 1] / m[0, 0], 1.0])


@equation("T9")
def test_rows_of_the_normalised_features_are_their_derivatives():
    for seed in SEEDS:
        a, (xg, yg, *_), _, _ = parts(seed)
        of_a, (of_xg, of_yg) = product_of(interaction.area, seed), product_of(interaction.centroid, seed)
        an = Z_STAR * np.sqrt(AREA_STAR / a)
        of_an = L_an(an, a, of_a)
        found = np.array([L_xn(an, xg, of_xg, of_an), L_yn(an, yg, of_yg, of_an), of_an])
        rows_same(found, derivative(normalised, seed))
        same(found, product_of(interaction.normalised, seed, Z_STAR, AREA_STAR))


@formula("T10")
def L_alpha(mu20, mu11, mu02, mu30, mu21, mu12, mu03, xg, yg, D, plane):
    """p = mu11 (mu20+mu02)/D     q = (2 mu11^2 + mu02 (mu02-mu20))/D     r = (2 mu11^2 + mu20 (mu20-mu02))/D
    d = 5 (mu12 (mu20-mu02) + mu11 (mu03-mu21))/D
    e = 5 (mu21 (mu02-mu20) + mu11 (mu30-mu12))/D
    wx = -q xg + p yg + d      wy = p xg - r yg + e      L_alpha = [ pA+qB, -rA-pB, -A wy + B wx, wx, wy, -1 ]"""
    A, B, C = plane
    p = mu11 * (mu20 + mu02) / D
    q = (2 * mu11**2 + mu02 * (mu02 - mu20)) / D
    r = (2 * mu11**2 + mu20 * (mu20 - mu02)) / D
    d = 5 * (mu12 * (mu20 - mu02) + mu11 * (mu03 - mu21)) / D
    e = 5 * (mu21 * (mu02 - mu20) + mu11 * (mu30 - mu12)) / D
    wx = -q * xg + p * yg + d
    wy = p * xg - r * yg + e
    return np.array([p * A + q * B, -r * A - p * B, -A * wy + B * wx, wx, wy, -1])


def orientation(m, mu):
    return np.array([0.5 * np.arctan2(2.0 * mu[1, 1], mu[2, 0] - mu[0, 2])])


@functools.lru_cache(maxsize=None)
def slope_of_orientation(seed):
    """Twice the angle is continuous where the angle itself jumps by half a turn: its sine and cosine."""
    _, mu, _ = seen(seed)
    here = orientation(None, mu)[0]
    return derivative(lambda m, mu: 0.5 * np.sin(2.0 * (orientation(m, mu) - here)), seed)[0]


@functools.lru_cache(maxsize=None)
def product_orientation(seed):
    m, mu, plane = seen(seed)
    return interaction.orientation(by_name(m), by_name(mu), plane)


@equation("T10")
def test_row_of_the_orientation_is_its_derivative():
    for seed in SEEDS:
        m, mu, plane = seen(seed)
        xg, yg, *_ = shape_of(m, mu)
        third = (mu[3, 0], mu[2, 1], mu[1, 2], mu[0, 3])
        D = (mu[2, 0] - mu[0, 2]) ** 2 + 4.0 * mu[1, 1] ** 2
        found = L_alpha(mu[2, 0], mu[1, 1], mu[0, 2], *third, xg, yg, D, plane)
        rows_same(found, slope_of_orientation(seed))
        same(found, product_orientation(seed))


@formula("T11")
def L_parallel(xn, yn):
    """[ -1  0  0  yn ]
    [  0 -1  0 -xn ]
    [  0  0 -1   0 ]
    [  0  0  0  -1 ]"""
    return np.array([[-1, 0, 0, yn],
                     [0, -1, 0, -xn],
                     [0, 0, -1, 0],
                     [0, 0, 0, -1]])


@functools.lru_cache(maxsize=None)
def at_depth(depth_m):
    """Features (xn, yn, an) and their derivatives by vx, vy, vz, wz, alpha's too, of a parallel view."""
    X = views.parallel_pose()
    X[2, 3] = depth_m
    area_m2 = moments_of(OUTLINE, 1)[0][0, 0]

    def features(X):
        m, mu = moments_of(picture(X), 2)
        an = np.sqrt(area_m2 / m[0, 0])  # Z* = 1 m: there the image is the outline
        return np.array([an * m[1, 0] / m[0, 0], an * m[0, 1] / m[0, 0], an, orientation(m, mu)[0]])

    L = views.differences(features, X, lambda a, b: np.r_[a[:3] - b[:3], 0.5 * angle_between(2 * a[3], 2 * b[3])])
    return features(X), L[:, [0, 1, 2, 5]]


@equation("T11")
def test_the_parallel_matrix_is_exact_at_any_depth():
    for depth_m in (0.3, 0.59, 2.0):
        (xn, yn, an, _), expected = at_depth(depth_m)
        same(an, depth_m)
        rows_same(L_parallel(xn, yn), expected)
        same(L_parallel(xn, yn), interaction.parallel(xn, yn))


@equation("T11")
def test_it_is_what_the_general_rows_become():
    X = views.parallel_pose()
    m, mu = moments_of(picture(X))
    view = in_product(m, mu, tuple(views.plane_of(X)))
    view.features.area_star = moments_of(OUTLINE, 1)[0][0, 0] / Z_STAR**2
    rows = np.vstack([view.L_normalised(), interaction.orientation(view.m, view.mu, view.plane)])[:, [0, 1, 2, 5]]
    an = Z_STAR * np.sqrt(view.features.area_star / m[0, 0])
    same(L_parallel(an * m[1, 0] / m[0, 0], an * m[0, 1] / m[0, 0]), rows)


def test_poses_are_tilted_and_the_outline_is_lopsided():
    for seed in SEEDS:
        m, mu, plane = seen(seed)
        assert np.hypot(*plane[:2]) > 0.05 * plane[2] and abs(mu[3, 0]) > 0.0 and abs(pose(seed)[0, 3]) > 0.0
