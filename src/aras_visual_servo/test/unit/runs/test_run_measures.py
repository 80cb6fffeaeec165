"""What the path of a run says, on records made by hand."""

import numpy as np
import pytest

from aras_visual_servo import measures, MEASURES, Outline, RecordBuilder, Status
from aras_visual_servo.runs.measures import distance_from_segment
from aras_visual_servo.spatial import rotation

CAMERA = {"width": 320, "height": 240, "fx_px": 200.0}
DOWN = rotation(np.array([np.pi, 0.0, 0.0]))  # x stays, the camera looks along -z


def record_of(positions, q=((0.0, 0.5),)):
    builder = RecordBuilder("made_up", ("a", "b"))
    for i, p in enumerate([positions[-1], *positions]):
        X = np.eye(4)
        X[:3, :3], X[:3, 3] = DOWN, p
        phase, status = ("teach", Status.IDLE) if i == 0 else ("servo", Status.SERVOING)
        builder.add_row(i * 10**8, phase, status, q=q[min(i, len(q) - 1)], X_WC=X)
    return builder.finish()


def test_a_detour_is_longer_than_the_straight_line():
    path = [(0.0, 0.0, 0.5), (0.03, 0.04, 0.5), (0.1, 0.0, 0.5)]
    found = measures(record_of(path), [-1.0, -1.0], [1.0, 1.0])
    assert found["path_mm"] == pytest.approx(50.0 + np.hypot(70.0, 40.0))
    assert found["detour_mm"] == pytest.approx(40.0) and found["farthest_mm"] == pytest.approx(100.0)
    assert found["border_px"] is None and set(found) == set(MEASURES)


def test_of_many_poses_the_least_distance_from_the_border_counts_to_the_last_bit():
    outline = Outline([[[-0.1, -0.05], [0.12, -0.05], [0.0, 0.08]]], np.eye(4), {**CAMERA, "distortion": [-0.3, 0.1]})
    poses = np.tile(np.eye(4), (5, 1, 1))
    for X, angle in zip(poses, np.linspace(-0.3, 0.2, 5)):
        X[:3, :3], X[:3, 3] = DOWN @ rotation(np.array([angle, 0.1, 0.4])), (0.1 * angle, 0.02, 0.5)
    assert outline.border_px(poses) == min(outline.border_px(X) for X in poses)
    poses[3, 2, 3] = -0.5
    assert outline.border_px(poses) == -np.inf


def test_beyond_the_ends_the_distance_is_from_the_end():
    points = np.array([[-3.0, 4.0, 0.0], [5.0, 2.0, 0.0], [12.0, 0.0, 0.0]])
    a, b = np.zeros(3), np.array([10.0, 0.0, 0.0])
    np.testing.assert_allclose(distance_from_segment(points, a, b), [5.0, 2.0, 2.0])
    np.testing.assert_allclose(distance_from_segment(points, a, a), [5.0, np.hypot(5.0, 2.0), 12.0])


def test_the_joint_nearest_to_a_limit_counts_free_ones_do_not():
    record = record_of([(0.0, 0.0, 0.5)] * 3, q=[(0.0, 0.0), (7.0, 0.5), (9.0, -1.7)])
    assert measures(record, [-np.inf, -2.0], [np.inf, 1.0])["joint_room"] == pytest.approx(0.3 / 1.5)
    assert measures(record, [-np.inf] * 2, [np.inf] * 2)["joint_room"] is None


def test_the_least_distance_of_the_target_from_the_border():
    square = [[[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]]
    outline = Outline(square, np.eye(4), CAMERA)
    found = measures(record_of([(0.0, 0.0, 0.5), (0.2, 0.0, 0.5), (0.1, 0.0, 0.5)]), [-1.0] * 2, [1.0] * 2, outline)
    # At x = 0.2 the left edge is 0.25 m aside at 0.5 m: 100 px left of the middle, 60 px from the border at -1/2.
    assert found["border_px"] == pytest.approx(60.0)
    cut = measures(record_of([(0.4, 0.0, 0.5)] * 2), [-1.0] * 2, [1.0] * 2, outline)
    assert cut["border_px"] == pytest.approx(160.0 - 0.45 / 0.5 * 200.0)
