"""What the stop rule asks of C++: displacements between poses, and what the images of the last seconds say."""

import numpy as np
import pytest

from aras_visual_servo._kinematics import Arrival, between
from aras_visual_servo.ground.errors import ShapeError
from aras_visual_servo.spatial import exponential, inverse, rotation, rotation_vector

#: Rounding of some tens of operations on numbers of size 1.
ROUNDING = 1e-14
#: Near half a turn the quaternion gives the axis; it loses a few digits more.
HALF_TURN_ROUNDING = 1e-12
HOLD_NS, KEPT_NS, POSITION_M, ROTATION_RAD, TILT_RAD = 200, 1000, 0.001, 0.01, 0.002


def arrival(taught_images=4, sure=2.0):
    return Arrival([0.1, 0.2], HOLD_NS, KEPT_NS, POSITION_M, ROTATION_RAD, TILT_RAD, sure, taught_images)


def pose(turn, position):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation(turn), position
    return X


@pytest.mark.parametrize("angle", [0.0, 1e-12, 1e-5, 0.3, 2.0, 3.0, 3.14159])
def test_between_is_the_translation_and_the_rotation_vector_in_the_first_frame(angle):
    rng = np.random.default_rng(7)
    X_A, axis = exponential(rng.normal(size=6)), rng.normal(size=3)
    X_AB = pose(angle * axis / np.linalg.norm(axis), rng.normal(size=3))
    found = between(X_A, X_A @ X_AB)
    tolerance = HALF_TURN_ROUNDING if angle > 2.5 else ROUNDING
    np.testing.assert_allclose(found[:3], X_AB[:3, 3], rtol=0.0, atol=10.0 * ROUNDING)
    expected = rotation_vector((inverse(X_A) @ X_A @ X_AB)[:3, :3])
    np.testing.assert_allclose(found[3:], expected, rtol=0.0, atol=tolerance)


def test_features_are_judged_by_their_mean_over_hold_s_and_the_tilt_by_its_largest():
    judged = arrival()
    judged.features(0, (9.0, 9.0), 0.9)  # out of the window at the last stamp
    judged.features(100, (0.3, -0.1), 0.001)
    means, tilt = judged.features(300, (-0.1, -0.1), 0.0005)
    np.testing.assert_allclose(means, [1.0, 0.5], rtol=ROUNDING)
    assert tilt == 0.5
    with pytest.raises(ShapeError, match="e: 1 values, expected 2"):
        judged.features(400, (1.0,), 0.0)


def test_the_place_is_the_mean_pose_of_the_images_near_the_camera_and_its_uncertainty_counts():
    rng, judged = np.random.default_rng(3), arrival()
    moved = [np.array([x, 0.0, 0.0, 0.0, 0.0, 0.0]) for x in (0.0, 0.01, 0.0102, 0.0104)]
    poses = [1e-4 * rng.normal(size=6) + motion for motion in moved]
    for k, (motion, seen) in enumerate(zip(moved, poses)):
        found = judged.place(100 * k, motion, seen)
    near = np.array([seen - motion for motion, seen in zip(moved[1:], poses[1:])])  # the first is 10 mm away
    where = near.mean(axis=0) + np.array(moved[1:])  # of the last 200 ns
    unsure = np.sqrt(where**2 + 4.0 * (1.0 / 3.0 + 1.0 / 4.0) * near.var(axis=0))

    def parts(places):
        return (np.linalg.norm(places[:, :3], axis=1).max() / POSITION_M,
                np.linalg.norm(places[:, 3:], axis=1).max() / ROTATION_RAD)

    off, way, position, turn, position_m, rotation_rad = found
    np.testing.assert_allclose(off, max(parts(where)), rtol=1e3 * ROUNDING)
    np.testing.assert_allclose(way, 0.0004 / POSITION_M, rtol=1e3 * ROUNDING)
    np.testing.assert_allclose((position, turn), parts(unsure), rtol=1e3 * ROUNDING)
    last = np.linalg.norm(unsure[-1, :3]), np.linalg.norm(unsure[-1, 3:])
    np.testing.assert_allclose((position_m, rotation_rad), last, rtol=1e3 * ROUNDING)


def test_clear_forgets_every_image():
    judged = arrival()
    judged.features(0, (9.0, 9.0), 0.9)
    judged.place(0, np.zeros(6), np.ones(6))
    judged.clear()
    means, tilt = judged.features(1, (0.1, 0.2), 0.001)
    assert means == [1.0, 1.0] and tilt == 0.5
    assert judged.place(1, np.zeros(6), np.zeros(6))[0] == 0.0
