"""ViSP's moment invariants c1 to c10: against ViSP's numbers, against central differences, where they do not exist."""

import numpy as np
import pytest
import toy_plant
from views import assert_same, differences, exponential, parallel_pose, plane_of, ROUNDING, tilted_pose, view
from visp_values import PLANE, POLYGON, VISP

from aras_visual_servo import DegenerateFeature, Features, FeatureSet, View

SEEDS = (1, 2, 3, 4)
ORDERS = {"c1": 2, "c2": 3, "c3": 3, "c4": 3, "c5": 3, "c6": 3, "c7": 4, "c8": 4, "c9": 5, "c10": 5}
NAMES = tuple(ORDERS)
RECTANGLE = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])
IN_A_RECTANGLE = ("c1", "c7", "c8")  # the others are of odd order


@pytest.fixture(autouse=True)
def moments_to_order_6(monkeypatch):
    monkeypatch.setattr(toy_plant, "ORDER", 6)


def flat_view(polygon, plane=None):
    """View of a polygon given in the image."""
    m = toy_plant.polygon_moments(polygon, 6)
    mu = toy_plant.polygon_moments(polygon, 6, (m["10"] / m["00"], m["01"] / m["00"]))
    return View(Features(moment_names=tuple(m), m=list(m.values()), mu=list(mu.values())), plane)


def without(features, order):
    """The same features with moments to that order only."""
    low = Features.from_object(features)
    keep = [k for k, name in enumerate(features.moment_names) if int(name[0]) + int(name[1]) <= order]
    low.moment_names = tuple(features.moment_names[k] for k in keep)
    low.m, low.mu = [features.m[k] for k in keep], [features.mu[k] for k in keep]
    return low


@pytest.mark.parametrize("name", VISP)
def test_values_and_rows_are_those_of_visp(name):
    (wanted, wanted_row), one, seen = VISP[name], FeatureSet([name]), flat_view(POLYGON, PLANE)
    np.testing.assert_allclose(one.values(seen), [wanted], rtol=1e-9)
    if wanted_row is not None:  # nine digits
        np.testing.assert_allclose(one.matrix(seen), [wanted_row], rtol=0.0, atol=1e-8 * np.abs(wanted_row).max())


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", NAMES)
def test_matrix_of_each_invariant_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])
    assert_same(one.matrix(view(X, plane=plane_of(X))), differences(lambda X: one.values(view(X)), X))


@pytest.mark.parametrize("axis", [0, 1, 2, 5])
def test_they_do_not_change_as_a_parallel_camera_translates_and_turns(axis):
    X, features = parallel_pose(), FeatureSet(NAMES)
    there = features.values(view(X @ exponential(np.eye(6)[axis], 0.07)))
    np.testing.assert_allclose(there, features.values(view(X)), rtol=1e3 * ROUNDING)


@pytest.mark.parametrize("name", NAMES)
def test_they_change_as_it_tilts_and_with_no_other_motion(name):
    X = parallel_pose()
    row = FeatureSet([name]).matrix(view(X, plane=plane_of(X)))[0]
    assert np.abs(row).max() > 1e-2
    np.testing.assert_allclose(row[[0, 1, 2, 5]], 0.0, atol=1e3 * ROUNDING * np.abs(row).max())


@pytest.mark.parametrize("name", NAMES)
def test_order_is_what_the_row_needs_and_one_less_does_for_the_value(name):
    features, one = view(tilted_pose(1)).features, FeatureSet([name])
    assert one.order == ORDERS[name] + 1 and one.sees_tilt
    plane = plane_of(tilted_pose(1))
    enough, low = without(features, one.order), without(features, ORDERS[name])
    assert np.isfinite(one.matrix(View(enough, plane))).all()
    assert one.values(View(low)) == one.values(View(enough))
    with pytest.raises(DegenerateFeature, match=f"vision.order to {one.order} "):
        one.matrix(View(low, plane))


@pytest.mark.parametrize("name", NAMES)
def test_a_rectangle_seen_parallel_has_those_of_even_order_only(name):
    X, one = parallel_pose(), FeatureSet([name])
    X[:2, 3] = 0.0
    seen = view(X, RECTANGLE, plane_of(X))
    if name in IN_A_RECTANGLE:  # and they do not tell its tilt at the centre of the image
        assert np.isfinite(one.values(seen)).all()
        np.testing.assert_allclose(one.matrix(seen), 0.0, atol=1e3 * ROUNDING * abs(one.values(seen)[0]))
        return
    for made in (one.values, one.matrix):
        with pytest.raises(DegenerateFeature, match=f"{name}: 0/0, .*order {ORDERS[name]}.*must be > 0.001"):
            made(seen)


def test_an_isotropic_object_has_no_c1_and_an_empty_one_none():
    square = flat_view(np.array([[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]))
    with pytest.raises(DegenerateFeature, match="c1: 0/0"):
        FeatureSet(["c1"]).values(square)
    empty = flat_view(POLYGON)
    empty.m["00"] = 0.0
    with pytest.raises(DegenerateFeature, match="c7: found area 0.0"):
        FeatureSet(["c7"]).values(empty)
