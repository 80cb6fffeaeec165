"""Features predicted for a camera that has moved, against those of an exact picture from there."""

import numpy as np
import pytest
from toy_plant import Camera

from aras_visual_servo import DegenerateFeature, ParameterError, plane_from_pose
from aras_visual_servo.spatial import exponential, inverse, rotation_rpy
from aras_visual_servo_controller.real.prediction import predicted

NAMES = ("xg", "yg", "alpha", "xn", "yn", "an", "area")
#: Half the motion leaves a quarter of the error; higher orders may add to it.
SECOND_ORDER = 0.35
#: Points are mapped exactly but for rounding.
ROUNDING = 1e-12
#: Of the motion of a feature, so much at most is left: the object fills a fifth of its distance.
LEFT = 0.03


def scene(seed):
    """(camera, X_WC, plane in its frame, a twist): tilted views of the target, and a motion of a few centimetres."""
    random = np.random.default_rng(seed)
    X_WT = np.eye(4)
    X_WC = np.eye(4)
    X_WC[:3, :3] = rotation_rpy([np.pi, 0.0, 0.0]) @ rotation_rpy(random.uniform(-0.3, 0.3, 3))
    X_WC[:3, 3] = [0.0, 0.0, 0.6]
    X_WC[:3, 3] = X_WC[:3, :3] @ [0.05, -0.04, -0.6]
    camera = Camera(X_WT)
    camera.star = (0.6, 0.03)
    X_CT = inverse(X_WC) @ X_WT
    twist = np.concatenate([random.uniform(-0.04, 0.04, 3), random.uniform(-0.08, 0.08, 3)])
    return camera, X_WC, plane_from_pose(X_CT[:3, 2], X_CT[:3, 3]), twist


def values(features):
    return np.array([getattr(features, name) for name in NAMES])


@pytest.mark.parametrize("seed", range(4))
def test_the_prediction_is_right_to_second_order(seed):
    camera, X_WC, plane_C, twist = scene(seed)
    before, errors = camera.features(X_WC), []
    for part in (1.0, 0.5):
        X = exponential(part * twist)
        after = camera.features(X_WC @ X)
        found = predicted(before, plane_C, X)
        errors.append(np.abs(values(found) - values(after)).max())
        moved = np.abs(values(before) - values(after)).max()
        assert errors[-1] < LEFT * moved
        assert found.mu == pytest.approx(after.mu, abs=0.2 * max(np.abs(np.array(before.mu) - after.mu)) + 1e-9)
    assert errors[1] < SECOND_ORDER * errors[0] + ROUNDING


@pytest.mark.parametrize("seed", range(4))
def test_points_are_mapped_exactly(seed):
    camera, X_WC, plane_C, twist = scene(seed)
    X = exponential(twist)
    found, after = predicted(camera.features(X_WC), plane_C, X), camera.features(X_WC @ X)
    assert found.point_x == pytest.approx(after.point_x, abs=ROUNDING)
    assert found.point_y == pytest.approx(after.point_y, abs=ROUNDING)


def test_a_camera_at_rest_sees_the_same():
    camera, X_WC, plane_C, _ = scene(0)
    before = camera.features(X_WC)
    assert values(predicted(before, plane_C, np.eye(4))) == pytest.approx(values(before), abs=ROUNDING)
    assert predicted(before, plane_C, np.eye(4)).m == pytest.approx(before.m, abs=ROUNDING)


def test_a_camera_beyond_the_target_is_refused():
    camera, X_WC, plane_C, _ = scene(0)
    with pytest.raises(DegenerateFeature, match="behind the camera"):
        predicted(camera.features(X_WC), plane_C, exponential(np.array([0.0, 0.0, 1.0, 0.0, 0.0, 0.0])))


def test_kernel_projections_are_refused():
    camera, X_WC, plane_C, _ = scene(0)
    features = camera.features(X_WC)
    features.kernel_x = (1.0,)
    with pytest.raises(ParameterError, match="kernel"):
        predicted(features, plane_C, np.eye(4))
