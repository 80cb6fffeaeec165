"""Points, segments and the ellipse: rows against central differences at tilted poses, depths, what is not there."""

import numpy as np
import pytest
from views import assert_same, differences, look_at, plane_of, tilted_pose, view

from aras_visual_servo import (
    DegenerateFeature, expand, Features, FeatureSet, known_features, ParameterError, Reference, ServoSettings, View)
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


def law_of(point_depth, interaction="current"):
    law = make_law("ibvs", [2.0] * 8, LawSetup(("points4",), interaction, point_depth=point_depth))
    four = view(GOAL, OUTLINE4)
    law.reset(Reference(FeatureSet(EIGHT).values(four), view=four.features, plane_C=plane_of(GOAL)))
    return law


OUTLINE4 = np.array([[-0.09, -0.045], [0.10, -0.03], [0.06, 0.03], [-0.07, 0.04]])


@pytest.mark.parametrize("point_depth", ["plane", "goal"])
def test_law_takes_the_depth_it_is_told(point_depth):
    law, here = law_of(point_depth), view(HERE, OUTLINE4)
    answer = law.step(look_at(here.features, 0.0, plane_of(HERE)))
    seen = view(HERE if point_depth == "plane" else GOAL, OUTLINE4).features
    plane = plane_of(HERE if point_depth == "plane" else GOAL)
    over_Z = [float(plane @ [x, y, 1.0]) for x, y in zip(seen.point_x, seen.point_y)]
    rows = []
    for x, y, d in zip(here.features.point_x, here.features.point_y, over_Z):
        rows += [[-d, 0.0, x * d, x * y, -1.0 - x * x, y], [0.0, -d, y * d, 1.0 + y * y, -x * y, -x]]
    np.testing.assert_allclose(answer.twist, -2.0 * np.linalg.pinv(rows) @ answer.e, atol=1e-9)  # condition: 100


def test_number_of_points_that_changes_is_refused():
    law, here = law_of("goal"), view(HERE)  # five corners
    with pytest.raises(DegenerateFeature, match="found 5 in this view, 4 at the goal"):
        law.step(look_at(here.features, 0.0, plane_of(HERE)))


def test_depth_at_the_goal_needs_the_goal():
    with pytest.raises(ParameterError, match="teach the goal again"):
        make_law("ibvs", [2.0] * 8, LawSetup(("points4",), "current", point_depth="goal")).reset([0.0] * 8)
    with pytest.raises(ParameterError, match="point_depth: found near, .*plane, goal"):
        make_law("ibvs", [2.0] * 8, LawSetup(("points4",), point_depth="near"))


def test_reference_keeps_its_points_through_a_round_trip():
    goal = view(GOAL)
    again = Reference.from_dict(Reference(np.zeros(2), view=goal.features, plane_C=plane_of(GOAL)).to_dict())
    np.testing.assert_array_equal(again.view.point_x, goal.features.point_x)
    np.testing.assert_array_equal(again.view.point_y, goal.features.point_y)
    bad = Reference(np.zeros(2), view=goal.features).to_dict()
    bad["view"]["point_y"] = bad["view"]["point_y"][:-1]
    with pytest.raises(ParameterError, match="reference/point_y: .*allowed 5"):
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
