"""T18, T19, T48: features that tell tilt, against published real forms, ViSP's numbers, differences, the product."""
import functools
import re

import numpy as np
from equations import THEORY, equation, formula, paragraphs, same
from scenes import Moments, SEEDS, derivative, in_product, moments_of, rows_same, seen
from test_interaction_equations import product_centred, product_of
from test_moment_equations import points_inside
from toy_plant import Camera, picture
from views import exponential, parallel_pose, plane_of
from visp_values import POLYGON, VISP

from aras_visual_servo.config.files import load_yaml
from aras_visual_servo.features import interaction
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.ground.errors import DegenerateFeature

VISP_DIGITS = 1e-9  # of its numbers, printed with thirteen
#: In which no invariant nearly vanishes.
VIEWS = {seed: parallel_pose(0.3 * seed) @ exponential([0, 0, 0, 0.1 * seed, -0.2, 0.0], 1.0) for seed in SEEDS}
TARGETS = THEORY.parents[1] / "src" / "aras_description" / "targets"


@formula("T18")
def z1_z2_T(mu20, mu11, mu02, mu30, mu21, mu12, mu03):
    """z1 = (mu20 - mu02) + 2i mu11
    z2 = (mu03 - 3 mu21) + i (mu30 - 3 mu12)
    T = mu20 + mu02"""
    return (mu20 - mu02) + 2 * 1j * mu11, (mu03 - 3 * mu21) + 1j * (mu30 - 3 * mu12), mu20 + mu02


@formula("T18")
def S(z1, z2, T, a):
    """S = sx + i sy = z2 conj(z1)/z1 sqrt(a) / T^(3/2)"""
    return z2 * np.conj(z1) / z1 * np.sqrt(a) / T ** (3 / 2)


@formula("T18")
def L_S(z1, z2, T, a, L_z1, L_z2, L_T, L_a):
    """L_S = conj(z1)/z1 sqrt(a) / T^(3/2) [ L_z2 + z2 ( conj(L_z1)/conj(z1) - L_z1/z1 + L_a/(2a) - 3/2 L_T/T ) ]"""
    return np.conj(z1) / z1 * np.sqrt(a) / T ** (3 / 2) * (
        L_z2 + z2 * (np.conj(L_z1) / np.conj(z1) - L_z1 / z1 + L_a / (2 * a) - 3 / 2 * L_T / T))


def published(m, mu):
    """(sx, sy, px, py) in sines and cosines, as they were published."""
    c1, s1 = mu[2, 0] - mu[0, 2], 2.0 * mu[1, 1]
    c2, s2 = mu[0, 3] - 3.0 * mu[2, 1], mu[3, 0] - 3.0 * mu[1, 2]
    c3, s3 = c1**2 - s1**2, 2.0 * s1 * c1
    T, a = mu[2, 0] + mu[0, 2], m[0, 0]
    K = (c1**2 + s1**2) * T * np.sqrt(T) / np.sqrt(a)
    return np.array([(c2 * c3 + s2 * s3) / K, (s2 * c3 - c2 * s3) / K, (c1**2 + s1**2) / T**2,
                     a * (c2**2 + s2**2) / T**3])


def third_order(mu):
    return tuple(mu[ij] for ij in ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)))


@functools.lru_cache(maxsize=None)
def of_complex(seed):
    """z1, z2, T, a of a view and their rows, all of the product's rows (T7)."""
    m, mu, _ = seen(seed)
    rows = {ij: product_centred(seed, *ij) for ij in ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))}
    z1, z2 = mu[2, 0] - mu[0, 2] + 2j * mu[1, 1], mu[0, 3] - 3 * mu[2, 1] + 1j * (mu[3, 0] - 3 * mu[1, 2])
    L_z1 = rows[2, 0] - rows[0, 2] + 2j * rows[1, 1]
    L_z2 = rows[0, 3] - 3 * rows[2, 1] + 1j * (rows[3, 0] - 3 * rows[1, 2])
    return (z1, z2, mu[2, 0] + mu[0, 2], m[0, 0], L_z1, L_z2, rows[2, 0] + rows[0, 2],
            product_of(interaction.area, seed))


@functools.lru_cache(maxsize=None)
def product(names, seed):
    """(values, rows) of the product's features."""
    view, features = in_product(*seen(seed)), FeatureSet(names)
    return np.array(features.values(view)), features.matrix(view)


@equation("T18")
def test_its_parts_are_complex_moments():
    xy = picture(VIEWS[1])
    (m, mu), (x, y, weight) = moments_of(xy), points_inside(xy.tobytes())
    z = x - m[1, 0] / m[0, 0] + 1j * (y - m[0, 1] / m[0, 0])
    expected = [np.sum(weight * power) for power in (z**2, 1j * z**3, np.abs(z) ** 2)]
    for found, value in zip(z1_z2_T(*third_order(mu)), expected):
        same(found, value)


@equation("T18")
def test_S_is_the_published_pair_and_that_of_visp():
    for seed in SEEDS:
        m, mu, _ = seen(seed)
        found = S(*z1_z2_T(*third_order(mu)), m[0, 0])
        same([found.real, found.imag], published(m, mu)[:2])
        same([found.real, found.imag], product(("sx", "sy"), seed)[0])
    m, mu = moments_of(POLYGON)
    found = S(*z1_z2_T(*third_order(mu)), m[0, 0])
    same([found.real, found.imag], [VISP["sx"][0], VISP["sy"][0]], VISP_DIGITS)


@equation("T18")
def test_row_of_S_is_its_derivative():
    for seed in SEEDS:
        L = L_S(*of_complex(seed))
        rows_same([L.real, L.imag], derivative(published, seed)[:2])
        same([L.real, L.imag], product(("sx", "sy"), seed)[1])


@equation("T18", "T19")
def test_neither_changes_with_translation_of_a_parallel_camera_and_a_turn_turns_S_only():
    X = parallel_pose()
    S_there, p = (published(*moments_of(picture(X)))[part] for part in (slice(0, 2), slice(2, 4)))
    for twist in ([0.05, 0, 0, 0, 0, 0], [0, 0.04, 0, 0, 0, 0], [0, 0, 0.1, 0, 0, 0]):
        same(published(*moments_of(picture(X @ exponential(twist, 1.0)))), [*S_there, *p], 1e-8)
    turned = published(*moments_of(picture(X @ exponential([0, 0, 0, 0, 0, 0.7], 1.0))))
    same(turned[2:], p, 1e-8)
    same(np.hypot(*turned[:2]), np.hypot(*S_there), 1e-8)
    same(turned[0] + 1j * turned[1], (S_there[0] + 1j * S_there[1]) * np.exp(0.7j), 1e-8)


RECTANGLE = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])


def of_rectangle(away_m):
    """Values and rows of sx, sy, px, py for a rectangle seen parallel, that far from the optical axis."""
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[:3, 3] = away_m, 0.5 * away_m, 0.6
    view, features = in_product(*moments_of(picture(X, None, RECTANGLE)), tuple(plane_of(X))), FeatureSet(
        ("sx", "sy", "px", "py"))
    return np.array(features.values(view)), features.matrix(view)


@equation("T18", "T19")
def test_central_symmetry_seen_parallel_leaves_a_row_of_S_and_none_of_p_on_the_axis():
    values, rows = of_rectangle(0.0)
    assert np.abs(values[:2]).max() < 1e-12 and np.abs(rows[:2]).max() > 0.1 and np.abs(rows[2:]).max() < 1e-12
    _, rows = of_rectangle(0.1)
    assert np.abs(rows[2]).max() > 0.01 and np.abs(rows[3]).max() < 1e-12


@formula("T19")
def px(z1, T):
    """px = |z1|^2 / T^2"""
    return np.abs(z1) ** 2 / T**2


@formula("T19")
def py(z2, T, a):
    """py = a |z2|^2 / T^3"""
    return a * np.abs(z2) ** 2 / T**3


@formula("T19")
def L_px(px, z1, T, L_z1, L_T):
    """L_px = 2 Re(conj(z1) L_z1) / T^2 - 2 px L_T / T"""
    return 2 * np.real(np.conj(z1) * L_z1) / T**2 - 2 * px * L_T / T


@formula("T19")
def L_py(py, z2, T, a, L_z2, L_T, L_a):
    """L_py = 2 a Re(conj(z2) L_z2) / T^3 + py (L_a / a - 3 L_T / T)"""
    return 2 * a * np.real(np.conj(z2) * L_z2) / T**3 + py * (L_a / a - 3 * L_T / T)


@equation("T19")
def test_px_and_py_are_the_published_ones_and_their_rows_the_derivatives():
    for seed in SEEDS:
        m, mu, _ = seen(seed)
        z1, z2, T, a, L_z1, L_z2, L_T, L_a = of_complex(seed)
        values = np.array([px(z1, T), py(z2, T, a)])
        same(values[0], published(m, mu)[2])
        same(values[1], published(m, mu)[3])
        same(values, product(("px", "py"), seed)[0])
        rows = np.array([L_px(values[0], z1, T, L_z1, L_T), L_py(values[1], z2, T, a, L_z2, L_T, L_a)])
        rows_same(rows, derivative(published, seed)[2:])
        rows_same(rows, product(("px", "py"), seed)[1], 1e-10)


def condition(target, pair, tilt_rad):
    """Of the matrix of (xn, yn, an, pair, alpha) 0.6 m from the target's centroid."""
    outline = np.array(load_yaml(TARGETS / f"{target}.yaml")["outlines_m"][0])
    m, _ = moments_of(outline, 1)
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0, 0, 0, tilt_rad, 0, 0], 1.0)
    X[:3, 3] = -0.6 * X[:3, 2]
    camera = Camera(None, outline - np.array([m[1, 0], m[0, 1]]) / m[0, 0])
    camera.star = (0.6, camera.features(X).area)
    return np.linalg.cond(FeatureSet(("xn", "yn", "an", *pair, "alpha")).matrix(View(camera.features(X), plane_of(X))))


@equation("T19")
def test_table_of_condition_numbers_is_that_of_the_text():
    rows = re.findall(r"^\| (parallel|tilted) \|(.*)\|$", paragraphs(THEORY.read_text())["T19"], flags=re.MULTILINE)
    assert [name for name, _ in rows] == ["parallel", "tilted"]
    for (_, row), tilt_rad in zip(rows, (0.0, np.radians(15.0))):
        cells = iter(row.split("|"))
        for pair in (("sx", "sy"), ("px", "py")):
            for target in ("rectangle", "l_shape", "blob"):
                cell, found = next(cells).strip(), condition(target, pair, tilt_rad)
                if cell == "singular":
                    assert found > 1e12
                else:
                    assert abs(found - float(cell)) <= max(0.5, 0.005 * float(cell)), (target, pair, found)


# --- T48 --------------------------------------------------------------------------------------------------------------


@formula("T48")
def C_integrand(z, p, q):
    """C_pq = integral of z^p conj(z)^q"""
    return z**p * np.conj(z) ** q


@formula("T48")
def turn(p, q, theta):
    """exp(i (p - q) theta)"""
    return np.exp(1j * (p - q) * theta)


@formula("T48")
def A_B_W(C30, C21):
    """A = |C30|^2
    B = |C21|^2
    W = C30 conj(C21)^3"""
    return np.abs(C30) ** 2, np.abs(C21) ** 2, C30 * np.conj(C21) ** 3


@formula("T48")
def D3(A, B, W):
    """D3 = (A + 3B)^2 - 16 Re W"""
    return (A + 3 * B) ** 2 - 16 * np.real(W)


@formula("T48")
def D4(C40, C31, C22):
    """D4 = |C40|^2 - 4 |C31|^2 + 3 C22^2"""
    return np.abs(C40) ** 2 - 4 * np.abs(C31) ** 2 + 3 * C22**2


@formula("T48")
def c1_to_c10(C, A, B, W, D3, D4):
    """(1 - C11^2 / abs(C20)^2) / 4
    A / B
    (A^2 - 6AB - 3B^2 + 8 Re W) / D3
    16 Im W / D3
    (A - B) (9B - A) / D3
    (A - 9B)^2 / D3
    (abs(C40)^2 + 8 abs(C31)^2 - 9 C22^2) / D4
    (-4 abs(C40)^2 + 16 abs(C31)^2 + 36 C22^2) / D4
    abs(C32)^2 / abs(C50)^2
    abs(C41)^2 / abs(C50)^2"""
    return [(1 - C[1, 1] ** 2 / abs(C[2, 0]) ** 2) / 4,
            A / B,
            (A**2 - 6 * A * B - 3 * B**2 + 8 * np.real(W)) / D3,
            16 * np.imag(W) / D3,
            (A - B) * (9 * B - A) / D3,
            (A - 9 * B) ** 2 / D3,
            (abs(C[4, 0]) ** 2 + 8 * abs(C[3, 1]) ** 2 - 9 * C[2, 2] ** 2) / D4,
            (-4 * abs(C[4, 0]) ** 2 + 16 * abs(C[3, 1]) ** 2 + 36 * C[2, 2] ** 2) / D4,
            abs(C[3, 2]) ** 2 / abs(C[5, 0]) ** 2,
            abs(C[4, 1]) ** 2 / abs(C[5, 0]) ** 2]


@formula("T48")
def L_c(c, D, L_N, L_D):
    """L_c = (L_N - c L_D) / D"""
    return (L_N - c * L_D) / D


@formula("T48")
def L_square(C, L_C):
    """L_|C|^2 = 2 Re(conj(C) L_C)"""
    return 2 * np.real(np.conj(C) * L_C)


@formula("T48")
def L_W(C30, C21, L_C30, L_C21):
    """L_W = conj(C21)^3 L_C30 + 3 C30 conj(C21)^2 conj(L_C21)"""
    return np.conj(C21) ** 3 * L_C30 + 3 * C30 * np.conj(C21) ** 2 * np.conj(L_C21)


@formula("T48")
def least(a, T, order, degree):
    """(10^-3 a (T/a)^(order/2))^degree"""
    return (10**-3 * a * (T / a) ** (order / 2)) ** degree


NAMES = tuple(f"c{k}" for k in range(1, 11))


def complex_moments(xy):
    """{(p, q): C_pq} of a polygon, by the formula under test."""
    (m, _), (x, y, weight) = moments_of(xy, 1), points_inside(xy.tobytes())
    z = x - m[1, 0] / m[0, 0] + 1j * (y - m[0, 1] / m[0, 0])
    C = {(p, k - p): np.sum(weight * C_integrand(z, p, k - p)) for k in range(2, 6) for p in range(k // 2, k + 1)}
    return {pq: value.real if pq[0] == pq[1] else value for pq, value in C.items()}


def invariants(xy):
    C = complex_moments(xy)
    A, B, W = A_B_W(C[3, 0], C[2, 1])
    return np.array(c1_to_c10(C, A, B, W, D3(A, B, W), D4(C[4, 0], C[3, 1], C[2, 2])))


def by_hu(mu):
    """C20, C11, C30, C21 in centred moments, as Hu has them."""
    return (mu[2, 0] - mu[0, 2] + 2j * mu[1, 1], mu[2, 0] + mu[0, 2],
            mu[3, 0] - 3 * mu[1, 2] + 1j * (3 * mu[2, 1] - mu[0, 3]),
            mu[3, 0] + mu[1, 2] + 1j * (mu[2, 1] + mu[0, 3]))


@equation("T48")
def test_complex_moments_are_those_of_hu_and_turn_with_the_image():
    for seed in SEEDS:
        xy = picture(VIEWS[seed])
        C, (_, mu) = complex_moments(xy), moments_of(xy)
        for found, expected in zip((C[2, 0], C[1, 1], C[3, 0], C[2, 1]), by_hu(mu)):
            same(found, expected)
        theta = 0.6
        R = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
        there = complex_moments(np.ascontiguousarray(xy @ R.T))
        for (p, q), value in C.items():
            same(there[p, q], turn(p, q, theta) * value, 1e-9)


@equation("T48")
def test_c1_to_c10_are_those_of_visp_and_of_the_product():
    found = invariants(POLYGON)
    for name, value in zip(NAMES, found):
        same(value, VISP[name][0], VISP_DIGITS, name)
    for seed in SEEDS:
        expected = product_invariants(seed)
        for name, value, wanted in zip(NAMES, invariants(picture(VIEWS[seed])), expected):
            same(value, wanted, 1e-9, name)


@functools.lru_cache(maxsize=None)
def product_invariants(seed):
    X = VIEWS[seed]
    return FeatureSet(NAMES).values(in_product(*moments_of(picture(X)), tuple(plane_of(X))))


def hu_parts(m, mu):
    """Re and Im of C30 and C21, then A, B, Re W, Im W, then c2 and c3, c4, in real polynomials."""
    _, _, C30, C21 = by_hu(mu)
    A, B, W = abs(C30) ** 2, abs(C21) ** 2, C30 * C21.conjugate() ** 3
    D = (A + 3 * B) ** 2 - 16 * W.real
    return np.array([C30.real, C30.imag, C21.real, C21.imag, A, B, W.real, W.imag, A / B,
                     (A * A - 6 * A * B - 3 * B * B + 8 * W.real) / D, 16 * W.imag / D, D])


@equation("T48")
def test_rows_follow_from_those_of_the_complex_moments():
    for seed in SEEDS:
        slopes, values = derivative(hu_parts, seed), hu_parts(*seen(seed)[:2])
        C30, C21 = values[0] + 1j * values[1], values[2] + 1j * values[3]
        L_C30, L_C21 = slopes[0] + 1j * slopes[1], slopes[2] + 1j * slopes[3]
        L_A, L_B, of_W = L_square(C30, L_C30), L_square(C21, L_C21), L_W(C30, C21, L_C30, L_C21)
        rows_same([L_A, L_B, of_W.real, of_W.imag], slopes[4:8])
        c2, c3, c4 = values[8:11]
        A, B, D = values[4], values[5], values[11]
        L_D = 2 * (A + 3 * B) * (slopes[4] + 3 * slopes[5]) - 16 * slopes[6]
        L_N = (2 * A - 6 * B) * slopes[4] - (6 * A + 6 * B) * slopes[5] + 8 * slopes[6]
        found = [L_c(c2, B, slopes[4], slopes[5]), L_c(c3, D, L_N, L_D), L_c(c4, D, 16 * slopes[7], L_D)]
        rows_same(found, slopes[8:11], 1e-6)
        rows_same(found, product(("c2", "c3", "c4"), seed)[1], 1e-6)


def lopsided(part):
    """Moments of a rectangle with that part of another shape's odd moments: c9's denominator grows with its square."""
    (m, mu), (_, odd) = moments_of(RECTANGLE), moments_of(POLYGON)
    mixed = {ij: value + part * odd[ij] if sum(ij) % 2 else value for ij, value in mu.items()}
    return m, Moments(mixed), (0.0, 0.0, 1.0)


@functools.lru_cache(maxsize=None)
def vanishes_at(name):
    """Part of `lopsided` at which the product begins to have that feature."""
    low, high = 0.0, 1.0
    for _ in range(60):
        part = 0.5 * (low + high)
        try:
            FeatureSet([name]).values(in_product(*lopsided(part)))
            high = part
        except DegenerateFeature:
            low = part
    return high


@equation("T48")
def test_a_denominator_that_is_noise_is_zero():
    for name, order, degree in (("c2", 3, 2), ("c3", 3, 4), ("c9", 5, 2)):
        m, mu, _ = lopsided(vanishes_at(name))
        if order == 3:
            _, _, C30, C21 = by_hu(mu)
            A, B, W = abs(C30) ** 2, abs(C21) ** 2, C30 * C21.conjugate() ** 3
            D = B if degree == 2 else (A + 3 * B) ** 2 - 16 * W.real
        else:
            D = abs(mu[5, 0] - 10 * mu[3, 2] + 5 * mu[1, 4] + 1j * (5 * mu[4, 1] - 10 * mu[2, 3] + mu[0, 5])) ** 2
        same(least(m[0, 0], mu[2, 0] + mu[0, 2], order, degree), D, 1e-9, name)
