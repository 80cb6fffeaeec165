"""Pose of points of a plane: homography, mirror image, least squares; which corner is which; exact pictures."""

import numpy as np
import pytest
from toy_plant import OUTLINE
from views import exponential, tilted_pose, view

from aras_visual_servo import DegenerateFeature
from aras_visual_servo.features.target.points_pose import corners_clockwise, find_corners, homography, PlanarPoints
from aras_visual_servo.spatial import rotation_vector

SEEDS = (1, 2, 3, 4)
ROUNDING = 1e-9  # of a least-squares problem of condition 100, from steps that ended at 1e-5 squared
RECTANGLE = np.array([[-0.1, -0.06], [0.1, -0.06], [0.1, 0.06], [-0.1, 0.06]])


def points_of(outline):
    return np.c_[outline, np.zeros(len(outline))]


def seen(X_WC, outline=OUTLINE):
    return PlanarPoints.measured(view(X_WC, outline).features)


@pytest.mark.parametrize("outline", [OUTLINE, RECTANGLE], ids=["five", "four"])
@pytest.mark.parametrize("seed", SEEDS)
def test_pose_is_found_from_one_view_alone(seed, outline):
    X = tilted_pose(seed)
    found = PlanarPoints(points_of(outline)).find(seen(X, outline))
    np.testing.assert_allclose(found, np.linalg.inv(X), atol=ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_noise_of_a_tenth_of_a_pixel_moves_the_pose_by_as_much_as_the_geometry_says(seed):
    X, noise = tilted_pose(seed), 0.1 / 200.0 * np.random.default_rng(seed).standard_normal((5, 2))
    found = PlanarPoints(points_of(OUTLINE)).find(seen(X) + noise)
    off = found @ X
    # sigma / (smallest singular value of L: 0.05 at this size and distance), three sigma
    assert np.linalg.norm(off[:3, 3]) < 3 * 0.0005 / 0.05 and np.linalg.norm(rotation_vector(off[:3, :3])) < 0.06


@pytest.mark.parametrize("seed", range(12))
def test_of_the_two_poses_that_explain_a_view_from_afar_the_better_one_is_found(seed):
    """Two metres away, a tenth of a pixel of noise: descents that begin on both sides of the line of sight."""
    rng = np.random.default_rng(seed)
    X = np.diag([1.0, -1.0, -1.0, 1.0])
    X[2, 3] = 2.0
    X = X @ exponential([0.0, 0.0, 0.0, *rng.uniform(-0.2, 0.2, 2), 0.3], 1.0)
    points, xy = PlanarPoints(points_of(OUTLINE)), seen(X) + 0.1 / 200.0 * rng.standard_normal((5, 2))
    least = np.inf
    for tilt in (0.0, 0.3, -0.3), (0.0, -0.3, 0.3), (0.3, 0.0, 0.0), (-0.3, 0.0, 0.0), (0.0, 0.3, 0.3):
        try:
            least = min(least, points._descend(exponential([0, 0, 0, *tilt], 1.0) @ np.linalg.inv(X), xy)[1])
        except DegenerateFeature:
            continue
    assert points.improve(points.find(xy), xy)[1] < 1.001 * least


def test_points_anywhere_in_space_will_do_if_they_are_in_one_plane():
    X, X_TG = tilted_pose(1), exponential([0.3, -0.2, 0.5, 0.4, -0.3, 1.0], 1.0)
    moved = points_of(OUTLINE) @ X_TG[:3, :3].T + X_TG[:3, 3]
    found = PlanarPoints(moved).find(seen(X))
    np.testing.assert_allclose(found @ X_TG, np.linalg.inv(X), atol=ROUNDING)


def test_following_arrives_from_nearby_and_starts_anew_where_it_is_lost():
    X, points = tilted_pose(2), PlanarPoints(points_of(OUTLINE))
    near = np.linalg.inv(X @ exponential([0.01, -0.01, 0.02, 0.03, -0.03, 0.05], 1.0))
    far = np.linalg.inv(X @ exponential([0.0, 0.0, 0.0, 0.0, 0.0, 3.0], 1.0))
    for start in (near, far, np.diag([1.0, 1.0, 1.0, 1.0])):
        found, residual, condition = points.follow(start, seen(X))
        np.testing.assert_allclose(found, np.linalg.inv(X), atol=ROUNDING)
        assert residual < 1e-5 and 1.0 < condition < 1000.0


def test_homography_maps_points_to_points():
    H = np.array([[1.0, 0.2, 0.1], [-0.1, 0.9, 0.3], [0.2, -0.1, 1.1]])
    a = OUTLINE * 5.0
    b = np.c_[a, np.ones(len(a))] @ H.T
    found = homography(a, b[:, :2] / b[:, 2:])
    np.testing.assert_allclose(found / found[2, 2], H / H[2, 2], atol=ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_corners_are_told_apart_and_a_symmetric_target_has_one_of_its_poses(seed):
    X = tilted_pose(seed)
    xy = seen(X, corners_clockwise(OUTLINE)[:, :2])
    for first in range(5):
        points, X_CT = find_corners(OUTLINE, np.roll(xy, -first, axis=0))
        np.testing.assert_allclose(X_CT, np.linalg.inv(X), atol=ROUNDING)
        np.testing.assert_allclose(points.points_T, np.roll(corners_clockwise(OUTLINE), -first, axis=0))
    points, X_CT = find_corners(RECTANGLE, seen(X, corners_clockwise(RECTANGLE)[:, :2]))
    off = X_CT @ X
    np.testing.assert_allclose(np.abs(np.diag(off)), 1.0, atol=ROUNDING)  # itself, or half a turn


def test_corners_are_clockwise_on_the_screen():
    """The screen's y points down: what turns clockwise there has a positive area."""
    x, y = seen(tilted_pose(1), corners_clockwise(OUTLINE)[:, :2]).T
    assert np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0.0


@pytest.mark.parametrize("points, text", [
    (points_of(OUTLINE)[:3], "found 3, needed at least 4"),
    (np.outer(np.arange(4.0), [1.0, 2.0, 0.5]), "lie on a line")])
def test_points_that_are_no_plane_are_refused(points, text):
    with pytest.raises(DegenerateFeature, match=text):
        PlanarPoints(points)


def test_views_of_something_else_are_refused():
    points, xy = PlanarPoints(points_of(OUTLINE)), seen(tilted_pose(1))
    with pytest.raises(DegenerateFeature, match="found 4 points in this view, 5 known"):
        points.follow(np.linalg.inv(tilted_pose(1)), xy[:4])
    with pytest.raises(DegenerateFeature, match="no pose explains"):
        points.find(xy[[1, 0, 2, 4, 3]])
    with pytest.raises(DegenerateFeature, match="found 4 .*5 corners"):
        find_corners(OUTLINE, xy[:4])
    with pytest.raises(DegenerateFeature, match="no pose of the known corners"):
        find_corners(RECTANGLE, xy[[2, 0, 1, 3]])
    with pytest.raises(DegenerateFeature, match="behind the camera"):
        points.improve(np.diag([1.0, 1.0, 1.0, 1.0]) - 0.5 * np.outer([0, 0, 1, 0], [0, 0, 0, 1]), xy)
