"""Laws sliding and broyden on exact pictures: wrong calibration, moving targets, learning, settings."""

from types import SimpleNamespace

import numpy as np
import pytest
from views import exponential, look_at, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, Features, FeatureSet, ParameterError, Reference, ServoSettings, View
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.laws.broyden import BroydenSettings
from aras_visual_servo.laws.sliding import _rate, SlidingSettings

DT_S = 1.0 / 30.0
ROUNDING = 1e-9
SQUARE = np.array([[-0.08, -0.07], [0.09, -0.08], [0.08, 0.08], [-0.08, 0.06]])
FOUR, MOMENTS = ("points4",), ("xn", "yn", "an", "sx", "sy", "alpha")
GOAL = tilted_pose(1)
START = GOAL @ exponential([0.06, -0.05, -0.08, 0.12, -0.1, 0.35], 1.0)


def scaled(features, focal):
    """What a camera reports whose focal length is believed to be 1 / focal of the true one."""
    copy = Features.from_object(features)
    copy.point_x, copy.point_y = (tuple(focal * np.array(p)) for p in (features.point_x, features.point_y))
    return copy


def start_law(name, names=FOUR, gain=2.0, focal=1.0, depth=1.0, settings=None):
    """Law at GOAL, with focal length and depth wrong by these factors. settings: its own, None: the defaults."""
    taught = scaled(view(GOAL, SQUARE).features, focal)
    taught.z_star_m *= depth
    features = FeatureSet(names)
    law = make_law(name, [gain] * len(features), LawSetup(tuple(names), settings={name: settings} if settings else {}))
    plane = plane_of(GOAL) * np.array([focal / focal**2, 1.0 / focal, 1.0]) / depth  # 1/Z of the wrong x, y
    law.reset(Reference(features.values(View(taught)), view=taught, plane_C=plane))
    return law


def drive(law, X=START, seconds=10.0, focal=1.0, depth=1.0, drift=(0.0,) * 6, lag=0.0):
    """Poses of the camera; the target moves by `drift` seen from the camera; joints follow with a time constant."""
    return drive_and_answer(law, X, seconds, focal, depth, drift, lag)[0]


def drive_and_answer(law, X=START, seconds=10.0, focal=1.0, depth=1.0, drift=(0.0,) * 6, lag=0.0):
    """(poses, last `Answer`), as `drive`."""
    path, speed, twist = [], np.zeros(6), None
    for _ in range(round(seconds / DT_S)):
        path.append(X)
        seen = scaled(view(X, SQUARE).features, focal)
        answer = law.step(look_at(seen, DT_S, plane_of(X) / depth, applied=twist))
        twist = answer.twist
        speed = twist + (speed - twist) * lag
        X = X @ exponential(speed + np.array(drift), DT_S)
    return np.array(path), answer


def distance(path, k=-1):
    return np.abs(path[k] - GOAL).max()


# --- sliding mode -----------------------------------------------------------------------------------------------------

SLIDING = {"settings": SlidingSettings(6.0, (0.02,) * 8)}


def test_twist_is_a_constant_rate_on_top_of_the_proportional_one_and_linear_inside_the_layer():
    law, plain = start_law("sliding", **SLIDING), start_law("ibvs")
    here = view(START, SQUARE).features
    answer, expected = law.step(look_at(here, 1e-9)), plain.step(look_at(here, 1e-9)).twist
    twist, e = answer.twist, np.array(answer.e)
    assert (np.abs(e) > 0.02).any() and (np.abs(e) < 0.02).any()
    L = np.linalg.pinv(FeatureSet(FOUR).matrix(view(GOAL, SQUARE, plane_of(GOAL))))
    np.testing.assert_allclose(twist - expected, -L @ (6.0 * np.clip(e, -0.02, 0.02)), atol=1e-6)  # expm1 of 1e-8


def test_layer_is_reached_in_the_time_the_reaching_law_says():
    """From |e| = E: t = 1/lambda ln((lambda E + kappa phi) / (lambda phi + kappa phi)). One point, seen head on."""
    gain, switching, phi, E = 1.0, 6.0, 0.02, 0.2
    e, t = E, 0.0
    law = start_law("sliding", settings=SlidingSettings(switching, (phi,) * 8), gain=gain)
    while e > phi:
        e -= 1e-3 * law._wanted([e] + [0.0] * 7, 1e-3)[0]
        t += 1e-3
    assert t == pytest.approx(np.log((gain * E + switching * phi) / (gain * phi + switching * phi)) / gain, rel=0.01)


def test_a_moving_target_leaves_a_share_of_what_the_proportional_law_leaves():
    drift = [0.01, 0.0, 0.0, 0.0, 0.0, 0.0]  # m/s: e_dot of 0.02 /s, inside (lambda + kappa) phi = 0.16
    left = [np.abs(drive_and_answer(law, drift=drift)[1].e).max()
            for law in (start_law("ibvs"), start_law("sliding", **SLIDING))]
    assert left[1] == pytest.approx(left[0] * 2.0 / (2.0 + 6.0), rel=0.15)  # sampled: (1 - exp(-8/30)) for 8/30


@pytest.mark.parametrize("focal, depth", [(1.3, 1.0), (0.7, 1.0), (1.0, 1.5), (1.0, 0.6), (1.3, 0.7)])
def test_sliding_arrives_with_focal_length_and_depth_wrong(focal, depth):
    law = start_law("sliding", focal=focal, depth=depth, **SLIDING)
    assert distance(drive(law, focal=focal, depth=depth)) < 1e-6


@pytest.mark.parametrize("e", [0.2, -0.05, 0.021, 0.02, -0.01, 0.0])
@pytest.mark.parametrize("switching, boundary", [(6.0, 0.02), (3000.0, 4e-5)])
def test_rate_held_for_a_period_leaves_what_the_reaching_law_leaves(e, switching, boundary):
    rate, left, steps = _rate(e, 2.0, switching, boundary, 0.1), e, 20000
    for _ in range(steps):
        left -= 0.1 / steps * (2.0 * left + switching * np.clip(left, -boundary, boundary))
    assert e - 0.1 * rate == pytest.approx(left, abs=2e-6)  # Euler: 8^2 / 2 * 5e-6 * 0.1 * 0.2


def test_a_thin_layer_does_not_chatter():
    law = start_law("sliding", settings=SlidingSettings(3000.0, (4e-5,) * 8))
    errors = np.array([FeatureSet(FOUR).values(view(X, SQUARE)) for X in drive(law, seconds=5.0)]) - law._s_star
    settled = np.where(np.abs(errors[60:]) > 1e-7, np.sign(errors[60:]), 0.0)
    assert (np.abs(np.diff(settled, axis=0)) < 2.0).all()


def test_sliding_needs_its_section():
    with pytest.raises(ParameterError, match="sliding: found nothing"):
        start_law("sliding")
    with pytest.raises(ParameterError, match=r"sliding\.boundary: found 2 numbers, allowed 8"):
        start_law("sliding", settings=SlidingSettings(1.0, (0.1, 0.1)))


# --- Broyden --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("initial", ["desired", "moves"])
@pytest.mark.parametrize("focal, depth", [(1.0, 1.0), (1.3, 1.3), (0.7, 0.7), (1.3, 0.7), (0.7, 1.3)])
def test_broyden_arrives_with_focal_length_and_depth_wrong_by_thirty_percent(initial, focal, depth):
    law = start_law("broyden", focal=focal, depth=depth, settings=BroydenSettings(initial, 0.95, 0.01))
    path = drive(law, focal=focal, depth=depth)
    assert distance(path) < 1e-5


def test_broyden_does_not_look_at_plane_or_pose():
    law = start_law("broyden")
    assert not law.needs_plane and not law.needs_pose
    twists = []
    for plane in (None, (9.0, 9.0, 9.0)):
        law = start_law("broyden")
        here, first = view(START, SQUARE).features, np.full(6, 0.01)
        twists.append([law.step(look_at(here, DT_S, plane, applied=applied)).twist for applied in (None, first)])
    np.testing.assert_array_equal(*twists)


def test_one_motion_leaves_the_share_unexplained_that_least_squares_say():
    """rho / (rho + h P h) of the error in the direction of the motion h, and all of it across."""
    forgetting, move = 0.9, 0.01
    law = start_law("broyden", depth=2.0, settings=BroydenSettings("desired", forgetting, move))
    before = law.L
    first = law.step(look_at(view(START, SQUARE).features, DT_S)).twist
    moved = view(START @ exponential(first, DT_S), SQUARE).features
    law.step(look_at(moved, DT_S, applied=first))
    there, here = (FeatureSet(FOUR).values(view(X, SQUARE)) for X in (START @ exponential(first, DT_S), START))
    change = np.array(there) - here
    units = np.array([moved.z_star_m * 2.0] * 3 + [1.0] * 3)
    h = first / units * DT_S
    share = forgetting / (forgetting + h @ h / move**2)
    assert share < 0.3
    np.testing.assert_allclose(change - law.L @ first * DT_S, share * (change - before @ first * DT_S), atol=ROUNDING)
    # What is known after it: what was, less what is forgotten, and the motion itself.
    np.testing.assert_allclose(np.linalg.inv(law._P), forgetting * move**2 * np.eye(6) + np.outer(h, h), rtol=1e-9,
                               atol=1e-12)
    across = np.array([h[1], -h[0], 0.0, 0.0, 0.0, 0.0]) * units
    np.testing.assert_allclose(law.L @ across, before @ across, atol=ROUNDING)


def test_test_moves_find_the_matrix_without_knowing_anything():
    law, X = start_law("broyden", settings=BroydenSettings("moves", 0.95, 0.01)), START
    moved, twist = [], None
    while law.L is None:
        twist = law.step(look_at(view(X, SQUARE).features, DT_S, applied=twist)).twist
        if law.L is None:
            moved.append(twist)
            X = X @ exponential(twist, DT_S)
    assert len(moved) == 6 * 7 and np.count_nonzero(moved) == 6 * 3
    true = FeatureSet(FOUR).matrix(view(X, SQUARE, plane_of(X)))
    np.testing.assert_allclose(law.L, true, atol=0.05 * np.abs(true).max())  # curvature over moves of 0.01


@pytest.mark.parametrize("names, columns", [(FOUR, (0, 1, 2, 3, 4, 5)), (("xn", "yn", "an", "alpha"), (0, 1, 2, 5))])
@pytest.mark.parametrize("move", [0.01, 0.03])
def test_test_moves_go_along_one_axis_after_the_other_by_their_size(names, columns, move):
    law, X, twist, path = start_law("broyden", names, settings=BroydenSettings("moves", 0.95, move)), START, None, []
    while law.L is None:
        twist = law.step(look_at(view(X, SQUARE).features, DT_S, applied=twist)).twist
        if law.L is None:
            path.append(twist * DT_S)
            X = X @ exponential(twist, DT_S)
    depth_m = view(GOAL, SQUARE).features.z_star_m
    moves = np.array(path).reshape(len(columns), -1, 6).sum(axis=1)
    wanted = np.zeros((len(columns), 6))
    for row, column in enumerate(columns):
        wanted[row, column] = move * (depth_m if column < 3 else 1.0)
    np.testing.assert_allclose(moves, wanted, atol=ROUNDING)


def test_joints_that_lag_spoil_neither_test_moves_nor_the_way_home():
    for initial in ("desired", "moves"):
        law = start_law("broyden", settings=BroydenSettings(initial, 0.95, 0.01))
        assert distance(drive(law, lag=0.4)) < 1e-4, initial


def test_four_features_learn_four_columns():
    names = ("xn", "yn", "an", "alpha")
    law, X, twist = start_law("broyden", names, depth=1.3), START, None
    for _ in range(200):
        answer = law.step(look_at(view(X, SQUARE).features, DT_S, applied=twist))
        twist = answer.twist
        assert twist[3] == twist[4] == 0.0
        X = X @ exponential(twist, DT_S)
    assert np.abs(answer.e).max() < 1e-4


def test_points_of_a_source_that_says_nothing_of_symmetry_are_learnt_the_same():
    """Those of keypoints and tags."""
    def first(seen):
        law = start_law("broyden")
        return [law.step(look_at(seen(X), DT_S, plane_of(X), applied=np.full(6, 0.01))).twist for X in (START, GOAL)]

    whole = first(lambda X: view(X, SQUARE).features)
    bare = first(lambda X: SimpleNamespace(**{name: getattr(view(X, SQUARE).features, name)
                                              for name in ("point_x", "point_y")}))
    np.testing.assert_array_equal(whole, bare)


def test_moments_can_be_learnt_as_well():
    law = start_law("broyden", MOMENTS)
    assert distance(drive(law, X=GOAL @ exponential([0.03, -0.02, 0.04, 0.03, 0.04, 0.1], 1.0))) < 1e-4


def test_nothing_is_learnt_over_a_stop_and_at_rest():
    law = start_law("broyden")
    law.step(look_at(view(START, SQUARE).features, DT_S))
    L = law.L.copy()
    law.step(look_at(view(GOAL, SQUARE).features, DT_S, applied=None))  # the servo stopped the arm
    np.testing.assert_array_equal(law.L, L)
    for _ in range(500):
        law.step(look_at(view(GOAL, SQUARE).features, DT_S, applied=np.zeros(6)))
    np.testing.assert_array_equal(law.L, L)
    assert np.trace(law._P) <= 6 / 0.01**2 * (1 + ROUNDING)


def test_features_that_did_not_move_are_no_matrix():
    law = start_law("broyden", settings=BroydenSettings("moves", 0.95, 0.01))
    twist = None
    with pytest.raises(DegenerateFeature, match="condition number"):
        for _ in range(60):  # the arm is held fast, and said to have moved
            twist = law.step(look_at(view(START, SQUARE).features, DT_S, applied=twist)).twist


# --- settings -------------------------------------------------------------------------------------------------------

SECTION = {"law": "broyden", "mode": "continuous", "features": ["points4"], "gains_per_s": {"points4": 2.0},
           "thresholds": {"points4": 0.001}, "time_limit_s": 10.0}


def test_sections_of_both_laws_are_read():
    config = ServoSettings.from_dict({**SECTION, "broyden": {"initial": "moves", "move": 0.02}})
    assert config.settings["broyden"] == BroydenSettings("moves", 0.95, 0.02)
    sliding = {"switching_per_s": 4.0, "boundary": {"points4": 0.01}}
    config = ServoSettings.from_dict({**SECTION, "law": "sliding", "sliding": sliding})
    assert config.settings["sliding"] == SlidingSettings(4.0, (0.01,) * 8)


@pytest.mark.parametrize("changes, text", [
    ({"broyden": {"forgetting": 1.5}}, "servo.broyden.forgetting: found 1.5"),
    ({"broyden": {"initial": "guess"}}, "servo.broyden.initial: found guess, .*desired, moves"),
    ({"broyden": {"speed": 1.0}}, "servo.broyden.speed: found"),
    ({"sliding": {"switching_per_s": 1.0}}, "servo.sliding.boundary"),
    ({"mode": "look_then_move"}, "mode: found look_then_move, .*continuous"),
    ({"law": "sliding"}, "sliding: found nothing")])
def test_faults_are_named(changes, text):
    with pytest.raises(ParameterError, match=text):
        ServoSettings.from_dict({**SECTION, **changes})


def test_an_override_to_a_law_that_cannot_look_then_move_is_refused():
    section = {**SECTION, "law": "ibvs", "mode": "look_then_move"}
    with pytest.raises(ParameterError, match="allowed with law 'broyden': continuous"):
        ServoSettings.from_dict(section).with_overrides(law="broyden")


@pytest.mark.parametrize("e", [0.2, -0.2, 0.01])
def test_the_rate_at_an_instant_is_that_of_the_reaching_law(e):
    assert _rate(e, 2.0, 6.0, 0.02, 0.0) == pytest.approx(2.0 * e + 6.0 * np.clip(e, -0.02, 0.02), abs=ROUNDING)


@pytest.mark.parametrize("dt_s", [0.0, -0.1])
def test_broyden_refuses_a_twist_that_is_held_for_no_time(dt_s):
    with pytest.raises(ParameterError, match=f"found dt_s {dt_s}, allowed > 0"):
        start_law("broyden").step(look_at(view(START, SQUARE).features, dt_s, plane_of(START)))
