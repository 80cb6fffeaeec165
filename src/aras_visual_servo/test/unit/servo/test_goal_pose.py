"""What the features at the goal tell of the camera's pose, and what they leave open (T60, T73)."""

from math import pi

import numpy as np
import pytest
from toy_plant import Camera
from views import parallel_pose

from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.features.interaction import plane_from_pose
from aras_visual_servo.ground.types import Features, Reference
from aras_visual_servo.servo.goal_pose import GoalPose, turns_alike
from aras_visual_servo.spatial import exponential

ANY_WAY, DEPTH_M, NORMAL_RAD = np.eye(6), 0.6, 0.15
RECTANGLE = np.array([[-0.09, -0.05], [0.09, -0.05], [0.09, 0.05], [-0.09, 0.05]])


def goal(names, outline=RECTANGLE, normal_rad=0.0):
    camera = Camera(None, outline)
    camera.star = (DEPTH_M, 0.03)
    view = camera.features(parallel_pose())
    plane = np.array([0.0, 0.0, 1.0 / DEPTH_M])
    features = FeatureSet(names)
    return GoalPose(features, Reference(np.array(features.values(View(view))), None, None, view, plane), "plane",
                    normal_rad), features, view


def test_four_points_tell_every_motion():
    assert goal(["points4"])[0].unseen(ANY_WAY, DEPTH_M, False) == ()


def test_two_points_leave_two_motions_open():
    unseen = goal(["x1", "y1", "x3", "y3"])[0].unseen(ANY_WAY, DEPTH_M, False)
    assert unseen and not any("optical" in name for name in unseen)


def test_place_and_size_alone_do_not_tell_a_turn_about_the_axis():
    features = ["xn", "yn", "an"]
    assert goal(features)[0].unseen(ANY_WAY, DEPTH_M, True) == ("rotation about the optical axis",)
    assert len(goal(features)[0].unseen(ANY_WAY, DEPTH_M, False)) >= 3


def test_a_motion_that_the_arm_cannot_make_need_not_be_seen():
    without_tilt = np.delete(np.eye(6), [3, 4], axis=1)
    four = goal(["xn", "yn", "an", "alpha"])[0]
    assert four.unseen(without_tilt, DEPTH_M, False) == () != four.unseen(ANY_WAY, DEPTH_M, False)


@pytest.mark.parametrize("names", [["points4"], ["tx", "ty", "tz", "rx", "ry", "rz"]])
def test_views_tell_where_the_camera_was_by_their_points_where_the_law_measures_the_pose(names):
    camera = Camera(None, RECTANGLE)
    camera.star = (DEPTH_M, 0.03)
    displacements = 1e-4 * np.vstack([np.zeros(6), np.random.default_rng(1).normal(size=(3, 6))])
    views = [camera.features(parallel_pose() @ exponential(displacement)) for displacement in displacements]
    reference = Reference(np.zeros(len(names)), None, None, views[0], np.array([0.0, 0.0, 1.0 / DEPTH_M]))
    found = GoalPose(FeatureSet(names), reference).by_views(views)
    np.testing.assert_allclose(found, displacements, atol=2e-6)  # of the second order
    assert GoalPose(FeatureSet(names), Reference(np.zeros(len(names)))).by_views(views) is None


def test_one_of_the_planes_tells_the_true_displacement_of_a_target_inclined_otherwise():
    pose, features, view = goal(["points4"], normal_rad=NORMAL_RAD)
    displacement = np.array([1e-3, -2e-3, 1e-3, 1e-3, 2e-3, -1e-3])
    nearest = {}
    for way in np.arange(8) * pi / 4.0:
        normal = np.array([np.sin(NORMAL_RAD) * np.cos(way), np.sin(NORMAL_RAD) * np.sin(way), np.cos(NORMAL_RAD)])
        plane = plane_from_pose(normal, DEPTH_M * np.array([view.xg, view.yg, 1.0]))
        e = features.matrix(View(view, plane)) @ displacement
        told = [plane @ pose.of(e, None) for plane in pose.left_open.planes]
        nearest[way] = min(np.linalg.norm(one - displacement) for one in told[1:])
        assert np.linalg.norm(told[0] - displacement) > 1e-5
    assert max(nearest.values()) < 1e-9


def test_the_covariance_of_points_is_that_of_their_pose():
    pose, features, view = goal(["points4"])
    inverse = np.linalg.pinv(features.matrix(View(view, (0.0, 0.0, 1.0 / DEPTH_M))))
    np.testing.assert_allclose(pose.left_open.edges, inverse @ inverse.T, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(pose.left_open.of_features, 1.0, rtol=1e-6)


def test_a_pose_that_a_law_measures_is_known_as_its_points_are():
    measured, points = goal(["tx", "ty", "tz", "rx", "ry", "rz"])[0], goal(["points4"])[0]
    np.testing.assert_allclose(measured.left_open.edges, points.left_open.edges)
    assert measured.of(np.zeros(6), None) is None


def test_a_goal_whose_points_have_no_depths_leaves_all_unknown():
    _, features, view = goal(["tx", "ty", "tz", "rx", "ry", "rz"])
    reference = Reference(np.zeros(6), None, None, view, np.array([0.0, 0.0, 1.0 / DEPTH_M]))
    pose = GoalPose(features, reference, "image")
    assert pose.of(np.zeros(6), None) is None and not pose.left_open.edges.any() and len(pose.left_open.planes) == 1


@pytest.mark.parametrize("outline, turns", [
    (RECTANGLE, [pi]), (0.05 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]), [pi / 2.0, pi, 1.5 * pi]),
    (np.array([[-0.09, -0.05], [0.09, -0.04], [0.08, 0.05], [-0.09, 0.05]]), [])])
def test_turns_after_which_the_points_are_the_same(outline, turns):
    view = Camera(None, outline).features(parallel_pose())
    np.testing.assert_allclose(sorted(turns_alike(view)), turns, atol=1e-9)
    assert turns_alike(Features()) == () == turns_alike(None)
