"""Moments on the unit sphere, circles and spheres: rows against central differences, and what has no such features."""

import numpy as np
import pytest
import round_views as rounds
from views import assert_same, differences, exponential, parallel_pose, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, Features, FeatureSet, Look, Reference, source_named, View
from aras_visual_servo.laws.base import LawSetup, make_law

SEEDS = (1, 2, 3, 4)
QUADRILATERAL = np.array([[-0.09, -0.05], [0.09, -0.05], [0.09, 0.05], [-0.09, 0.05]])
MOMENTS, INVARIANTS = ("ug", "vg", "wg"), ("is", "is1", "is2", "is3", "is4")
CIRCLE, SPHERE = ("xe", "ye", "e20", "e11", "e02"), ("ox", "oy", "oz")
RADIUS_M, CENTRE = 0.07, (0.03, -0.02, 0.05)
ROUNDING = 1e-12
#: Moments of an ellipse from its conic: a few dozen operations on numbers of order 1, and n20 near 0.01.
CONIC = 1e-11


def seen(X):
    return view(X, QUADRILATERAL, plane_of(X))


def seen_by_rays(X):
    """The corners of a board, and more of it, seen from a camera within it: some corners lie behind the image plane."""
    corners = np.c_[8.0 * QUADRILATERAL, np.zeros(4), np.ones(4)] @ np.linalg.inv(X).T
    s = corners[:, :3] / np.linalg.norm(corners[:, :3], axis=1)[:, None]
    return View(Features(ray_x=s[:, 0].tolist(), ray_y=s[:, 1].tolist(), ray_z=s[:, 2].tolist()), plane_of(X))


def aslant(seed):
    """A camera low above the board that looks along it."""
    rng = np.random.default_rng(seed)
    X = tilted_pose(seed) @ exponential([0, 0, 0.45, *rng.uniform(0.5, 0.7, 2), 0], 1.0)
    assert (np.array(seen_by_rays(X).features.ray_z) < 0.0).any()
    return X


def circle_seen(X):
    return rounds.as_view(rounds.circle(X, RADIUS_M, CENTRE[:2]), plane_of(X))


def sphere_seen(X):
    ellipse, p = rounds.sphere(X, RADIUS_M, CENTRE)
    return rounds.as_view(ellipse, (0.0, 0.0, 1.0 / p[2]))


VIEWS = {**dict.fromkeys((*MOMENTS, *INVARIANTS), seen), **dict.fromkeys(CIRCLE, circle_seen),
         **dict.fromkeys(SPHERE, sphere_seen)}


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", VIEWS)
def test_row_is_the_derivative(name, seed):
    X, one, look = tilted_pose(seed), FeatureSet([name]), VIEWS[name]
    assert_same(one.matrix(look(X)), differences(lambda X: one.values(look(X)), X))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", ["us1", "vs2", "ws3", "ws4", *MOMENTS, *INVARIANTS, "vx1", "vy2", "vz1"])
def test_rows_by_rays_are_derivatives_also_behind_the_image_plane(name, seed):
    X, one = aslant(seed), FeatureSet([name])
    assert_same(one.matrix(seen_by_rays(X)), differences(lambda X: one.values(seen_by_rays(X)), X))


def test_rays_behind_the_image_plane_bring_the_camera_home():
    names, goal = tuple(f"{axis}s{n}" for n in (1, 2, 3, 4) for axis in "uvw"), aslant(2)
    law = make_law("ibvs", [2.0] * 12, LawSetup(names, "current"))
    law.reset(Reference(FeatureSet(names).values(seen_by_rays(goal)), view=seen_by_rays(goal).features,
                        plane_C=plane_of(goal)))
    X = goal @ exponential([0.02, -0.01, -0.02, 0.1, -0.2, 0.4], 1.0)
    for _ in range(400):
        X = X @ exponential(law.step(Look(seen_by_rays(X), 1.0 / 30.0)).twist, 1.0 / 30.0)
    np.testing.assert_allclose(X, goal, atol=1e-6)


def test_a_goal_without_moments_has_its_plane_through_the_middle_of_the_rays():
    source, view = source_named("moments"), Features(ray_x=(0.6, -0.6, 0.0, 0.8), ray_y=(0.0, 0.6, -1.0, 0.6))
    view.ray_z = (0.8, 0.53, -0.1, 0.0)
    taught = source.taught(view, 0.5, (0.0, 0.0, 1.0))
    middle = np.mean([view.ray_x, view.ray_y, view.ray_z], axis=1)
    assert taught.plane_C @ (0.5 * middle / middle[2]) == pytest.approx(1.0)
    kept = Reference(np.zeros(1), view=taught.view)
    assert Reference.from_dict(kept.to_dict()).view.ray_z == pytest.approx(view.ray_z)
    view.ray_z = [-z for z in view.ray_z]
    with pytest.raises(DegenerateFeature, match="not before the camera"):
        source.taught(view, 0.5, (0.0, 0.0, 1.0))


def test_invariants_do_not_change_in_a_turn_and_grow_with_the_distance():
    X, invariants = parallel_pose(), FeatureSet(INVARIANTS)
    here = np.array(invariants.values(seen(X)))
    turned = invariants.values(seen(X @ exponential([0, 0, 0, 0.3, -0.2, 1.0], 1.0)))
    np.testing.assert_allclose(turned, here, rtol=ROUNDING)
    assert not invariants.matrix(seen(X))[:, 3:].any()
    farther = np.array(invariants.values(seen(X @ exponential([0, 0, -0.6, 0, 0, 0], 1.0))))
    assert (farther > 1.8 * here).all() and (farther < 2.0 * here).all()  # small targets: in proportion


def test_the_invariant_is_that_of_the_moments_of_second_order():
    X = tilted_pose(3)
    rays = np.reshape(FeatureSet([f"{axis}s{n}" for n in (1, 2, 3, 4) for axis in "uvw"]).values(seen(X)), (4, 3))
    m200, m020, m002 = (rays**2).sum(axis=0)
    m110, m101, m011 = (rays[:, 0] * rays[:, 1]).sum(), (rays[:, 0] * rays[:, 2]).sum(), (rays[:, 1] * rays[:, 2]).sum()
    I = m200 * m020 + m200 * m002 + m020 * m002 - m110**2 - m101**2 - m011**2
    assert FeatureSet(["is"]).values(seen(X))[0] == pytest.approx(I**-0.5, rel=1e-9)  # 1 - cos^2 of 0.1 rad
    np.testing.assert_allclose(FeatureSet(MOMENTS).values(seen(X)), rays.mean(axis=0), atol=ROUNDING)


def test_invariants_without_a_point_hold_the_translation_over_a_centred_target():
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[2, 3] = 0.5
    assert np.linalg.cond(FeatureSet(INVARIANTS[1:]).matrix(seen(X))[:, :3]) < 100.0
    assert np.abs(FeatureSet(["is"]).matrix(seen(X))[0, :2]).max() < ROUNDING  # the whole: symmetric


def test_invariants_and_vanishing_points_bring_the_camera_home_and_a_pure_turn_stays_one():
    names = (*INVARIANTS[1:], *(f"v{axis}{number}" for number in (1, 2) for axis in "xyz"))
    goal = tilted_pose(1)
    law = make_law("ibvs", [2.0] * len(names), LawSetup(names, "current"))
    law.reset(Reference(FeatureSet(names).values(seen(goal)), view=seen(goal).features, plane_C=plane_of(goal)))
    turned = goal @ exponential([0, 0, 0, 0.2, -0.1, 1.5], 1.0)
    for _ in range(200):
        turned = turned @ exponential(law.step(Look(seen(turned), 1.0 / 30.0)).twist, 1.0 / 30.0)
        np.testing.assert_allclose(turned[:3, 3], goal[:3, 3], atol=1e-9)  # the invariants stay at their goal
    X = goal @ exponential([0.05, -0.04, -0.1, 0.2, -0.1, 1.0], 1.0)
    for _ in range(400):
        X = X @ exponential(law.step(Look(seen(X), 1.0 / 30.0)).twist, 1.0 / 30.0)
    np.testing.assert_allclose(X, goal, atol=1e-6)


def test_a_circle_has_the_rows_of_moments_of_any_object_but_needs_no_third_order():
    outline = 0.07 * np.array([[np.cos(t), np.sin(t)] for t in 2.0 * np.pi * np.arange(2000) / 2000]) + CENTRE[:2]
    X = tilted_pose(2)
    L = FeatureSet(("xg", "yg", "n20", "n11", "n02")).matrix(view(X, outline, plane_of(X)))
    np.testing.assert_allclose(FeatureSet(CIRCLE).matrix(circle_seen(X)), L, atol=1e-5)  # 2 pi^2 / (3 * 2000^2)
    assert "30" not in circle_seen(X).m


def test_a_sphere_is_seen_where_it_is():
    for X in map(tilted_pose, SEEDS):
        ellipse, p = rounds.sphere(X, RADIUS_M, CENTRE)
        np.testing.assert_allclose(FeatureSet(SPHERE).values(rounds.as_view(ellipse)), p / RADIUS_M, rtol=1e-9)


@pytest.mark.parametrize("names, look, free", [(CIRCLE, circle_seen, 1), (SPHERE, sphere_seen, 3)])
def test_circle_and_sphere_come_home_but_for_what_cannot_be_seen(names, look, free):
    goal = tilted_pose(1)
    goal_view, features = look(goal), FeatureSet(names)
    assert np.linalg.matrix_rank(features.matrix(goal_view), tol=1e-7) == 6 - free
    X = goal @ exponential([0.03, -0.02, -0.05, 0.05, -0.04, 0.3], 1.0)
    law = make_law("ibvs", [2.0] * len(names), LawSetup(names, "current"))
    law.reset(Reference(features.values(goal_view), view=goal_view.features, plane_C=np.array(goal_view.plane)))
    for _ in range(300):
        X = X @ exponential(law.step(Look(look(X), 1.0 / 30.0)).twist, 1.0 / 30.0)
    np.testing.assert_allclose(features.values(look(X)), features.values(goal_view), atol=1e-6)


ASLANT = parallel_pose() @ exponential([0.4, 0, 0, 0, 0, 0], 1.0)
SQUARE = 0.2 * np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


@pytest.mark.parametrize("name, here, text", [
    ("xe", view(parallel_pose(), SQUARE), "the object is no circle or sphere"),
    ("ox", rounds.as_view(rounds.circle(ASLANT, 0.1)), "the object is no sphere"),
    ("xe", View(Features(moment_names=("00", "10", "01", "20", "11", "02"), m=[0.0] * 6, mu=[0.0] * 6)), "area.* 0"),
    ("is", View(Features(point_x=(0.1, 0.1), point_y=(0.2, 0.2))), "seen in one direction"),
    ("is1", View(Features(point_x=(0.1, 0.3), point_y=(0.2, 0.2))), "found 2 points .*at least 3"),
    ("is5", seen(tilted_pose(1)), "found 4 points .*at least 5")])
def test_what_does_not_exist_in_a_view_is_told(name, here, text):
    with pytest.raises(DegenerateFeature, match=text):
        FeatureSet([name]).values(here)
