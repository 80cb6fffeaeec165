"""T1 to T5: moments of an object, its orientation, the normalised features, and the plane it lies in."""
import functools

import numpy as np
import pytest
from equations import equation, formula, same
from scenes import Moments, in_product, moments_of, pose, seen
from toy_plant import OUTLINE, picture
from views import parallel_pose

from aras_visual_servo.features import interaction
from aras_visual_servo.features.base import FeatureSet
from aras_visual_servo.ground.errors import DegenerateFeature
from aras_visual_servo.features.target.target_pose import PlanarTarget

SEEDS = (1, 2, 3)
ORDERS = [(i, j) for i in range(5) for j in range(5 - i)]
#: Of moments summed over pixels: the weight of a pixel sits in its middle, which at 200 pixels is off by h^2.
PIXELS = 1e-4


@functools.lru_cache(maxsize=None)
def points_inside(xy):
    """(x, y, weight) of a rule that integrates polynomials over a convex polygon, (n, 2) as bytes: products of Gauss'
    rule over the triangles of a fan (Duffy's map), exact to degree 8."""
    nodes, weights = np.polynomial.legendre.leggauss(6)
    u, v = np.meshgrid(0.5 * (nodes + 1.0), 0.5 * (nodes + 1.0))
    weight = 0.25 * np.outer(weights, weights)
    points = []
    corners = np.frombuffer(xy).reshape(-1, 2)
    for b, c in zip(corners[1:-1], corners[2:]):
        a = corners[0]
        p = a + u[..., None] * (b - a) + (u * v)[..., None] * (c - b)
        points.append(np.dstack([p, weight * u * np.cross(b - a, c - a)]).reshape(-1, 3))
    x, y, weight = np.concatenate(points).T
    return x, y, weight * np.sign(weight.sum())


@formula("T1")
def integrand(x, y, i, j):
    """m_ij = integral over the object of x^i y^j dx dy"""
    return x**i * y**j


@formula("T1")
def pixel(c, x, y, i, j, dA):
    """c x^i y^j dA"""
    return c * x**i * y**j * dA


@functools.lru_cache(maxsize=None)
def moments_of_the_product(seed):
    """m[i, j] of the outline from pose(seed), by the class that predicts what is seen of a known target."""
    return PlanarTarget([OUTLINE]).moments(np.linalg.inv(pose(seed)))


@equation("T1")
def test_raw_moments_are_the_integrals_of_powers():
    for seed in SEEDS:
        x, y, weight = points_inside(picture(pose(seed)).tobytes())
        for i, j in ORDERS:
            found = np.sum(weight * integrand(x, y, i, j))
            same(found, seen(seed)[0][i, j], what=f"m_{i}{j} by Green's theorem")
            same(found, moments_of_the_product(seed)[i, j], what=f"m_{i}{j} of the product")


@equation("T1")
def test_pixels_weighted_by_their_coverage_add_up_to_the_moments():
    # A rectangle whose sides pass through pixels: the coverage is the product of that of its two ranges.
    pitch, sides = 1e-3, ((-0.0513, 0.1208), (0.0204, 0.1109))
    centres = np.arange(-200, 200) * pitch
    cover = [np.clip(np.minimum(centres + pitch / 2, high) - np.maximum(centres - pitch / 2, low), 0.0, None) / pitch
             for low, high in sides]
    coverage, (x, y) = np.outer(*cover), np.meshgrid(centres, centres, indexing="ij")
    for i, j in ORDERS[:-1]:
        exact = np.prod([(high ** (k + 1) - low ** (k + 1)) / (k + 1) for k, (low, high) in zip((i, j), sides)])
        same(np.sum(pixel(coverage, x, y, i, j, pitch**2)), exact, PIXELS * (1 + i + j) ** 2, f"m_{i}{j}")


@formula("T2")
def centroid(m00, m10, m01):
    """xg = m10 / m00
    yg = m01 / m00"""
    return m10 / m00, m01 / m00


@formula("T2")
def centred_integrand(x, y, xg, yg, i, j):
    """mu_ij = integral of (x - xg)^i (y - yg)^j dx dy"""
    return (x - xg) ** i * (y - yg) ** j


@formula("T2")
def n(mu_ij, m00):
    """n_ij = mu_ij / m00"""
    return mu_ij / m00


@equation("T2")
def test_centroid_is_the_mean_of_triangles_and_centred_moments_those_about_it():
    for seed in SEEDS:
        xy, (m, mu, plane) = picture(pose(seed)), seen(seed)
        areas = [0.5 * np.cross(b - xy[0], c - xy[0]) for b, c in zip(xy[1:-1], xy[2:])]
        middles = [(xy[0] + b + c) / 3.0 for b, c in zip(xy[1:-1], xy[2:])]
        mean = np.average(middles, axis=0, weights=areas)
        xg, yg = centroid(m[0, 0], m[1, 0], m[0, 1])
        same([xg, yg], mean)
        x, y, weight = points_inside(xy.tobytes())
        for i, j in ORDERS[1:]:
            found = np.sum(weight * centred_integrand(x, y, xg, yg, i, j))
            # Those of first order vanish: what they are measured by is the size of the object.
            same(found + m[0, 0], mu[i, j] + m[0, 0], what=f"mu_{i}{j}")
            same(found + (i + j < 2), mu[i, j] + (i + j < 2), 1e-8, f"mu_{i}{j}")
        product = FeatureSet(("n20", "n11", "n02")).values(in_product(m, mu, plane))
        same([n(mu[i, j], m[0, 0]) for i, j in ((2, 0), (1, 1), (0, 2))], product)


@formula("T3")
def alpha(mu20, mu11, mu02):
    """alpha = 1/2 atan2(2 mu11, mu20 - mu02)"""
    return 1 / 2 * np.arctan2(2 * mu11, mu20 - mu02)


@formula("T3")
def D(mu20, mu11, mu02):
    """D = (mu20 - mu02)^2 + 4 mu11^2"""
    return (mu20 - mu02) ** 2 + 4 * mu11**2


@equation("T3")
def test_alpha_is_the_principal_axis_modulo_pi_and_exists_where_the_axes_differ():
    for seed in SEEDS:
        _, mu, _ = seen(seed)
        lengths, axes = np.linalg.eigh([[mu[2, 0], mu[1, 1]], [mu[1, 1], mu[0, 2]]])
        found = alpha(mu[2, 0], mu[1, 1], mu[0, 2])
        same(np.abs(axes[:, 1] @ [np.cos(found), np.sin(found)]), 1.0, 1e-14)
        same(np.tan(found), axes[1, 1] / axes[0, 1])
        same(D(mu[2, 0], mu[1, 1], mu[0, 2]), (lengths[1] - lengths[0]) ** 2)


@equation("T3")
def test_half_a_turn_leaves_alpha_and_turns_the_third_order_round():
    xy = picture(pose(1))
    (_, mu), (_, turned) = moments_of(xy), moments_of(-xy)
    same(alpha(turned[2, 0], turned[1, 1], turned[0, 2]), alpha(mu[2, 0], mu[1, 1], mu[0, 2]))
    same([turned[3, 0], turned[0, 3]], [-mu[3, 0], -mu[0, 3]])


@equation("T3")
def test_a_square_has_no_orientation():
    m, mu = moments_of(np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]))
    assert D(mu[2, 0], mu[1, 1], mu[0, 2]) < 1e-30
    exact = Moments({**mu, (2, 0): mu[0, 2], (1, 1): 0.0})
    with pytest.raises(DegenerateFeature):
        FeatureSet(["alpha"]).matrix(in_product(m, exact, (0.0, 0.0, 1.0)))


@formula("T4")
def an(z_star, a_star, a):
    """an = Z* sqrt(a* / a)"""
    return z_star * np.sqrt(a_star / a)


@formula("T4")
def xn_yn(an, xg, yg):
    """xn = an xg
    yn = an yg"""
    return an * xg, an * yg


@equation("T4")
def test_an_is_the_depth_and_xn_yn_the_centroid_in_metres_of_a_parallel_plane():
    outline_m, _ = moments_of(OUTLINE, 1)
    for depth in (0.3, 0.8):
        X = parallel_pose()
        X[2, 3] = depth
        m, _ = moments_of(picture(X), 1)
        # Seen parallel, the image is the object by 1 / depth: a* is that at Z* = 0.5 m.
        z = an(0.5, outline_m[0, 0] / 0.5**2, m[0, 0])
        same(z, depth)
        point = np.linalg.inv(X) @ [outline_m[1, 0] / outline_m[0, 0], outline_m[0, 1] / outline_m[0, 0], 0.0, 1.0]
        same(xn_yn(z, m[1, 0] / m[0, 0], m[0, 1] / m[0, 0]), point[:2])


@formula("T5")
def plane(n, t):
    """(A, B, C) = n / (n . t)"""
    return n / (n @ t)


@formula("T5")
def over_Z(A, B, C, x, y):
    """1/Z = A x + B y + C"""
    return A * x + B * y + C


@formula("T5")
def parallel(Z):
    """A = B = 0, C = 1/Z"""
    return 0, 0, 1 / Z


@formula("T5")
def over_Zg(A, B, C, xg, yg):
    """1/Zg = A xg + B yg + C"""
    return A * xg + B * yg + C


@equation("T5")
def test_inverse_depth_is_linear_over_the_image_of_a_plane():
    for seed in SEEDS:
        X_CW = np.linalg.inv(pose(seed))
        normal, point = X_CW[:3, 2], X_CW[:3, 3]
        A, B, C = plane(normal, point)
        same([A, B, C], interaction.plane_from_pose(normal, point))
        for x_W, y_W in OUTLINE:
            x, y, z = (X_CW @ [x_W, y_W, 0.0, 1.0])[:3]
            same(over_Z(A, B, C, x / z, y / z), 1.0 / z)
        m, _, _ = seen(seed)
        ray = np.array([m[1, 0], m[0, 1], m[0, 0]]) / m[0, 0]
        # Where the ray through the centroid meets the plane: Z ray = point + a e1 + b e2.
        Z, _, _ = np.linalg.solve(np.column_stack([ray, -X_CW[:3, :2]]), point)
        same(over_Zg(A, B, C, *ray[:2]), 1.0 / Z)


@equation("T5")
def test_a_parallel_plane_has_one_depth():
    same(parallel(0.7), interaction.plane_from_pose([0.0, 0.0, 1.0], [0.2, -0.1, 0.7]))
