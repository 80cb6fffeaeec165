"""Moment and kernel features and interaction matrices: central differences, invariances, the set, the registry."""

import re

import numpy as np
import pytest
from toy_plant import angle_between, Camera, OUTLINE, picture, polygon_moments
from views import (assert_same, differences, exponential, parallel, parallel_pose, plane_of, ROUNDING, SIX, tilted_pose,
                   view)

from aras_visual_servo import (DegenerateFeature, Feature, Features, FeatureSet, known_features, NotFiniteError,
                               ParameterError, ShapeError, View)
from aras_visual_servo.features import interaction
from aras_visual_servo.features.base import FEATURES

SEEDS = (1, 2, 3, 4)
INVARIANTS = ("sx", "sy", "px", "py")


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", ["xn", "yn", "an", "alpha", *INVARIANTS])
def test_matrix_of_each_feature_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])

    def difference(a, b):
        return one.error(a, b, False)

    wanted = differences(lambda X: one.values(view(X)), X, difference)
    assert_same(one.matrix(view(X, plane=plane_of(X))), wanted)


@pytest.mark.parametrize("seed", SEEDS)
def test_matrix_of_a_rectangle_is_the_derivative_where_its_third_order_moments_vanish(seed):
    X = parallel_pose(0.3 * seed)
    outline = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])
    features = FeatureSet(("sx", "sy"))
    wanted = differences(lambda X: features.values(view(X, outline)), X)
    assert_same(features.matrix(view(X, outline, plane_of(X))), wanted)


@pytest.mark.parametrize("twist", [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 1, 0, 0, 0]])
@pytest.mark.parametrize("name", INVARIANTS)
def test_invariants_do_not_change_as_a_parallel_camera_translates(name, twist):
    one, X = FeatureSet([name]), parallel_pose()
    here, there = one.values(view(X)), one.values(view(X @ exponential(twist, 0.07)))
    np.testing.assert_allclose(there, here, atol=ROUNDING)


def test_a_turn_about_the_axis_turns_sx_and_sy_and_leaves_px_and_py():
    X, angle = parallel_pose(), 0.3
    here, there = (FeatureSet(("sx", "sy")).values(view(pose)) for pose in (X, X @ exponential([0] * 5 + [angle], 1.0)))
    turned = complex(*there) / complex(*here)
    assert abs(turned) == pytest.approx(1.0, abs=ROUNDING)
    assert abs(np.angle(turned)) == pytest.approx(angle, abs=ROUNDING)
    there = FeatureSet(("px", "py")).values(view(X @ exponential([0] * 5 + [angle], 1.0)))
    np.testing.assert_allclose(there, FeatureSet(("px", "py")).values(view(X)), atol=ROUNDING)


def test_set_keeps_the_order_of_its_names_and_knows_what_it_needs():
    features, X = FeatureSet(SIX), tilted_pose(1)
    here = view(X, plane=plane_of(X))
    L = features.matrix(here)
    assert L.shape == (6, 6) and features.sees_tilt and features.order == 4
    for row, value, name in zip(L, features.values(here), SIX):
        np.testing.assert_array_equal(FeatureSet([name]).matrix(here)[0], row)
        assert FeatureSet([name]).values(here) == (value,)
    assert not FeatureSet().sees_tilt


def test_only_the_angle_is_wrapped():
    e = FeatureSet(("xn", "alpha")).error((4.0, 3.1), (-4.0, -3.1), False)
    assert e == pytest.approx((8.0, 6.2 - 2.0 * np.pi))


def test_px_and_py_cannot_tell_the_tilt_of_a_rectangle():
    outline, X = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]]), parallel_pose()
    L = FeatureSet(("xn", "yn", "an", "px", "py", "alpha")).matrix(view(X, outline, plane_of(X)))
    assert np.linalg.cond(L) > 1e9  # singular but for rounding
    L = FeatureSet(SIX).matrix(view(X, outline, plane_of(X)))
    assert np.linalg.cond(L) < 50.0


def test_unknown_feature_names_the_nearest_one():
    with pytest.raises(ParameterError, match=r"alpa,.* did you mean alpha\?"):
        FeatureSet(("xn", "alpa"))
    with pytest.raises(ParameterError, match="different names"):
        FeatureSet(("xn", "xn"))
    assert {"xn", "yn", "an", "alpha", *INVARIANTS} <= set(known_features())


def test_moments_of_too_low_an_order_say_which_order_is_needed():
    full = view(tilted_pose(1)).features
    low = Features.from_object(full)
    keep = [k for k, name in enumerate(full.moment_names) if int(name[0]) + int(name[1]) <= 3]
    low.moment_names = tuple(full.moment_names[k] for k in keep)
    low.m, low.mu = [full.m[k] for k in keep], [full.mu[k] for k in keep]
    with pytest.raises(DegenerateFeature, match="vision.order to 4"):
        FeatureSet(SIX).matrix(View(low, (0.0, 0.0, 2.0)))


class Own(Feature):
    """A feature of a user, whose value and row are those of an instance."""

    def value(self, view):
        return self.number["value"]

    def row(self, view):
        return self.number["row"]


OWN = {"value": 0.5, "row": np.ones(6)}


@pytest.mark.parametrize("wrong, told", [
    ({"row": [1.0, 2.0, 3.0, 4.0]}, "row: found [1.0, 2.0, 3.0, 4.0], allowed numbers of shape (6,)"),
    ({"row": None}, "row: found None"), ({"row": {"v": 1}}, "row: found {'v': 1}"),
    ({"row": np.ones((1, 6))}, "row: found shape (1, 6)"),
    ({"value": "much"}, "value: found 'much', allowed a number"),
    ({"value": np.ones(2)}, "value: found shape (2,), allowed a number"),
    ({"value": None}, "value: found None")])
def test_a_wrong_value_or_row_names_feature_and_file_and_line(monkeypatch, wrong, told):
    monkeypatch.setitem(FEATURES, "own", type("own", (Own,), {"name": "own", "number": {**OWN, **wrong}}))
    here, features = view(tilted_pose(1), plane=plane_of(tilted_pose(1))), FeatureSet(["xn", "own", "yn"])
    method = next(iter(wrong))
    with pytest.raises(ShapeError) as caught:
        features.values(here) if method == "value" else features.matrix(here)
    line = getattr(Own, method).__code__.co_firstlineno
    assert str(caught.value).startswith(f"{__file__}:{line}: feature 'own': {told}")


@pytest.mark.parametrize("method, numbers, told", [
    ("value", [np.nan, np.inf, 1.0], "value: found nan"), ("value", [1.0, np.inf, 1.0], "value: found inf"),
    ("row", [np.ones(6), [1.0] * 5 + [np.nan], np.ones(6)], "row: found [1.0, 1.0, 1.0, 1.0, 1.0, nan]")])
def test_numbers_that_are_not_finite_name_the_first_feature(method, numbers, told):
    features = FeatureSet(["xn", "yn", "alpha"])
    features.check_finite(method, np.ones(3))
    with pytest.raises(NotFiniteError) as caught:
        features.check_finite(method, numbers)
    name = "xn" if np.isnan(numbers[0]).any() else "yn"
    assert re.match(rf"\S+features/moments.py:[0-9]+: feature '{name}': {re.escape(told)}, ", str(caught.value))


def test_a_key_error_in_the_code_of_a_feature_is_not_a_missing_moment(monkeypatch):
    monkeypatch.setitem(FEATURES, "own", type("own", (Own,), {"name": "own", "number": {}}))
    for of in (FeatureSet(["own"]).values, FeatureSet(["own"]).matrix):
        with pytest.raises(KeyError):
            of(view(tilted_pose(1)))


def test_an_isotropic_object_has_no_invariants():
    square = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])
    flat = view(np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.5], [0, 0, 0, 1]]), square)
    flat.mu.update({"20": 1.0, "02": 1.0, "11": 0.0})
    with pytest.raises(DegenerateFeature, match="isotropic"):
        FeatureSet(["sx"]).values(flat)


P, Q, X0, Y0 = 1.5, 2.0, -0.9, -0.7
# Of X^-3.5 along an edge that is a fifth of its distance from the corner: rounding.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(20)


def integrals(xy, exponent, origin):
    """[exponent, origin, six integrals] of an outline, by Green's theorem in y."""
    way, nodes, weights = np.roll(xy, -1, axis=0) - xy, 0.5 * (NODES + 1.0), 0.5 * WEIGHTS
    points = xy[:, None, :] + nodes[None, :, None] * way[:, None, :]
    X, y, dx = points[..., 0] - origin, points[..., 1], way[:, 0][:, None] * weights
    area = np.sum(y * dx)
    return [exponent, origin] + [float(np.sign(area) * np.sum(X ** -(exponent - 1 + k) * y ** (j + 1) * dx) / (j + 1))
                                 for k in range(3) for j in range(2)]


def kernel_view(X_WC, plane=None):
    xy = picture(X_WC, outline=OUTLINE)
    return View(Features(valid=True, kernel_x=integrals(xy, P, X0), kernel_y=integrals(xy[:, ::-1], Q, Y0)), plane)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
@pytest.mark.parametrize("name", ["kx", "ky"])
def test_matrix_of_each_projection_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])
    wanted = differences(lambda X: one.values(kernel_view(X)), X)
    assert_same(one.matrix(kernel_view(X, plane_of(X))), wanted)


def test_the_projection_is_the_integral_without_the_others():
    v = kernel_view(tilted_pose(1))
    assert FeatureSet(["kx", "ky"]).values(v) == (v.features.kernel_x[4], v.features.kernel_y[4])


def test_a_view_without_projections_is_degenerate_and_says_what_to_set():
    with pytest.raises(DegenerateFeature, match="vision.kernel"):
        FeatureSet(["kx"]).values(View(Features(valid=True)))


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
