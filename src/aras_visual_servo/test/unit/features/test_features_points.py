"""Points, segments, ellipses, polar points, lines, vanishing points, rays: rows against differences and ViSP's."""

import numpy as np
import pytest
from views import assert_same, differences, exponential, plane_of, tilted_pose, view
from visp_values import PLANE, POLYGON

from aras_visual_servo import (
    DegenerateFeature, expand, Features, FeatureSet, known_features, Look, ParameterError, Reference, ServoSettings,
    View)
from aras_visual_servo.laws.base import LawSetup, make_law

SEEDS = (1, 2, 3, 4)
POINTS = ("x1", "y1", "x3", "y3", "x5", "y5")
SEGMENTS = ("xm1", "ym1", "l1", "alpha1", "xm5", "ym5", "l5", "alpha5")  # the fifth ends where the first begins
ELLIPSE = ("xg", "yg", "n20", "n11", "n02")
ROUNDING = 1e-12  # of some ten operations on numbers near 1


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", [*POINTS, *SEGMENTS, *ELLIPSE])
def test_row_of_each_feature_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])
    wanted = differences(lambda X: one.values(view(X)), X, lambda a, b: one.error(a, b, False))
    assert_same(one.matrix(view(X, plane=plane_of(X))), wanted)


def test_segment_from_the_last_point_ends_at_the_first():
    here = view(tilted_pose(1))
    x, y = (np.array(getattr(here.features, name))[[4, 0]] for name in ("point_x", "point_y"))
    expected = (x.mean(), y.mean(), np.hypot(*np.diff([x, y]).ravel()), np.arctan2(*np.diff([y, x]).ravel()))
    np.testing.assert_allclose(FeatureSet(SEGMENTS[4:]).values(here), expected, atol=ROUNDING)


def test_direction_of_a_segment_is_known_modulo_a_full_turn_even_of_a_symmetric_object():
    (e,) = FeatureSet(["alpha1"]).error((2.0,), (0.0,), True)
    assert e == 2.0
    (e,) = FeatureSet(["alpha1"]).error((3.1,), (-3.1,), True)
    assert e == pytest.approx(6.2 - 2.0 * np.pi, abs=ROUNDING)


def test_ellipse_of_an_ellipse_is_its_half_axes_squared_over_four():
    angle = np.linspace(0.0, 2.0 * np.pi, 4000, endpoint=False)
    outline = np.stack([0.1 * np.cos(angle), 0.05 * np.sin(angle)], axis=1)
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[2, 3] = 0.5
    chords = 1e-6  # a polygon of n corners lacks (2 pi / n)^2 / 6 of the area, twice that of the second moments
    expected = [0.0, 0.0, (0.1 / 0.5) ** 2 / 4.0, 0.0, (0.05 / 0.5) ** 2 / 4.0]
    np.testing.assert_allclose(FeatureSet(ELLIPSE).values(view(X, outline)), expected, atol=chords)


def test_ellipse_tells_five_motions_of_a_tilted_view_four_of_a_parallel_one_and_three_of_a_disc():
    def rank(outline, X):
        return np.linalg.matrix_rank(FeatureSet(ELLIPSE).matrix(view(X, outline, plane_of(X))), tol=1e-6)

    angle = np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False)
    disc = 0.1 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    parallel = np.diag([1.0, -1.0, -1.0, 1.0])
    parallel[2, 3] = 0.5
    assert rank(disc * [1.0, 0.5], tilted_pose(1)) == 5
    assert rank(disc * [1.0, 0.5], parallel) == 4
    assert rank(disc, parallel) == 3


def test_points_are_written_out_and_known_by_number():
    assert expand(("points2", "alpha")) == ("x1", "y1", "x2", "y2", "alpha")
    assert FeatureSet(["points4"]).names == ("x1", "y1", "x2", "y2", "x3", "y3", "x4", "y4")
    assert {"xN", "yN", "xmN", "ymN", "lN", "alphaN", *ELLIPSE} <= set(known_features())
    for name in ("x0", "x100", "x", "points0", "z1"):
        with pytest.raises(ParameterError, match=f"features: found {name}, "):
            FeatureSet([name])


@pytest.mark.parametrize("x, y, text", [
    ((), (), "found 0 x and 0 y"), ((0.1,), (), "found 1 x and 0 y"), ((0.1, 0.2), (0.0, 0.1), "x3: found 2 points")])
def test_points_that_are_not_there_are_said(x, y, text):
    with pytest.raises(DegenerateFeature, match=text):
        FeatureSet(["x3"]).values(View(Features(point_x=x, point_y=y)))


def test_a_segment_without_length_has_no_direction_to_follow():
    here = View(Features(point_x=(0.1, 0.1), point_y=(0.2, 0.2)), (0.0, 0.0, 2.0))
    with pytest.raises(DegenerateFeature, match="alpha1: the segment has no length"):
        FeatureSet(["alpha1"]).matrix(here)


# --- the depth of each point ------------------------------------------------------------------------------------------

GOAL, HERE = tilted_pose(1), tilted_pose(2)
EIGHT = FeatureSet(["points4"]).names


def test_number_of_points_that_changes_is_refused():
    with pytest.raises(DegenerateFeature, match="found 5 in this view, 4 at the goal"):
        FeatureSet(EIGHT).matrix(View(view(HERE).features, None, None, [2.0] * 4))


def test_reference_keeps_its_points_through_a_round_trip():
    goal = view(GOAL)
    again = Reference.from_dict(Reference(np.zeros(2), view=goal.features, plane_C=plane_of(GOAL)).to_dict())
    np.testing.assert_array_equal(again.view.point_x, goal.features.point_x)
    np.testing.assert_array_equal(again.view.point_y, goal.features.point_y)
    bad = Reference(np.zeros(2), view=goal.features).to_dict()
    bad["view"]["point_y"] = bad["view"]["point_y"][:-1]
    with pytest.raises(ParameterError, match="reference.view.point_y"):
        Reference.from_dict(bad)


def test_a_scenario_gives_all_points_one_gain():
    section = {"law": "ibvs", "mode": "continuous", "features": ["points4"], "gains_per_s": {"points4": 2.0},
               "thresholds": {"points2": 0.001, "points4": 0.002}, "time_limit_s": 10.0, "point_depth": "goal"}
    config = ServoSettings.from_dict(section)
    assert config.features == EIGHT and config.gains_per_s == (2.0,) * 8 and config.thresholds == (0.002,) * 8
    assert config.point_depth == "goal"
    with pytest.raises(ParameterError, match="gains_per_s.4: found"):
        ServoSettings.from_dict({**section, "gains_per_s": {4: 2.0, "points4": 2.0}})
    with pytest.raises(ParameterError, match="gains_per_s.x4: found nothing"):
        ServoSettings.from_dict({**section, "gains_per_s": {"points3": 2.0}})


QUADRILATERAL = np.array([[-0.09, -0.05], [0.09, -0.05], [0.09, 0.05], [-0.09, 0.05]])
POLAR, LINES = ("rho1", "theta1", "rho4", "theta4"), ("lr1", "lt1", "lr3", "lt3", "lr4", "lt4")
VANISHING, RAYS = ("vx1", "vy1", "vz1", "vx2", "vy2", "vz4"), ("us1", "vs1", "ws1", "us4", "vs4", "ws4")
#: ViSP 3.5.0 of the first two corners of POLYGON in PLANE: vpFeaturePointPolar (rho, theta) and vpFeatureLine (rho,
#: theta; its plane has D = -1), by `interaction()` of each, printed to twelve digits.
VISP = {
    "rho1": [1.58904452423, 0.529681508078, 0.264840754039, -0.324133460167, 0.972400380502, 0],
    "theta1": [-3.35, 10.05, 0, -6, -2, -1],
    "lr1": [-0.283677117419, -1.70206270452, -0.127654702839, 0.991792431118, -0.16529873852, 0],
    "lt1": [-0.0594594594595, -0.356756756757, -0.0267567567568, 0.0121621621622, 0.072972972973, -1],
}
#: Of twelve printed digits.
PRINTED = 1e-10
SETS = {"polar": ("rho1", "theta1", "rho2", "theta2", "rho3", "theta3", "rho4", "theta4"),
        "lines": ("lr1", "lt1", "lr2", "lt2", "lr3", "lt3", "lr4", "lt4"),
        "rays": tuple(f"{axis}s{number}" for number in (1, 2, 3, 4) for axis in "uvw")}


def seen(X):
    return view(X, QUADRILATERAL, plane_of(X))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", [*POLAR, *LINES, *VANISHING, *RAYS])
def test_row_of_each_kind_is_the_derivative(name, seed):
    X, one = tilted_pose(seed), FeatureSet([name])
    expected = differences(lambda X: one.values(seen(X)), X, lambda a, b: one.error(a, b, False))
    assert_same(one.matrix(seen(X)), expected)


@pytest.mark.parametrize("names", [("points4",), RAYS])
def test_rows_with_the_depth_of_each_point_are_those_with_the_plane(names):
    here, names = seen(tilted_pose(1)), FeatureSet(names)
    over_Z = [plane_of(tilted_pose(1)) @ [x, y, 1.0] for x, y in zip(here.features.point_x, here.features.point_y)]
    np.testing.assert_allclose(names.matrix(View(here.features, None, None, over_Z)), names.matrix(here), atol=ROUNDING)


@pytest.mark.parametrize("name", VISP)
def test_rows_are_those_of_visp(name):
    (x, y), features = POLYGON[:2].T.tolist(), FeatureSet([name])
    here = View(Features(point_x=x, point_y=y), PLANE)
    np.testing.assert_allclose(features.matrix(here)[0], VISP[name], atol=PRINTED)


def test_the_row_of_a_vanishing_point_is_that_of_visp():
    # vpFeatureVanishingPoint at x = 0.7, y = -0.4 gives the rows of x = v_x / v_z and y = v_y / v_z below.
    x, y = 0.7, -0.4
    corners = np.array([[0.0, 0.0], [0.2 * x, 0.2 * y], [0.2 * x + 0.08, 0.2 * y + 0.12], [0.1, 0.15]])
    here = View(Features(point_x=corners[:, 0].tolist(), point_y=corners[:, 1].tolist()), PLANE)
    vanishing = FeatureSet(["vx1", "vy1", "vz1"])
    d, L = np.array(vanishing.values(here)), vanishing.matrix(here)
    np.testing.assert_allclose(d[:2] / d[2], [x, y], atol=PRINTED)
    rows = [(L[k] - (d[k] / d[2]) * L[2]) / d[2] for k in (0, 1)]
    np.testing.assert_allclose(rows, [[0, 0, 0, -0.28, -1.49, -0.4], [0, 0, 0, 1.16, 0.28, -0.7]], atol=PRINTED)


def test_vanishing_points_are_the_directions_of_the_sides_in_the_camera_also_in_a_parallel_view():
    parallel = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0, 0, 0, 0, 0, 0.4], 1.0)
    parallel[:3, 3] = [0.02, -0.03, 0.6]
    for X in (parallel, *map(tilted_pose, SEEDS)):
        for number, side in ((1, [1.0, 0.0, 0.0]), (2, [0.0, 1.0, 0.0]), (3, [-1.0, 0.0, 0.0])):
            found = FeatureSet([f"v{axis}{number}" for axis in "xyz"]).values(seen(X))
            np.testing.assert_allclose(found, X[:3, :3].T @ side, atol=1e-9)


def test_rays_are_unit_vectors_and_turn_rigidly():
    X = tilted_pose(2)
    L = FeatureSet(RAYS[:3]).matrix(seen(X))
    assert np.linalg.norm(FeatureSet(RAYS[:3]).values(seen(X))) == pytest.approx(1.0, abs=ROUNDING)
    np.testing.assert_allclose(np.linalg.svd(L[:, 3:])[1], [1.0, 1.0, 0.0], atol=ROUNDING)


def test_a_line_keeps_its_sign_through_the_image_centre():
    distances = []
    for aside in (-0.05, 0.05):
        here = View(Features(point_x=(-0.1, 0.1), point_y=(aside, aside)))
        distances.append(FeatureSet(["lr1", "lt1"]).values(here))
    (below, angle), (above, same) = distances
    assert below == pytest.approx(-0.05) and above == pytest.approx(0.05)
    assert angle == same == pytest.approx(0.5 * np.pi)


@pytest.mark.parametrize("names, x, y, text", [
    (["theta1"], (0.0, 1.0), (0.0, 1.0), "at the image centre"),
    (["lr1"], (0.1, 0.1), (0.2, 0.2), "two followed points coincide"),
    (["vx1"], (0.1, 0.2, 0.3), (0.1, 0.2, 0.1), "found 3 points in this view, needed 4"),
    (["vx1"], (0.1, 0.2, 0.3, 0.4), (0.1, 0.2, 0.3, 0.4), "lie on one line"),
    (["us3"], (0.1, 0.2), (0.1, 0.2), "found 2 points .*at least 3")])
def test_what_does_not_exist_in_a_view_is_told(names, x, y, text):
    with pytest.raises(DegenerateFeature, match=text):
        FeatureSet(names).values(View(Features(point_x=x, point_y=y)))


@pytest.mark.parametrize("kind", SETS)
def test_each_kind_brings_the_camera_to_its_goal(kind):
    names, goal = SETS[kind], tilted_pose(1)
    X = goal @ exponential([0.03, -0.02, -0.05, 0.08, -0.06, 0.5], 1.0)
    law = make_law("ibvs", [2.0] * len(names), LawSetup(names, "mean"))
    law.reset(Reference(FeatureSet(names).values(seen(goal)), view=seen(goal).features, plane_C=plane_of(goal)))
    for _ in range(300):
        X = X @ exponential(law.step(Look(seen(X), 1.0 / 30.0)).twist, 1.0 / 30.0)
    np.testing.assert_allclose(X, goal, atol=1e-6)  # exp(-2 * 10) of the first error, and slopes below 10


def test_two_vanishing_points_see_the_rotation_alone():
    names = [f"v{axis}{number}" for number in (1, 2) for axis in "xyz"]
    L = FeatureSet(names).matrix(seen(tilted_pose(1)))
    assert np.linalg.matrix_rank(L, tol=1e-9) == 3 and not L[:, :3].any()
