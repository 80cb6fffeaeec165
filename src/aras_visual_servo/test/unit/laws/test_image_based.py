"""Law ibvs on exact pictures: formula, which matrix, the plane through the kinematics; adaptive gain, smooth start."""

import numpy as np
import pytest
from views import exponential, look_at, plane_of, SIX, tilted_pose, view

from aras_visual_servo import DegenerateFeature, FeatureSet, ParameterError, Reference, View
from aras_visual_servo.laws.base import adaptive_factor, LawSetup, make_law
from aras_visual_servo.laws.setup import AdaptiveGainSettings

GAINS = (3.0, 2.0, 4.0, 1.5, 2.5, 1.0)
ROUNDING = 1e-9  # of a 6 x 6 system of condition 100
GOAL, HERE = tilted_pose(1), tilted_pose(1) @ exponential([0.02, -0.03, 0.05, 0.04, -0.06, 0.1], 1.0)
DT_S = 1.0 / 30.0


def law_of(interaction, gains=GAINS, names=SIX, **more):
    law = make_law("ibvs", gains, LawSetup(names, interaction, **more))
    goal = view(GOAL)
    law.reset(Reference(FeatureSet(names).values(goal), view=goal.features, plane_C=plane_of(GOAL)))
    return law


def matrix(X):
    return FeatureSet(SIX).matrix(view(X, plane=plane_of(X)))


@pytest.mark.parametrize("interaction, L", [
    ("desired", matrix(GOAL)), ("current", matrix(HERE)), ("mean", 0.5 * (matrix(GOAL) + matrix(HERE)))])
def test_twist_is_minus_inverse_times_gain_times_error(interaction, L):
    law, here = law_of(interaction), view(HERE)
    e = FeatureSet(SIX).error(FeatureSet(SIX).values(here), FeatureSet(SIX).values(view(GOAL)), False)
    answer = law.step(look_at(here.features, 0.0, plane_of(HERE)))
    np.testing.assert_allclose(answer.twist, -np.linalg.solve(L, np.array(GAINS) * e), atol=ROUNDING)
    assert answer.condition == pytest.approx(np.linalg.cond(L), rel=ROUNDING)
    assert law.needs_plane == (interaction != "desired")


@pytest.mark.parametrize("interaction", ["desired", "current", "mean"])
def test_the_true_pose_is_reached_from_six_degrees_of_freedom_away(interaction):
    law, X = law_of(interaction, gains=[2.0] * 6), HERE
    for _ in range(400):
        X = X @ exponential(law.step(look_at(view(X).features, DT_S, plane_of(X))).twist, DT_S)
    np.testing.assert_allclose(X, GOAL, atol=1e-7)  # exp(-2 * 13.3) of the first error, twist and slopes below 10


def test_a_wrong_sign_does_not_arrive():
    law, X = law_of("desired", gains=[2.0] * 6), HERE
    for _ in range(30):
        X = X @ exponential(-law.step(look_at(view(X).features, DT_S)).twist, DT_S)
    assert np.abs(X - GOAL).max() > np.abs(HERE - GOAL).max()


def test_four_features_leave_tilt_alone_and_the_gain_is_exact_for_the_time_the_twist_is_held():
    names, gains = ("xn", "yn", "an", "alpha"), (3.0, 2.0, 4.0, 1.5)
    law, here = law_of("current", gains, names), view(HERE)
    dt_s = 0.1
    twist, _, e, *_ = law.step(look_at(here.features, dt_s, plane_of(HERE)))
    L = FeatureSet(names).matrix(View(here.features, plane_of(HERE)))
    sampled = (1.0 - np.exp(-np.array(gains) * dt_s)) / dt_s
    seen = [0, 1, 2, 5]
    np.testing.assert_allclose(twist[seen], -np.linalg.solve(L[:, seen], sampled * e), atol=ROUNDING)
    assert twist[3] == twist[4] == 0.0


def test_a_singular_matrix_is_refused_not_inverted():
    rectangle = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0.0, 0.0, -0.6, 0.0, 0.0, 0.4], 1.0)
    names = ("xn", "yn", "an", "px", "py", "alpha")
    goal = view(X, rectangle)
    law = make_law("ibvs", GAINS, LawSetup(names))
    with pytest.raises(DegenerateFeature, match="condition number"):
        law.reset(Reference(FeatureSet(names).values(goal), view=goal.features, plane_C=plane_of(X)))


def test_a_reference_without_its_view_is_refused():
    with pytest.raises(ParameterError, match="teach the goal again"):
        make_law("ibvs", GAINS, LawSetup(SIX)).reset([0.0] * 6)


@pytest.mark.parametrize("name", ["paper", "decoupled"])
def test_laws_made_for_four_features_refuse_others_by_name(name):
    with pytest.raises(ParameterError, match=f"allowed with law '{name}': xn, yn, an, alpha"):
        make_law(name, GAINS, LawSetup(SIX))


def test_unknown_interaction_lists_the_known_ones():
    with pytest.raises(ParameterError, match="interaction: found goal, .*desired, current, mean"):
        make_law("ibvs", GAINS, LawSetup(SIX, "goal"))


def test_reference_with_its_view_survives_a_round_trip():
    goal = view(GOAL)
    reference = Reference(np.arange(6.0), view=goal.features, plane_C=plane_of(GOAL))
    again = Reference.from_dict(reference.to_dict())
    np.testing.assert_array_equal(again.plane_C, reference.plane_C)
    L = [FeatureSet(SIX).matrix(View(r.view, r.plane_C)) for r in (reference, again)]
    np.testing.assert_array_equal(L[0], L[1])
    broken = reference.to_dict()
    broken["view"] = {"m": [1.0]}
    with pytest.raises(ParameterError, match="reference/view"):
        Reference.from_dict(broken)


# --- adaptive gain --------------------------------------------------------------------------------------------------


def test_adaptive_factor_is_one_at_zero_with_the_slope_asked_for_and_the_part_far_away():
    part, slope, h = 0.2, 8.0, 1e-6
    assert adaptive_factor(0.0, part, slope) == pytest.approx(1.0)
    assert (adaptive_factor(h, part, slope) - 1.0) / h == pytest.approx(-slope, rel=1e-4)  # h times the curvature
    assert adaptive_factor(10.0, part, slope) == pytest.approx(part)


def test_adaptive_gain_scales_the_twist_of_any_law_by_its_factor():
    here = view(HERE).features
    plain, adaptive = law_of("desired"), law_of("desired", adaptive_gain=AdaptiveGainSettings(0.2, 8.0))
    twist, _, e, *_ = plain.step(look_at(here, 0.0))
    factor = adaptive_factor(max(map(abs, e)), 0.2, 8.0)
    assert factor < 0.9
    for _ in range(2):  # not factor squared the second time
        np.testing.assert_allclose(adaptive.step(look_at(here, 0.0)).twist, factor * twist, atol=ROUNDING)
