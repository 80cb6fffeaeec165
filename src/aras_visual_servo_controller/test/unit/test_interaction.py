"""Interaction matrices against central differences of exact polygon moments, at tilted poses."""

import numpy as np
import pytest
from toy_plant import OUTLINE, Camera, angle_between, picture, polygon_moments

from aras_visual_servo_controller import interaction
from aras_visual_servo_controller.errors import DegenerateFeature

SEEDS = (1, 2, 3, 4)
#: Step of the central differences [s]; rounding is eps / STEP = 2e-11, truncation STEP^2 f''' = 1e-10 (f''' about 10).
STEP = 3e-6
#: Of the largest entry of a row; both of the above, times a hundred for the cancellations in centred moments.
TOLERANCE = 1e-7


def tilted_pose(seed):
    """Camera about 0.6 m above the target, tilted by up to 0.35 rad about x and y, anywhere about its axis."""
    rng = np.random.default_rng(seed)
    rx, ry = rng.uniform(-0.35, 0.35, 2)
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[:3, 3] = np.r_[rng.uniform(-0.05, 0.05, 2), rng.uniform(0.5, 0.7)]
    for twist in ([0, 0, 0, rx, 0, 0], [0, 0, 0, 0, ry, 0], [0, 0, 0, 0, 0, rng.uniform(-np.pi, np.pi)]):
        X = X @ exponential(twist, 1.0)
    return X


def exponential(twist, t):
    """Pose after a body twist held for t."""
    v, w = np.asarray(twist[:3], float), np.asarray(twist[3:], float)
    M = np.zeros((4, 4))
    M[:3, :3] = [[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]]
    M[:3, 3] = v
    X, term = np.eye(4), np.eye(4)
    for k in range(1, 40):
        term = term @ M * (t / k)
        X = X + term
    return X


def plane_of(X_WC):
    X_CW = np.linalg.inv(X_WC)
    return interaction.plane_from_pose(X_CW[:3, 2], X_CW[:3, 3])


def differences(function, X_WC, difference=np.subtract):
    """(k, 6) central differences of function(X_WC), one camera twist component at a time."""
    columns = []
    for axis in np.eye(6):
        ahead, behind = function(X_WC @ exponential(axis, STEP)), function(X_WC @ exponential(axis, -STEP))
        columns.append(np.atleast_1d(difference(ahead, behind)) / (2.0 * STEP))
    return np.array(columns).T


def raw(X_WC):
    return polygon_moments(picture(X_WC), 4)


def centred(X_WC):
    m = raw(X_WC)
    return polygon_moments(picture(X_WC), 4, (m["10"] / m["00"], m["01"] / m["00"]))


def assert_same(L, expected):
    for row, wanted in zip(np.atleast_2d(L), np.atleast_2d(expected)):
        np.testing.assert_allclose(row, wanted, rtol=0.0, atol=TOLERANCE * np.abs(wanted).max())


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("i, j", [(i, j) for i in range(4) for j in range(4 - i)])
def test_raw_moment_matrix_is_the_derivative(seed, i, j):
    X = tilted_pose(seed)
    assert_same(interaction.raw_moment(raw(X), i, j, plane_of(X)), differences(lambda X: raw(X)[f"{i}{j}"], X))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("i, j", [(2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)])
def test_centred_moment_matrix_is_the_derivative(seed, i, j):
    X = tilted_pose(seed)
    L = interaction.centred_moment(raw(X), centred(X), i, j, plane_of(X))
    assert_same(L, differences(lambda X: centred(X)[f"{i}{j}"], X))


@pytest.mark.parametrize("seed", SEEDS)
def test_area_and_centroid_matrices_are_the_derivatives(seed):
    X = tilted_pose(seed)

    def area_and_centroid(X):
        m = raw(X)
        return np.array([m["00"], m["10"] / m["00"], m["01"] / m["00"]])

    L = np.vstack([interaction.area(raw(X), plane_of(X)), interaction.centroid(raw(X), plane_of(X))])
    assert_same(L, differences(area_and_centroid, X))


def servo_features(X_WC):
    camera = Camera(None)
    camera.star = (0.6, 0.03)
    f = camera.features(X_WC)
    return np.array([f.xn, f.yn, f.an, f.alpha])


def feature_difference(a, b):
    return np.r_[a[:3] - b[:3], angle_between(a[3], b[3])]


@pytest.mark.parametrize("seed", SEEDS)
def test_servo_feature_matrix_is_the_derivative(seed):
    X = tilted_pose(seed)
    L = interaction.features(raw(X), centred(X), plane_of(X), 0.6, 0.03)
    assert_same(L, differences(servo_features, X, feature_difference))


@pytest.mark.parametrize("depth_m", [0.3, 0.59, 2.0])
def test_published_matrix_is_exact_at_any_depth_of_a_parallel_plane(depth_m):
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0, 0, 0, 0, 0, 0.7], 1.0)
    X[:3, 3] = [0.05, -0.03, depth_m]
    f = servo_features(X)
    # an is the depth only when the reference area is that of the reference depth
    camera = Camera(None)
    camera.star = (0.6, raw_area_at(0.6))
    g = camera.features(X)
    assert g.an == pytest.approx(depth_m, rel=1e-12)  # rounding of some hundred operations
    wanted = differences(lambda X: at_reference(camera, X), X, feature_difference)[:, [0, 1, 2, 5]]
    assert_same(interaction.parallel(g.xn, g.yn), wanted)
    assert f[2] != g.an


def raw_area_at(depth_m):
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[2, 3] = depth_m
    return raw(X)["00"]


def at_reference(camera, X):
    g = camera.features(X)
    return np.array([g.xn, g.yn, g.an, g.alpha])


def test_condition_of_the_published_matrix_is_that_of_its_singular_values():
    L = interaction.parallel(0.13, -0.4)
    assert interaction.parallel_condition(0.13, -0.4) == pytest.approx(np.linalg.cond(L), rel=1e-12)  # rounding


def test_polygon_moments_of_the_outline_match_a_fine_sum():
    # The exact moments everything above rests on: triangle fan, three-point rule, exact to degree two.
    m, total = polygon_moments(OUTLINE, 2), dict.fromkeys(("00", "10", "02"), 0.0)
    for a, b in zip(OUTLINE, np.roll(OUTLINE, -1, axis=0)):
        area = 0.5 * (a[0] * b[1] - a[1] * b[0])
        for p in (0.5 * a, 0.5 * b, 0.5 * (a + b)):  # the third corner is the origin
            total["00"] += area / 3.0
            total["10"] += area / 3.0 * p[0]
            total["02"] += area / 3.0 * p[1] ** 2
    for name, value in total.items():
        assert m[name] == pytest.approx(value, rel=1e-12)  # rounding


def test_empty_object_has_no_area_matrix():
    with pytest.raises(DegenerateFeature, match="area"):
        interaction.area({"00": 0.0, "10": 0.0, "01": 0.0}, (0.0, 0.0, 2.0))


def test_square_has_no_orientation_matrix():
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    m = polygon_moments(square, 3)
    m["20"] = m["02"]
    m["11"] = 0.0
    with pytest.raises(DegenerateFeature, match="isotropic"):
        interaction.orientation(m, m, (0.0, 0.0, 1.0))
