"""Features by name: their matrices against central differences, their invariances, the set, the registry."""

import numpy as np
import pytest
from views import assert_same, differences, exponential, parallel_pose, plane_of, ROUNDING, SIX, tilted_pose, view

from aras_visual_servo import DegenerateFeature, Features, FeatureSet, known_features, ParameterError, View

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


def test_an_isotropic_object_has_no_invariants():
    square = np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]])
    flat = view(np.array([[1.0, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 0.5], [0, 0, 0, 1]]), square)
    flat.mu.update({"20": 1.0, "02": 1.0, "11": 0.0})
    with pytest.raises(DegenerateFeature, match="isotropic"):
        FeatureSet(["sx"]).values(flat)
