"""Laws qp and mpc on exact pictures and a camera that flies as it is told: constraints, slack, tilt, arrival."""

import numpy as np
import pytest
from constrained import arm_of, asked, DT_S, fly, GOAL, law_of, MOMENTS, POINTS, ROUNDING, turned, VIEW
from views import assert_same, differences, look_at, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, ParameterError, Status, View
from aras_visual_servo.laws.constraints import ConstraintSettings, rooms_of, WallSettings
from aras_visual_servo.spatial import exponential

#: A point's coordinate is linear in the motion of a period but for this part of the view: (0.1 rad)^2.
CURVED = 0.01


@pytest.mark.parametrize("points", [True, False])
@pytest.mark.parametrize("seed", [2, 3, 4])
def test_rates_of_the_rooms_are_those_of_central_differences(points, seed):
    settings = ConstraintSettings(**VIEW, walls={"w": WallSettings((1.0, -2.0, 0.5), 0.1)})

    def rooms(X):
        seen = view(X, plane=plane_of(X))
        if not points:
            seen.features.point_x = seen.features.point_y = ()
        return rooms_of(settings, seen, X)

    X = tilted_pose(seed)
    assert len(rooms(X).h) == len(rooms(X).names) == (26 if points else 6)
    rows, expected = rooms(X).rows, differences(lambda X: rooms(X).h, X)
    if not points:  # the depth is that of a point of the target, and the centroid is no such point in a tilted view
        np.testing.assert_allclose(rows[4], expected[4], atol=CURVED)
        rows, expected = np.delete(rows, 4, axis=0), np.delete(expected, 4, axis=0)
    assert_same(rows, expected)


def test_where_nothing_binds_qp_commands_the_joint_velocities_of_ibvs():
    law = law_of("qp", half_width=5.0, half_height=5.0)
    joints, arm, _, _ = asked(law, turned(0.1))
    np.testing.assert_allclose(joints.q_dot, arm.wanted, atol=ROUNDING)
    assert joints.status is None and joints.text == ""


@pytest.mark.parametrize("features", [POINTS, MOMENTS])
def test_where_a_border_binds_no_room_is_used_up_faster_than_allowed(features):
    law = law_of("qp", features, half_width=0.33, half_height=0.33, margin=0.0, rate_per_s=1.0)
    for angle in (1.5, -1.5, 2.5):
        joints, arm, rooms, _ = asked(law, turned(angle))
        assert (rooms.rows @ arm.wanted + rooms.h).min() < -1e-3
        assert (rooms.rows @ joints.q_dot + rooms.h).min() > -ROUNDING
        assert "held back by point" in joints.text


@pytest.mark.parametrize("name", ["qp", "mpc"])
def test_ibvs_leaves_the_view_where_the_constrained_law_stays_and_arrives(name):
    start = turned(1.0)  # with the matrix at the goal the camera advances in such a turn
    size = max(np.abs([view(X).features.point_x, view(X).features.point_y]).max() for X in (start, GOAL))
    bounds = {"half_width": size + 0.02, "half_height": size + 0.02, "margin": 0.01}
    X, rooms, texts = fly(law_of(name, interaction="desired", **bounds), start, 8.0)
    assert rooms.min() > -CURVED and any("held back by point" in text for text in texts)
    np.testing.assert_allclose(X, GOAL, atol=1e-3)  # exp(-2 * 8) of the start, and what the borders cost
    alone, X, low = law_of("qp", interaction="desired"), start, []
    for _ in range(120):
        seen = view(X, plane=plane_of(X))
        low.append(rooms_of(ConstraintSettings(**bounds), seen, X).h.min())
        X = X @ exponential(DT_S * alone.step(look_at(seen.features, DT_S, plane_of(X))).twist)
    assert min(low) < -CURVED


@pytest.mark.parametrize("name", ["qp", "mpc"])
def test_walls_ends_of_joints_velocities_and_accelerations_are_kept(name):
    wall = WallSettings((0.0, 0.0, 1.0), float(GOAL[2, 3]) + 0.05)
    law, start = law_of(name, walls={"table": wall}), GOAL @ exponential(np.array([0.1, 0.0, -0.2, 0.0, 0.0, 0.3]))
    X, before, q = start, np.zeros(6), np.zeros(6)
    lower, upper = np.full(6, -np.inf), np.full(6, np.inf)
    lower[0] = -0.05  # the way to the goal is twice as long
    statuses, texts = set(), set()
    for _ in range(150):
        joints, arm, rooms, _ = asked(law, X, before, q=q, lower=lower, upper=upper, velocity=0.2, acceleration=1.0)
        assert np.abs(joints.q_dot).max() <= 0.2 + ROUNDING
        assert np.abs(joints.q_dot - before).max() <= 1.0 * DT_S + ROUNDING
        assert rooms.h.min() > -CURVED * 0.1
        before, q = joints.q_dot, q + DT_S * joints.q_dot
        X = X @ exponential(DT_S * before)
        assert q[0] >= lower[0] - ROUNDING
        statuses.add(joints.status)
        texts.add(joints.text)
    assert q[0] < lower[0] + 0.005 and X[2, 3] < wall.offset_m + 0.01
    assert Status.JOINT_LIMIT in statuses
    assert "at their limits, the others go on: joint 'a'" in texts


@pytest.mark.parametrize("name", ["qp", "mpc"])
def test_what_cannot_be_kept_is_named_with_its_slack_or_the_camera_stands_still(name):
    bounds = {"half_width": 0.1, "half_height": 0.1, "margin": 0.0}  # the object is larger than this view
    joints, arm, _, _ = asked(law_of(name, **bounds), turned(0.5), velocity=0.1)
    assert joints.status == Status.JOINT_LIMIT
    assert "infeasible, slack" in joints.text and "point 1 at the left border by" in joints.text
    assert (joints.q_dot >= arm.low).all() and (joints.q_dot <= arm.high).all()
    joints, _, _, _ = asked(law_of(name, slack=False, **bounds), turned(0.5), velocity=0.1)
    assert joints.status == Status.JOINT_LIMIT and joints.text.startswith("standing still")
    assert not joints.q_dot.any()


def test_moments_of_a_view_without_points_stay_inside_too():
    law = law_of("qp", MOMENTS, half_width=0.3, half_height=0.3, margin=0.0, extent=1.5, rate_per_s=1.0)
    X = turned(0.8, aside_m=0.03)
    seen = view(X, plane=plane_of(X))
    seen.features.point_x = seen.features.point_y = ()
    twist = np.array([-1.0, 0.0, 0.0, 0.0, 0.0, 0.0])  # moves the object to the right
    joints = law.joint_velocity(seen, arm_of(X, twist), twist)
    assert "the object at the right border" in joints.text
    assert joints.q_dot[0] > -1.0


def test_a_joint_that_cannot_brake_in_time_is_named():
    law = law_of("qp")
    X = turned(0.1)
    arm = arm_of(X, np.zeros(6), before=np.full(6, 0.5), q=np.full(6, 0.99), upper=1.0, acceleration=1.0)
    joints = law.joint_velocity(view(X, plane=plane_of(X)), arm, np.zeros(6))
    assert joints.status == Status.JOINT_LIMIT and "braking, too late" in joints.text
    np.testing.assert_allclose(joints.q_dot, 0.5 - DT_S, atol=ROUNDING)


@pytest.mark.parametrize("name", ["qp", "mpc"])
@pytest.mark.parametrize("C", [-1.0, np.nan])
def test_a_depth_that_is_not_known_is_a_view_without_features(name, C):
    law, seen = law_of(name), View(view(GOAL).features, (0.0, 0.0, C))
    with pytest.raises(DegenerateFeature, match="inverse depths"):
        law.joint_velocity(seen, arm_of(GOAL, np.zeros(6)), np.zeros(6))


def test_the_laws_are_for_the_continuous_mode_only():
    from aras_visual_servo.servo.settings import ServoSettings
    section = {"law": "qp", "features": ["points4"], "mode": "look_then_move", "gains_per_s": {"points4": 1.0},
               "thresholds": {"points4": 0.01}, "time_limit_s": 1.0}
    with pytest.raises(ParameterError, match="allowed with law 'qp': continuous"):
        ServoSettings.from_dict(section)


def test_a_point_without_a_finite_rate_is_no_view():
    far = view(GOAL)
    far.features.point_x, far.features.point_y = (1e200,) * 5, (1e200,) * 5  # finite, but not their products
    with pytest.raises(DegenerateFeature, match="no finite place"):
        rooms_of(ConstraintSettings(**VIEW), View(far.features, (0.0, 0.0, 2.0)), GOAL)


@pytest.mark.parametrize("name", ["qp", "mpc"])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_tilt_is_held_where_a_blocked_joint_would_be_made_up_for_by_turning_the_camera(name, sign):
    law = law_of(name, ("xn", "yn", "an", "alpha"))
    X = GOAL @ exponential(np.array([0.1 * sign, 0.0, 0.0, 0.0, 0.0, 0.0]))
    joints, arm, _, twist = asked(law, X, velocity=np.array([0.001, 5.0, 5.0, 5.0, 5.0, 5.0]))
    depth_m = 1.0 / plane_of(X)[2]
    assert abs(arm.wanted[0]) > 0.1
    assert abs(joints.q_dot[4]) < 0.7 * abs(arm.wanted[0]) / depth_m
