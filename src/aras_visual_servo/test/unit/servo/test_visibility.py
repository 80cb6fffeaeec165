"""What keeps an object in view: at each of the four borders, for objects without an extent, and for too large ones."""

import numpy as np
import pytest
from bench import Bench
from toy_plant import GOAL

from aras_visual_servo.features.base import View
from aras_visual_servo.features.interaction import centroid
from aras_visual_servo.servo.visibility import VisibilitySettings, keep_in_view

VIEW = VisibilitySettings(half_width=0.5, half_height=0.4, margin=0.02)


@pytest.fixture
def features():
    return Bench(start=GOAL).look().features


@pytest.mark.parametrize("axis, half, name", [(0, 0.5, "20"), (1, 0.4, "02")])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_at_each_border_the_edge_uses_up_its_room_as_fast_as_asked(features, axis, half, name, sign):
    twist = np.zeros(6)
    twist[axis] = sign * 2.0  # the object moves the other way
    kept, bent = keep_in_view(VIEW, features, twist)
    assert bent and (np.delete(kept, axis) == np.delete(twist, axis)).all() and abs(kept[axis]) < 2.0
    view = View(features, np.array([0.0, 0.0, 1.0 / features.an]))
    n, at = view.mu[name] / features.area, (features.xg, features.yg)[axis]
    L_spread = (view.L_mu(int(name[0]), int(name[1])) - n * view.L_area()) / features.area / n**0.5
    room = half - 0.02 + sign * at - 2.0 * n**0.5
    L_edge = -sign * centroid(view.m, view.plane)[axis] + L_spread
    assert float(L_edge @ kept) == pytest.approx(VIEW.rate_per_s * room, rel=1e-9)


@pytest.mark.parametrize("axis, name", [(0, "20"), (1, "02")])
def test_an_object_without_extent_along_an_axis_is_left_alone_there(features, axis, name):
    features.mu[features.moment_names.index(name)] = 0.0
    twist = np.array([2.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    kept, bent = keep_in_view(VIEW, features, twist)
    assert bent and kept[axis] == 2.0 and kept[1 - axis] < 2.0


def test_an_object_that_ends_beyond_a_border_is_brought_back_and_one_larger_than_the_view_is_not_held(features):
    twist = np.array([2.0, 2.0, 0.0, 0.0, 0.0, 0.0])
    features.xg = features.yg = 0.3  # beyond two borders, well within the others
    kept, bent = keep_in_view(VisibilitySettings(half_width=0.3, half_height=0.3, margin=0.0), features, twist)
    assert bent and (kept[:2] < 2.0).all()
    features.xg = features.yg = 0.0
    small = VisibilitySettings(half_width=0.01, half_height=0.01, margin=0.0)
    kept, bent = keep_in_view(small, features, twist)
    assert kept is twist and not bent
