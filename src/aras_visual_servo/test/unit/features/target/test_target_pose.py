"""Pose of a known target from its moments: exact pictures, tilted poses, views that are no use."""

import numpy as np
import pytest
from toy_plant import Camera, OUTLINE
from views import differences, exponential, plane_of, tilted_pose

from aras_visual_servo import DegenerateFeature, PlanarTarget
from aras_visual_servo.features import interaction
from aras_visual_servo.features.target import target_pose
from aras_visual_servo.features.target.target_pose import measures_of
from aras_visual_servo.spatial import rotation_vector

SEEDS = (1, 2, 3, 4)
ROUNDING = 1e-9   # of a least-squares problem of condition 1000
DIFFERENCES = 1e-6  # see test_interaction.STEP, times the condition that normalising by the small area adds
TARGET = PlanarTarget([OUTLINE])


def look(X_WC, outline=OUTLINE):
    camera = Camera(None, outline)
    camera.star = (0.6, 0.03)
    return camera.features(X_WC)


def pose_of(X_WC):
    return np.linalg.inv(X_WC)  # the target lies in the world's origin


@pytest.mark.parametrize("seed", SEEDS)
def test_predicted_measures_are_those_of_the_picture(seed):
    X = tilted_pose(seed)
    np.testing.assert_allclose(TARGET.predicted(pose_of(X))[0], measures_of(look(X)), atol=ROUNDING)


@pytest.mark.parametrize("seed", SEEDS)
def test_matrix_of_the_measures_is_the_derivative(seed):
    X = tilted_pose(seed)
    wanted = differences(lambda X: measures_of(look(X)), X)
    L = TARGET.predicted(pose_of(X))[1]
    for row, expected in zip(L, wanted):
        np.testing.assert_allclose(row, expected, atol=DIFFERENCES * np.abs(expected).max())


def test_rows_at_once_are_the_rows_one_by_one():
    X = tilted_pose(2)
    f, m = look(X), TARGET.moments(pose_of(X))
    raw, mu = dict(zip(f.moment_names, f.m)), dict(zip(f.moment_names, f.mu))
    centred = target_pose._centred(m, f.xg, f.yg)
    n = [centred[k] / m[0, 0] for k in ((2, 0), (1, 1), (0, 2))]
    rows = target_pose._centred_rows(centred, f.xg, f.yg, *n, plane_of(X))
    for row, i, j in zip(rows, target_pose._I, target_pose._J):
        np.testing.assert_allclose(row, interaction.centred_moments(raw, mu, [(i, j)], plane_of(X))[0], atol=1e-12)


@pytest.mark.parametrize("seed", SEEDS)
def test_pose_is_found_from_one_view_and_a_rough_normal(seed):
    X = tilted_pose(seed)
    f = look(X)
    f.z_star_m = 0.5  # 0.6 or so
    np.testing.assert_allclose(TARGET.find(f, [0.0, 0.0, 1.0]), pose_of(X), atol=ROUNDING)


def test_one_step_from_nearby_leaves_the_square_of_the_error():
    X, near = tilted_pose(1), 1e-3
    start = pose_of(X @ exponential(near * np.array([1.0, -1.0, 1.0, 1.0, -1.0, 1.0]), 1.0))
    found, residual, _ = TARGET.improve(start, measures_of(look(X)))
    assert np.abs(found - pose_of(X)).max() < 100.0 * near**2  # curvature over the smallest singular value
    assert residual > 1e-4


def test_following_arrives_from_one_image_to_the_next():
    X = tilted_pose(1)
    start = pose_of(X @ exponential([0.01, -0.01, 0.02, 0.03, -0.02, 0.05], 1.0))
    found, residual, condition = TARGET.follow(start, TARGET.measured(look(X)))
    np.testing.assert_allclose(found, pose_of(X), atol=1e-3)  # square of what was left before, times 100
    assert residual < target_pose.MAX_FOUND and condition == pytest.approx(
        np.linalg.cond(TARGET.predicted(pose_of(X))[1]), rel=0.1)


def test_another_object_is_not_taken_for_the_target():
    bar = np.array([[-0.2, -0.01], [0.2, -0.01], [0.2, 0.01], [-0.2, 0.01]])
    with pytest.raises(DegenerateFeature, match="no pose of the known outline"):
        TARGET.find(look(tilted_pose(1), bar), [0.0, 0.0, 1.0])


def test_a_pose_behind_the_camera_has_no_picture():
    with pytest.raises(DegenerateFeature, match="behind the camera"):
        TARGET.moments(np.diag([1.0, 1.0, -1.0, 1.0]) - 0.5 * np.outer([0, 0, 1, 0], [0, 0, 0, 1]))


def test_missing_moments_are_named():
    f = look(tilted_pose(1))
    f.moment_names, f.m, f.mu = f.moment_names[:3], f.m[:3], f.mu[:3]
    with pytest.raises(DegenerateFeature, match="moment '.*' is missing"):
        measures_of(f)
    empty = look(tilted_pose(1))
    empty.m = [0.0] * len(empty.m)
    with pytest.raises(DegenerateFeature, match="empty"):
        measures_of(empty)


@pytest.mark.parametrize("left, found", [(5e-4, True), (1.5e-3, False)])
def test_the_best_guess_is_taken_if_it_explains_the_view_to_a_thousandth(left, found, monkeypatch):
    f = look(tilted_pose(1))
    guesses = list(target_pose._guesses([0.0, 0.0, 1.0], 0.6 * np.array([f.xg, f.yg, 1.0])))
    monkeypatch.setattr(PlanarTarget, "improve", lambda self, X, measured: (
        X, left + 1e-4 * np.abs(X - guesses[13]).max(), 1.0))
    if found:
        np.testing.assert_array_equal(TARGET.find(f, [0.0, 0.0, 1.0], steps=1), guesses[13])
    else:
        with pytest.raises(DegenerateFeature, match="no pose"):
            TARGET.find(f, [0.0, 0.0, 1.0], steps=1)


def test_guesses_face_the_camera_upright_and_tilted_to_four_sides_in_eight_turns():
    normal, t = np.array([0.3, -0.2, 0.9]), np.array([0.1, 0.2, 0.5])
    guesses = list(target_pose._guesses(normal, t))
    axes = np.array([-X[:3, 2] for X in guesses]).reshape(5, 8, 3)
    assert len(guesses) == 40 and all((X[:3, 3] == t).all() for X in guesses)
    np.testing.assert_allclose(axes, np.broadcast_to(axes[:, :1], axes.shape), atol=ROUNDING)  # turns keep the face
    np.testing.assert_allclose(axes[0, 0], normal / np.linalg.norm(normal), atol=ROUNDING)
    np.testing.assert_allclose(axes[1:, 0] @ axes[0, 0], np.cos(target_pose.GUESS_TILT_RAD), atol=ROUNDING)
    np.testing.assert_allclose(axes[1, 0] + axes[2, 0], axes[3, 0] + axes[4, 0], atol=ROUNDING)  # opposite pairs
    assert abs((axes[1, 0] - axes[2, 0]) @ (axes[3, 0] - axes[4, 0])) < ROUNDING
    for k in range(8):
        turned = rotation_vector(guesses[0][:3, :3].T @ guesses[k][:3, :3])
        assert np.linalg.norm(turned) == pytest.approx(min(k, 8 - k) * np.pi / 4.0, abs=1e-7)


def test_a_step_tells_the_largest_residual_and_the_condition_of_its_matrix():
    X_CT = pose_of(tilted_pose(1))
    measures, L = TARGET.predicted(X_CT)
    off = np.linspace(-1e-4, 2e-4, 10)
    _, residual, condition = TARGET.improve(X_CT, measures + off)
    assert residual == pytest.approx(2e-4, rel=1e-6) and condition == pytest.approx(np.linalg.cond(L), rel=1e-6)
