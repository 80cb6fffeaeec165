"""What features change by when the sides of the object err, against objects whose sides are displaced."""

import numpy as np
import pytest
from toy_plant import Camera

from aras_visual_servo.features.base import FeatureSet, View
from aras_visual_servo.features.edges import edge_changes
from aras_visual_servo.ground.types import Features

HALF, CENTRE, STEP = (0.12, 0.05), (0.03, -0.02), 1e-6


def rectangle(left=0.0, right=0.0, top=0.0, bottom=0.0):
    """`Features` of a rectangle, seen from 1 m, whose sides are displaced outwards."""
    x0, x1 = CENTRE[0] - HALF[0] - left, CENTRE[0] + HALF[0] + right
    y0, y1 = CENTRE[1] - HALF[1] - bottom, CENTRE[1] + HALF[1] + top
    X_WC = np.eye(4)
    X_WC[2, 3] = -1.0
    camera = Camera(None, np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]]))
    camera.star = (0.5, 4.0 * HALF[0] * HALF[1])
    return camera.features(X_WC)


@pytest.mark.parametrize("names", [("xn", "yn", "an"), ("n20", "n02")])
def test_the_changes_with_shifted_sides_are_those_of_the_shifted_rectangle(names):
    features, view = FeatureSet(names), rectangle()
    s = np.array(features.values(View(view)))
    expected = [(np.array(features.values(View(rectangle(**{side: STEP})))) - s) / STEP
                for side in ("top", "bottom", "left", "right")]
    shifts = edge_changes(features, view)[:, -8::2].T  # those of points come first, and every other one turns a side
    assert len(shifts) == len(expected)
    for wanted in expected:
        assert min(np.abs(shift - wanted).max() for shift in shifts) < 1e-3 * np.abs(expected).max()


def test_turned_sides_turn_the_orientation_and_leave_the_area():
    area_and_angle = FeatureSet(("an", "alpha"))
    turns = edge_changes(area_and_angle, rectangle())[:, -7::2]
    np.testing.assert_allclose(turns[0], 0.0, atol=1e-6)
    assert np.abs(turns[1]).max() > 1.0


def test_each_coordinate_of_a_point_errs_by_itself():
    view = Features(point_x=(-0.1, 0.1), point_y=(0.0, 0.2))
    changes = edge_changes(FeatureSet(("x1", "y2", "l1")), view)
    np.testing.assert_allclose(changes[0], [1.0, 0.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(changes[1], [0.0, 0.0, 0.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(changes[2], np.array([-1.0, 1.0, -1.0, 1.0]) / 2**0.5, atol=1e-4)
