"""Interaction matrices against central differences of exact polygon moments, at tilted poses."""

import numpy as np
import pytest
from views import assert_same, differences, exponential, parallel, plane_of, tilted_pose
from toy_plant import OUTLINE, Camera, angle_between, picture, polygon_moments

from aras_visual_servo.features import interaction
from aras_visual_servo.ground.errors import DegenerateFeature

SEEDS = (1, 2, 3, 4)
#: Step of the central differences [s]; rounding is eps / STEP = 2e-11, truncation STEP^2 f''' = 1e-10 (f''' about 10).
#: Of the largest entry of a row; both of the above, times a hundred for the cancellations in centred moments.


def raw(X_WC):
    return polygon_moments(picture(X_WC), 4)


def centred(X_WC):
    m = raw(X_WC)
    return polygon_moments(picture(X_WC), 4, (m["10"] / m["00"], m["01"] / m["00"]))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("i, j", [(2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)])
def test_centred_moment_matrix_is_the_derivative(seed, i, j):
    X = tilted_pose(seed)
    L = interaction.centred_moments(raw(X), centred(X), [(i, j)], plane_of(X))[0]
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
    L = np.vstack([interaction.normalised(raw(X), plane_of(X), 0.6, 0.03),
                   interaction.orientation(raw(X), centred(X), plane_of(X))])
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
    assert_same(parallel(g.xn, g.yn), wanted)
    assert f[2] != g.an


def raw_area_at(depth_m):
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[2, 3] = depth_m
    return raw(X)["00"]


def at_reference(camera, X):
    g = camera.features(X)
    return np.array([g.xn, g.yn, g.an, g.alpha])


def test_condition_of_the_published_matrix_is_that_of_its_singular_values():
    L = parallel(0.13, -0.4)
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
