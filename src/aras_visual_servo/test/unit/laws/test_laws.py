"""Control laws by name, and those on features in the image, on exact pictures."""

from types import SimpleNamespace

import numpy as np
import pytest
from views import exponential, look_at, parallel, plane_of, SIX, tilted_pose, view

from aras_visual_servo import (
    DegenerateFeature, FeatureSet, known_laws, Law, NotFiniteError, ParameterError, Reference, register_law,
    ShapeError, View)
from aras_visual_servo.features.base import wrapped
from aras_visual_servo.laws.base import adaptive_factor, LawSetup, make_law
from aras_visual_servo.laws.setup import AdaptiveGainSettings

GAINS = (3.0, 2.0, 4.0, 1.5)
S_STAR = np.array([0.01, -0.02, 0.59, 0.3])
S = np.array([0.12, -0.09, 0.66, -0.4])
ROUNDING = 1e-12  # of some ten operations on numbers near 1


def features(s, symmetric=False):
    return SimpleNamespace(xn=s[0], yn=s[1], an=s[2], alpha=s[3], symmetric=symmetric)


def law_of(name, gains=GAINS, s_star=S_STAR):
    law = make_law(name, gains)
    law.reset(s_star)
    return law


def four(twist):
    assert twist[3] == 0.0 and twist[4] == 0.0
    return twist[[0, 1, 2, 5]]


def moved(s, twist, dt_s, steps=2000):
    """Features of a parallel plane after a twist held for dt_s: Runge-Kutta of ds = L(s) v, L exact at any depth."""
    h = dt_s / steps
    v = four(twist)

    def rate(s):
        return parallel(s[0], s[1]) @ v

    for _ in range(steps):
        a = rate(s)
        b = rate(s + 0.5 * h * a)
        c = rate(s + 0.5 * h * b)
        s = s + h / 6.0 * (a + 2 * b + 2 * c + rate(s + h * c))
    return s


def test_paper_law_is_gain_times_inverse_times_error():
    expected = -np.diag(GAINS) @ np.linalg.inv(parallel(S[0], S[1])) @ (S - S_STAR)
    np.testing.assert_allclose(four(law_of("paper").step(look_at(features(S), 1 / 30)).twist), expected, atol=ROUNDING)


def test_decoupled_law_is_inverse_times_gain_times_error():
    expected = -np.linalg.inv(parallel(S[0], S[1])) @ np.diag(GAINS) @ (S - S_STAR)
    np.testing.assert_allclose(four(law_of("decoupled").step(look_at(features(S), 0.0)).twist), expected, atol=ROUNDING)


@pytest.mark.parametrize("dt_s", [0.01, 1 / 30, 0.2])
def test_decoupled_error_decays_exactly_exponentially_when_the_twist_is_held(dt_s):
    s = moved(S, law_of("decoupled").step(look_at(features(S), dt_s)).twist, dt_s)
    np.testing.assert_allclose(s - S_STAR, np.exp(-np.array(GAINS) * dt_s) * (S - S_STAR), atol=ROUNDING)


def test_alpha_error_takes_the_short_way_round():
    law = law_of("paper", s_star=[0, 0, 0.5, 3.1])
    answer = law.step(look_at(features([0, 0, 0.5, -3.1]), 0.01))
    assert answer.e[3] == pytest.approx(2 * np.pi - 6.2, abs=ROUNDING)


def test_a_target_declared_symmetric_is_so_whatever_the_view_seems_to_tell():
    untold = features([0.0, 0.0, 0.5, 1.6])
    del untold.symmetric
    for symmetric, expected in ((False, 3.0), (True, 3.0 - np.pi)):
        law = make_law("decoupled", GAINS, LawSetup(symmetric_target=symmetric))
        law.reset([0.0, 0.0, 0.5, -1.4])
        for seen in (features([0.0, 0.0, 0.5, 1.6]), untold):
            assert law.step(look_at(seen, 0.01)).e[3] == pytest.approx(expected, abs=ROUNDING)


def test_symmetric_object_takes_the_short_way_modulo_pi():
    law = law_of("paper", s_star=[0, 0, 0.5, 1.5])
    answer = law.step(look_at(features([0, 0, 0.5, -1.5], symmetric=True), 0.01))
    assert answer.e[3] == pytest.approx(np.pi - 3.0, abs=ROUNDING)


def test_wrapped_is_the_identity_for_small_angles():
    for angle in (-1.5, -0.1, 0.0, 1.5):
        assert wrapped(angle, symmetric=True) == pytest.approx(angle, abs=ROUNDING)


def test_unknown_law_lists_the_known_ones():
    with pytest.raises(ParameterError, match="decupled.*paper.*did you mean decoupled?"):
        make_law("decupled", GAINS)


@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
def test_gain_must_be_positive_and_finite(bad):
    with pytest.raises(ParameterError, match="gains_per_s.an: found"):
        make_law("paper", [1.0, 1.0, bad, 1.0])


def test_gains_must_be_one_per_feature():
    with pytest.raises(ParameterError, match="found 3"):
        make_law("paper", [1.0, 1.0, 1.0])


@pytest.mark.parametrize("name", ["paper", "decoupled"])
@pytest.mark.parametrize("index", range(4))
def test_law_rejects_nan_feature(name, index):
    s = S.copy()
    s[index] = np.nan
    with pytest.raises(NotFiniteError):
        law_of(name).step(look_at(features(s), 0.01))


def test_a_law_answers_with_values_that_the_next_look_does_not_change():
    law = law_of("decoupled")
    look = look_at(features(S), 0.01)
    first = law.step(look)
    kept = (first.twist.copy(), first.s, first.e, first.condition, first.settled, first.pose, first.gains_per_s)
    law.step(look_at(features(S_STAR), 0.02))
    assert (first.twist == kept[0]).all() and first[1:] == kept[1:]
    assert first.s == tuple(S) and first.settled
    assert first.condition == pytest.approx(np.linalg.cond(parallel(S[0], S[1])), rel=1e-9)
    with pytest.raises(AttributeError):
        look.applied = np.zeros(6)


def test_law_rejects_bad_reference():
    with pytest.raises(ShapeError):
        make_law("paper", GAINS).reset([0.0, 0.0, 0.5])
    with pytest.raises(NotFiniteError):
        make_law("paper", GAINS).reset([0.0, np.nan, 0.5, 0.0])


def test_a_registered_law_is_found_by_its_name():
    @register_law("dummy")
    class Dummy(Law):
        def _twist(self, look, s, e):
            return np.array([0.0, 0.0, self.gains_per_s[2] * e[2], 0.0, 0.0, 0.0])

    try:
        assert "dummy" in known_laws()
        twist = law_of("dummy").step(look_at(features(S), 0.1)).twist
        assert twist[2] == pytest.approx(GAINS[2] * (S[2] - S_STAR[2]), abs=ROUNDING)
    finally:
        from aras_visual_servo.laws import base as laws

        del laws.LAWS["dummy"]


@pytest.mark.parametrize("name, features", [("pbvs", ("tx", "ty", "tz", "rx", "ry", "rz")),
                                            ("hybrid", ("xr", "yr", "zr", "rx", "ry", "rz"))])
def test_a_law_that_follows_the_pose_says_which_target_it_needs(name, features):
    square = ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))

    def made(pose_from, outlines_m=None):
        target = None if outlines_m is None else SimpleNamespace(outlines_m=outlines_m)
        return make_law(name, [1.0] * 6, LawSetup(features, pose_from=pose_from, target=target))

    with pytest.raises(ParameterError, match=f"target_model: found nothing, law '{name}' needs"):
        made("moments")
    with pytest.raises(ParameterError, match="found 2 outlines, allowed one"):
        made("points", [square, square])
    for allowed in (("moments", [square, square]), ("points", [square]), ("points", None)):
        assert made(*allowed).needs_pose


IMAGE_GAINS = (3.0, 2.0, 4.0, 1.5, 2.5, 1.0)
IMAGE_ROUNDING = 1e-9  # of a 6 x 6 system of condition 100
GOAL, HERE = tilted_pose(1), tilted_pose(1) @ exponential([0.02, -0.03, 0.05, 0.04, -0.06, 0.1], 1.0)
DT_S = 1.0 / 30.0


def image_law(interaction, gains=IMAGE_GAINS, names=SIX, **more):
    law = make_law("ibvs", gains, LawSetup(names, interaction, **more))
    goal = view(GOAL)
    law.reset(Reference(FeatureSet(names).values(goal), view=goal.features, plane_C=plane_of(GOAL)))
    return law


def matrix(X):
    return FeatureSet(SIX).matrix(view(X, plane=plane_of(X)))


@pytest.mark.parametrize("interaction, L", [
    ("desired", matrix(GOAL)), ("current", matrix(HERE)), ("mean", 0.5 * (matrix(GOAL) + matrix(HERE)))])
def test_twist_is_minus_inverse_times_gain_times_error(interaction, L):
    law, here = image_law(interaction), view(HERE)
    e = FeatureSet(SIX).error(FeatureSet(SIX).values(here), FeatureSet(SIX).values(view(GOAL)), False)
    answer = law.step(look_at(here.features, 0.0, plane_of(HERE)))
    np.testing.assert_allclose(answer.twist, -np.linalg.solve(L, np.array(IMAGE_GAINS) * e), atol=IMAGE_ROUNDING)
    assert answer.condition == pytest.approx(np.linalg.cond(L), rel=IMAGE_ROUNDING)
    assert law.needs_plane == (interaction != "desired")


@pytest.mark.parametrize("interaction", ["desired", "current", "mean"])
def test_the_true_pose_is_reached_from_six_degrees_of_freedom_away(interaction):
    law, X = image_law(interaction, gains=[2.0] * 6), HERE
    for _ in range(400):
        X = X @ exponential(law.step(look_at(view(X).features, DT_S, plane_of(X))).twist, DT_S)
    np.testing.assert_allclose(X, GOAL, atol=1e-7)  # exp(-2 * 13.3) of the first error, twist and slopes below 10


def test_four_features_leave_tilt_alone_and_the_gain_is_exact_for_the_time_the_twist_is_held():
    names, gains = ("xn", "yn", "an", "alpha"), (3.0, 2.0, 4.0, 1.5)
    law, here = image_law("current", gains, names), view(HERE)
    dt_s = 0.1
    twist, _, e, *_ = law.step(look_at(here.features, dt_s, plane_of(HERE)))
    L = FeatureSet(names).matrix(View(here.features, plane_of(HERE)))
    sampled = (1.0 - np.exp(-np.array(gains) * dt_s)) / dt_s
    seen = [0, 1, 2, 5]
    np.testing.assert_allclose(twist[seen], -np.linalg.solve(L[:, seen], sampled * e), atol=IMAGE_ROUNDING)
    assert twist[3] == twist[4] == 0.0


def test_a_singular_matrix_is_refused_not_inverted():
    rectangle = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])
    X = np.diag([1.0, -1.0, -1.0, 1.0]) @ exponential([0.0, 0.0, -0.6, 0.0, 0.0, 0.4], 1.0)
    names = ("xn", "yn", "an", "px", "py", "alpha")
    goal = view(X, rectangle)
    law = make_law("ibvs", IMAGE_GAINS, LawSetup(names))
    with pytest.raises(DegenerateFeature, match="condition number"):
        law.reset(Reference(FeatureSet(names).values(goal), view=goal.features, plane_C=plane_of(X)))


def test_a_reference_without_its_view_is_refused():
    with pytest.raises(ParameterError, match="teach the goal again"):
        make_law("ibvs", IMAGE_GAINS, LawSetup(SIX)).reset([0.0] * 6)


@pytest.mark.parametrize("name", ["paper", "decoupled"])
def test_laws_made_for_four_features_refuse_others_by_name(name):
    with pytest.raises(ParameterError, match=f"allowed with law '{name}': xn, yn, an, alpha"):
        make_law(name, IMAGE_GAINS, LawSetup(SIX))


def test_unknown_interaction_lists_the_known_ones():
    with pytest.raises(ParameterError, match="interaction: found goal, .*desired, current, mean"):
        make_law("ibvs", IMAGE_GAINS, LawSetup(SIX, "goal"))


def test_reference_with_its_view_survives_a_round_trip():
    goal = view(GOAL)
    reference = Reference(np.arange(6.0), view=goal.features, plane_C=plane_of(GOAL))
    again = Reference.from_dict(reference.to_dict())
    np.testing.assert_array_equal(again.plane_C, reference.plane_C)
    L = [FeatureSet(SIX).matrix(View(r.view, r.plane_C)) for r in (reference, again)]
    np.testing.assert_array_equal(L[0], L[1])
    broken = reference.to_dict()
    broken["view"] = {"m": [1.0]}
    with pytest.raises(ParameterError, match="reference.view"):
        Reference.from_dict(broken)


# --- the depth of each point ------------------------------------------------------------------------------------------


OUTLINE4 = np.array([[-0.09, -0.045], [0.10, -0.03], [0.06, 0.03], [-0.07, 0.04]])


@pytest.mark.parametrize("point_depth", ["plane", "goal"])
def test_law_takes_the_depth_it_is_told(point_depth):
    goal, here = view(GOAL, OUTLINE4), view(HERE, OUTLINE4)
    law = make_law("ibvs", [2.0] * 8, LawSetup(("points4",), "current", point_depth=point_depth))
    law.reset(Reference(FeatureSet(["points4"]).values(goal), view=goal.features, plane_C=plane_of(GOAL)))
    answer = law.step(look_at(here.features, 0.0, plane_of(HERE)))
    seen, plane = (here, plane_of(HERE)) if point_depth == "plane" else (goal, plane_of(GOAL))
    over_Z = [float(plane @ [x, y, 1.0]) for x, y in zip(seen.features.point_x, seen.features.point_y)]
    rows = []
    for x, y, d in zip(here.features.point_x, here.features.point_y, over_Z):
        rows += [[-d, 0.0, x * d, x * y, -1.0 - x * x, y], [0.0, -d, y * d, 1.0 + y * y, -x * y, -x]]
    np.testing.assert_allclose(answer.twist, -2.0 * np.linalg.pinv(rows) @ answer.e, atol=1e-9)  # condition: 100


def test_depth_at_the_goal_needs_the_goal():
    with pytest.raises(ParameterError, match="teach the goal again"):
        make_law("ibvs", [2.0] * 8, LawSetup(("points4",), "current", point_depth="goal")).reset([0.0] * 8)
    with pytest.raises(ParameterError, match="point_depth: found near, .*plane, goal"):
        make_law("ibvs", [2.0] * 8, LawSetup(("points4",), point_depth="near"))


# --- adaptive gain --------------------------------------------------------------------------------------------------


def test_adaptive_factor_is_one_at_zero_with_the_slope_asked_for_and_the_part_far_away():
    part, slope, h = 0.2, 8.0, 1e-6
    assert adaptive_factor(0.0, part, slope) == pytest.approx(1.0)
    assert (adaptive_factor(h, part, slope) - 1.0) / h == pytest.approx(-slope, rel=1e-4)  # h times the curvature
    assert adaptive_factor(10.0, part, slope) == pytest.approx(part)


def test_adaptive_gain_scales_the_twist_of_any_law_by_its_factor():
    here = view(HERE).features
    plain, adaptive = image_law("desired"), image_law("desired", adaptive_gain=AdaptiveGainSettings(0.2, 8.0))
    twist, _, e, *_ = plain.step(look_at(here, 0.0))
    factor = adaptive_factor(max(map(abs, e)), 0.2, 8.0)
    assert factor < 0.9
    for _ in range(2):  # not factor squared the second time
        np.testing.assert_allclose(adaptive.step(look_at(here, 0.0)).twist, factor * twist, atol=IMAGE_ROUNDING)
