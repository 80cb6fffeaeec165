"""Control laws: formulas, exact sampled decay, registry, checks."""

from types import SimpleNamespace

import numpy as np
import pytest
from views import look_at, parallel

from aras_visual_servo.ground.errors import NotFiniteError, ParameterError, ShapeError
from aras_visual_servo.features.base import wrapped
from aras_visual_servo.laws.base import Law, LawSetup, known_laws, make_law, register_law

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


def test_paper_law_couples_features_when_gains_differ():
    dt_s = 0.01
    s = moved(S, law_of("paper").step(look_at(features(S), dt_s)).twist, dt_s)
    slower = np.abs((s - S_STAR) / (S - S_STAR) - np.exp(-np.array(GAINS) * dt_s))
    assert slower[:2].max() > 1e-3  # y e_alpha (lambda_x - lambda_alpha) dt is of this order


def test_alpha_error_takes_the_short_way_round():
    law = law_of("paper", s_star=[0, 0, 0.5, 3.1])
    answer = law.step(look_at(features([0, 0, 0.5, -3.1]), 0.01))
    assert answer.e[3] == pytest.approx(2 * np.pi - 6.2, abs=ROUNDING)


def test_a_target_declared_symmetric_is_so_whatever_the_view_seems_to_tell():
    for symmetric, expected in ((False, 3.0), (True, 3.0 - np.pi)):
        law = make_law("decoupled", GAINS, LawSetup(symmetric_target=symmetric))
        law.reset([0.0, 0.0, 0.5, -1.4])
        answer = law.step(look_at(features([0.0, 0.0, 0.5, 1.6]), 0.01))
        assert answer.e[3] == pytest.approx(expected, abs=ROUNDING)


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


def test_the_answer_depends_on_nothing_but_the_reference_and_the_looks():
    """What is kept between steps is the law's own: another one that was given the same looks says the same."""
    looks = [look_at(features(S + 0.1 * k), 0.01 * (1 + k)) for k in range(3)]
    for name in ("paper", "decoupled"):
        one, other = law_of(name), law_of(name)
        answers = [one.step(look) for look in looks]
        for answer, look in zip(answers, looks):
            np.testing.assert_array_equal(other.step(look).twist, answer.twist)
        assert vars(one).keys() == vars(law_of(name)).keys()


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
