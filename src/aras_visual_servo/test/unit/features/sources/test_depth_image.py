"""Points with depths of the depth image: laws on points out of any plane, the pose by absolute orientation, holes."""

import numpy as np
import pytest
from views import exponential, plane_of, tilted_pose

from aras_visual_servo.features.sources.base import source_named
from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.features.target.solid_points import SolidPoints
from aras_visual_servo.ground.errors import DegenerateFeature
from aras_visual_servo.spatial import inverse
from aras_visual_servo.ground.types import Features, Reference, Status
from aras_visual_servo.laws.base import LawSetup, make_law
from aras_visual_servo.laws.look import Look
from aras_visual_servo.runs.loop import ServoLoop
from aras_visual_servo.scenario.scenario import load_scenario

POINTS = np.array([[-0.1, -0.08, 0.0], [0.1, -0.06, 0.12], [0.08, 0.09, 0.05], [-0.07, 0.05, 0.2]])
POSE = ("tx", "ty", "tz", "rx", "ry", "rz")
NAN = float("nan")
#: Twelve digits of a product of two poses.
ROUNDING = 1e-12


def seen(X_WC, **more):
    P = inverse(X_WC) @ np.c_[POINTS, np.ones(4)].T
    view = Features(target_visible=True, valid=True, z_star_m=0.6, **more)
    view.point_x, view.point_y = tuple(P[0] / P[2]), tuple(P[1] / P[2])
    view.point_z = view.point_z or tuple(P[2])
    view.xg, view.yg = float(np.mean(view.point_x)), float(np.mean(view.point_y))
    return view


def law_of(name, features, goal, **setup):
    names = FeatureSet(features).names
    law = make_law(name, [2.0] * len(names), LawSetup(tuple(features), **setup))
    s_star = FeatureSet(features).values(View(goal))
    law.reset(Reference(s_star, view=goal, plane_C=plane_of(tilted_pose(7))))  # the plane is wrong: nobody may use it
    return law


@pytest.mark.parametrize("interaction", ["desired", "current", "mean"])
def test_points_out_of_a_plane_come_home_with_their_own_depths(interaction):
    goal = tilted_pose(1)
    X = goal @ exponential([0.03, -0.02, -0.05, 0.08, -0.06, 0.3], 1.0)
    law = law_of("ibvs", ("points4",), seen(goal), interaction=interaction, point_depth="image")
    first = law.step(Look(View(seen(X), (9.0, 9.0, 9.0)), 0.0))
    if interaction == "current":  # L of the points where they are
        Z = np.array(seen(X).point_z)
        L = law.features.matrix(View(seen(X), None, None, 1.0 / Z))
        np.testing.assert_allclose(L @ first.twist, -2.0 * (L @ np.linalg.pinv(L)) @ first.e, atol=1e-9)
    for _ in range(300):
        X = X @ exponential(law.step(Look(View(seen(X), (9.0, 9.0, 9.0)), 1.0 / 30.0)).twist, 1.0 / 30.0)
    np.testing.assert_allclose(X, goal, atol=1e-6)


@pytest.mark.parametrize("name, features", [("pbvs", POSE), ("hybrid", ("xr", "yr", "zr", "rx", "ry", "rz"))])
def test_the_pose_of_points_in_space_brings_the_camera_home_whatever_the_joints_say(name, features):
    goal = tilted_pose(2)
    X = goal @ exponential([0.1, -0.05, -0.1, 0.3, -0.2, 2.5], 1.0)
    law = law_of(name, features, seen(goal), pose_from="depth")
    if name == "pbvs":
        answer = law.step(Look(View(seen(X)), 0.0, np.eye(4)))
        np.testing.assert_allclose(answer.s[:3], (inverse(goal) @ X)[:3, 3], atol=ROUNDING)
    for _ in range(300):
        X = X @ exponential(law.step(Look(View(seen(X)), 1.0 / 30.0, np.eye(4))).twist, 1.0 / 30.0)
    np.testing.assert_allclose(X, goal, atol=1e-6)


def test_absolute_orientation_is_that_of_least_squares_and_no_mirror_image():
    X = tilted_pose(3)
    here = (inverse(X) @ np.c_[POINTS, np.ones(4)].T)[:3].T
    np.testing.assert_allclose(SolidPoints(POINTS).find(here), inverse(X), atol=ROUNDING)
    flat = POINTS * [1.0, 1.0, 0.0]
    there = (inverse(X) @ np.c_[flat, np.ones(4)].T)[:3].T
    assert np.linalg.det(SolidPoints(flat).find(there)[:3, :3]) == pytest.approx(1.0)
    noisy = here + 1e-3 * np.random.default_rng(1).normal(size=here.shape)
    solid = SolidPoints(POINTS)
    best, residual, condition = solid.follow(None, noisy)

    def cost(X_CT):
        return np.sum((POINTS @ X_CT[:3, :3].T + X_CT[:3, 3] - noisy) ** 2)

    for axis in np.eye(6):
        assert cost(best) < min(cost(exponential(axis, 1e-4) @ best), cost(exponential(axis, -1e-4) @ best))
    assert 0.0 < residual < 0.01 and 1.0 < condition < 3.0


@pytest.mark.parametrize("points", [POINTS[:2], POINTS[:1] * [[1.0], [2.0], [3.0]]])
def test_two_points_or_a_line_have_no_pose(points):
    with pytest.raises(DegenerateFeature, match="pose from depth"):
        SolidPoints(points)


@pytest.mark.parametrize("point_z, fault, text", [
    ((0.6, NAN, 0.5, 0.0), "", "a hole at point 2, 4"),
    ((), "the depth image is 4 x 3", "the depth image is 4 x 3"),
    ((), "", "depth image: .*vision.depth")])
@pytest.mark.parametrize("setup", [{"point_depth": "image"}, {"pose_from": "depth"}])
def test_a_view_with_a_hole_or_without_a_depth_image_has_no_answer(setup, point_z, fault, text):
    goal = tilted_pose(1)
    name, features = ("ibvs", ("points4",)) if "point_depth" in setup else ("pbvs", POSE)
    law = law_of(name, features, seen(goal), **{"interaction": "current", **setup})
    view = seen(goal, depth_fault=fault)
    view.point_z = point_z
    with pytest.raises(DegenerateFeature, match=text):
        law.step(Look(View(view, (0.0, 0.0, 1.6)), 0.0, np.eye(4)))
    with pytest.raises(DegenerateFeature, match=text):
        law_of(name, features, view, **{"interaction": "current", **setup})


def test_teaching_averages_the_depths_of_views_without_holes():
    views = [seen(tilted_pose(1), point_z=z) for z in ((0.5,) * 4, (0.5, NAN, 0.5, 0.5), (0.7,) * 4)]
    assert source_named("matches").mean(views).point_z == pytest.approx((0.6,) * 4)
    views[0].point_z = views[2].point_z = ()
    assert source_named("matches").mean(views).point_z == ()


def test_a_reference_keeps_depths_but_no_holes():
    numbers = dict.fromkeys(("xn", "yn", "an", "alpha", "area_star"), 0.5)
    view = seen(tilted_pose(1), moment_names=("00",), m=[1.0], mu=[1.0], **numbers)
    kept = Reference(np.zeros(8), view=view)
    assert Reference.from_dict(kept.to_dict()).view.point_z == pytest.approx(view.point_z)
    view.point_z = (0.5, NAN, 0.5, 0.5)
    assert len(Reference.from_dict(kept.to_dict()).view.point_z) == 0


POSE_RATES = {"servo.law": "pbvs", "servo.features": list(POSE), "servo.gains_per_s": dict.fromkeys(POSE, 2.0),
              "servo.thresholds": dict.fromkeys(POSE, 0.001)}


@pytest.mark.parametrize("name, changes, text", [
    ("six_dof_points", {"servo.point_depth": "image"}, "vision.depth: .*point_depth: image"),
    ("six_dof_points", {**POSE_RATES, "servo.pose_from": "depth"}, "vision.depth: .*pose_from: depth"),
    ("six_dof_matches", {"servo.pose_from": "depth"}, "vision.matches.depth: found nothing"),
    ("six_dof_rgbd", {"vision.depth": {"window_px": 4}}, "window_px: found 4, allowed an odd number"),
    ("six_dof_rgbd", {"vision.points": "none"}, "allowed with points corners or blobs"),
    ("six_dof_rgbd", {"servo.law": "ibvs", "servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0},
                      "servo.filter": {}, "servo.thresholds": {"points4": 0.001}, "servo.point_depth": "image"},
     "filter: found with point_depth: image")])
def test_a_scenario_that_lacks_something_is_refused(name, changes, text):
    pytest.importorskip("aras_visual_servo_sim")
    with pytest.raises(Exception, match=text) as caught:
        ServoLoop(load_scenario(name, changes))
    assert type(caught.value).__name__ == "ParameterError"  # of either package


IBVS = {"servo.law": "ibvs", "servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0},
        "servo.thresholds": {"points4": 0.0005}, "servo.interaction": "current", "servo.point_depth": "image"}


@pytest.mark.parametrize("changes", [{}, IBVS], ids=["pbvs", "points"])
def test_the_camera_comes_home_over_plates_at_different_heights(changes):
    pytest.importorskip("aras_visual_servo_sim")
    import aras_visual_servo as avs
    from aras_visual_servo.runs.judge import judge
    judgement = judge(avs.run(load_scenario("six_dof_rgbd", changes)))
    assert judgement.passed, judgement.faults


class _Camera:
    """A simulator whose depth image is spoilt."""

    def __init__(self, sim, spoil):
        self._sim, self._spoil = sim, spoil

    def __getattr__(self, name):
        return getattr(self._sim, name)

    def render_depth(self, camera):
        return self._spoil(self._sim.render_depth(camera).copy())


def _hole(value):
    def spoil(depth):
        depth[:] = value
        return depth
    return spoil


@pytest.mark.parametrize("changes", [{}, IBVS], ids=["pbvs", "points"])
@pytest.mark.parametrize("spoil, text", [
    (_hole(NAN), "a hole at point 1, 2, 3, 4"), (_hole(0.0), "a hole at point 1, 2, 3, 4"),
    (lambda depth: np.ascontiguousarray(depth[::2]), "320 x 120, allowed 320 x 240"),
    (lambda depth: None, "no depth image came with the image")], ids=["nan", "zero", "size", "missing"])
def test_a_spoilt_depth_image_stops_the_arm_with_the_reason_and_it_goes_on_when_depth_is_back(changes, spoil, text):
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(load_scenario("six_dof_rgbd", {"experiment.settle_s": 0.1, **changes}))
    loop.start()
    while loop.sequence.phase != "servo":
        assert loop.sequence.phase != "done", loop.sequence.result.reason
        loop.step()
    for _ in range(5):
        assert loop.step()[0].status == Status.SERVOING
    good, loop.sim = loop.sim, _Camera(loop.sim, spoil)
    for _ in range(3):
        record, _, _ = loop.step()
    assert record.status == Status.TARGET_LOST
    assert text in record.status_text
    assert np.array_equal(record.q_dot, np.zeros(len(record.q_dot)))
    loop.sim = good
    assert loop.step()[0].status == Status.SERVOING


def test_a_goal_without_depth_ends_the_run_with_a_status():
    pytest.importorskip("aras_visual_servo_sim")
    loop = ServoLoop(load_scenario("six_dof_rgbd", {"experiment.settle_s": 0.1}))
    loop.sim = _Camera(loop.sim, _hole(NAN))
    loop.run()
    assert loop.sequence.result.status in (Status.FAULT, Status.TARGET_LOST)
    assert "a hole at point 1, 2, 3, 4" in loop.sequence.result.reason
