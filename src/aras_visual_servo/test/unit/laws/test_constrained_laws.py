"""Laws that choose joint velocities within constraints: qp and mpc, on exact pictures."""

from types import SimpleNamespace

import numpy as np
import pytest
from constrained import arm_of, asked, DT_S, fly, GOAL, law_of, MOMENTS, POINTS, ROUNDING, turned, VIEW
from views import assert_same, differences, look_at, plane_of, tilted_pose, view

from aras_visual_servo import DegenerateFeature, FeatureSet, ParameterError, Status, View
from aras_visual_servo.laws import qp
from aras_visual_servo.laws.constraints import ConstraintSettings, rooms_of, WallSettings
from aras_visual_servo.laws.mpc import _contour, _poses, _rooms_of_contour, CONTOUR, MpcSettings, predicted_points
from aras_visual_servo.spatial import exponential, exponentials

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


def test_what_standing_still_would_violate_is_named():
    rooms = SimpleNamespace(names=("a", "b", "c", "d"))
    assert qp.asked(rooms, np.array([-0.2, 0.3, 0.0, 1.5])) == ["b", "d"]
    assert not set(qp.asked(rooms, np.array([-0.2, 0.0, -0.1, -1.0]))) & set(rooms.names)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("joint", [0, 3, 5])
def test_a_joint_at_either_end_of_its_way_is_named_and_stands(joint, sign):
    law, X, q = law_of("qp", half_width=5.0, half_height=5.0), turned(0.1), np.zeros(6)
    q[joint] = sign
    wanted = 0.1 * q
    joints = law.joint_velocity(view(X, plane=plane_of(X)), arm_of(X, wanted, q=q, lower=-1.0, upper=1.0), wanted)
    assert joints.status == Status.JOINT_LIMIT and joints.q_dot[joint] == pytest.approx(0.0, abs=ROUNDING)
    assert joints.text == f"at their limits, the others go on: joint '{'abcdef'[joint]}'"
    velocity = np.full(6, 5.0)
    velocity[joint] = 0.05
    joints = law.joint_velocity(view(X, plane=plane_of(X)), arm_of(X, wanted, velocity=velocity), wanted)
    assert joints.status is None and joints.q_dot[joint] == pytest.approx(0.05 * sign)
    assert joints.text == f"servoing, held back by joint '{'abcdef'[joint]}'"


def test_what_pushes_a_millionth_of_what_pushes_most_is_not_named():
    multipliers = np.zeros(2 + 2 * 6)
    multipliers[:2] = 1.0, 0.5 * qp.BINDS
    joints = law_of("qp")._answer(arm_of(GOAL, np.zeros(6)), ("a border", "a wall"), np.zeros(6), multipliers)
    assert joints.text == "servoing, held back by a border"


@pytest.mark.parametrize("features", [POINTS, ("xn", "yn", "an", "alpha")])
def test_the_metric_weighs_each_feature_and_each_joint_on_the_scale_of_one(features):
    law, jacobian = law_of("qp", features, damping=0.01), np.diag([1.0, 2.0, 3.0, 1.0, 1.0, 0.5])
    L = FeatureSet(features).matrix(view(GOAL, plane=plane_of(GOAL)))
    seen = L.T @ L * (6.0 / np.trace(L.T @ L))
    if features is not POINTS:
        seen += np.diag([0.0, 0.0, 0.0, 1.0, 1.0, 0.0])
    H = jacobian @ seen @ jacobian
    np.testing.assert_allclose(law.metric(view(GOAL, plane=plane_of(GOAL)), jacobian),
                               H * (6.0 / np.trace(H)) + 0.01 * np.eye(6), atol=ROUNDING)


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
@pytest.mark.parametrize("plane", [(0.0, 0.0, -1.0), (0.0, 0.0, np.nan), (20.0, 0.0, 1.0)])  # one or all of them
def test_a_depth_that_is_not_known_is_a_view_without_features(name, plane):
    law, seen = law_of(name), View(view(GOAL).features, plane)
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


def test_predicted_points_and_their_rows_are_those_of_the_moved_camera():
    X, plan = tilted_pose(3), np.random.default_rng(0).normal(0.0, 0.1, (4, 6))
    P = np.random.default_rng(1).uniform((-0.1, -0.1, 0.4), (0.1, 0.1, 0.8), (5, 3)).T

    def picture(pose):
        x, y, Z = (np.linalg.inv(pose) @ np.vstack([P, np.ones(5)]))[:3]
        return np.ravel([x / Z, y / Z, Z], order="F")

    poses = _poses(np.eye(6), plan, 0.1, 6)
    at, rows = predicted_points(P, poses)
    for pose, here, row in zip(poses, at, rows):
        np.testing.assert_allclose(here, picture(pose), atol=ROUNDING)
        # A twist in the first frame comes before the way: X exp(twist) X^-1 pose, with X = 1.
        assert_same(row, differences(lambda Y: picture(np.linalg.inv(X) @ Y @ pose), X))
    at, _ = predicted_points(np.array([[0.01], [-0.02], [-0.3]]), np.eye(4)[None])  # as if it were 20 mm ahead
    np.testing.assert_allclose(at, [[0.5, -1.0, 0.02]])


def test_a_horizon_shorter_than_its_moves_is_refused():
    assert list(MpcSettings(horizon=3, moves=4).check()) == ["moves: found 4, allowed at most horizon, 3"]
    assert not list(MpcSettings(horizon=4, moves=4).check())


def test_after_standing_still_no_earlier_plan_is_followed():
    bounds = {"half_width": 0.33, "half_height": 0.33, "margin": 0.0, "slack": False}
    outside = turned(0.0, aside_m=2.0)
    law, fresh = law_of("mpc", **bounds), law_of("mpc", **bounds)
    assert asked(law, turned(1.0))[0].q_dot.any()
    assert not asked(law, outside, velocity=0.1)[0].q_dot.any()
    before = np.full(6, 0.01)  # moving: a plan that is under way would be taken up again
    np.testing.assert_array_equal(asked(law, turned(0.8), before)[0].q_dot, asked(fresh, turned(0.8), before)[0].q_dot)


def test_the_first_plan_of_mpc_is_about_joints_that_slow_down_as_the_error_does():
    law, wanted = law_of("mpc", gain=3.0, period_s=0.1, moves=4, horizon=10), np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    nominal = law._nominal(arm_of(GOAL, wanted))
    came = -np.expm1(-3.0 * np.array([0.0, 0.1, 0.2, 0.3, 1.0])) / 3.0  # the way of the error, of a rate of 3 per s
    mean = np.diff(came) / [0.1, 0.1, 0.1, 0.7]  # the last move is held for seven steps
    np.testing.assert_allclose(nominal, mean[:, None] * wanted, atol=ROUNDING)


@pytest.mark.parametrize("features", [POINTS, MOMENTS, ("xn", "yn", "an", "alpha")])
def test_a_camera_on_the_wanted_way_lacks_nothing_of_it(features):
    law, seen = law_of("mpc", features), view(GOAL, plane=plane_of(GOAL))
    twist = np.array([0.1, 0.0, -0.2, 0.0, 0.0, 0.5])
    way = exponentials(np.outer(law._worth, twist))
    *_, lack = law._predict(seen, twist, way, law._ahead(seen, arm_of(GOAL, twist)))
    np.testing.assert_allclose(lack, 0.0, atol=ROUNDING)


def test_the_rows_of_a_plan_are_its_velocities_its_ends_and_its_changes():
    law, plan = law_of("mpc", horizon=6, moves=3, period_s=0.1), np.random.default_rng(3).normal(size=(3, 6))
    arm = arm_of(GOAL, plan[0], q=0.1 * plan[1], lower=-1.0, upper=2.0, velocity=4.0, acceleration=3.0)
    C, c = law._joint_rows(arm, 6)
    ends, changes = arm.q + np.cumsum(plan * [[0.1], [0.1], [0.4]], axis=0), np.diff(plan, axis=0)  # the last: 4 steps
    expected = [plan[:1] - arm.low, arm.high - plan[:1], 4.0 + plan[1:], 4.0 - plan[1:], 1.0 + ends, 2.0 - ends,
                0.3 + changes, 0.3 - changes]
    np.testing.assert_allclose(C @ plan.ravel() - c, np.concatenate(expected).ravel(), atol=ROUNDING)


def test_a_contour_contains_the_ellipse_of_the_moments_and_its_rooms_are_those_to_the_borders():
    seen = view(turned(0.3, aside_m=0.02))
    f, mu = seen.features, seen.mu
    contour, middle = _contour(seen, 1.5), np.array([f.xg, f.yg])
    n = np.array([[mu["20"], mu["11"]], [mu["11"], mu["02"]]]) / f.area
    for angle in np.linspace(0.0, 2.0 * np.pi, 100):
        towards = np.array([np.cos(angle), np.sin(angle)])
        reach, ellipse = ((contour - middle) @ towards).max(), 1.5 * np.sqrt(towards @ n @ towards)
        assert ellipse * (1.0 - ROUNDING) <= reach <= ellipse / np.cos(np.pi / CONTOUR) * (1.0 + ROUNDING)
    X = turned(0.3, aside_m=0.02)
    pointless = view(X, plane=plane_of(X))
    pointless.features.point_x = pointless.features.point_y = ()
    x, y = contour.T
    before_m = 1.0 / float(plane_of(X) @ [f.xg, f.yg, 1.0]) - 0.04
    for walls, rooms_m in (({}, []), ({"table": WallSettings((0.0, 0.0, 1.0), 0.1)}, [X[2, 3] - 0.1])):
        settings = ConstraintSettings(**VIEW, least_depth_m=0.04, walls=walls)
        rooms = _rooms_of_contour(settings, contour, rooms_of(settings, pointless, X))
        expected = [0.55 + x, 0.55 - x, 0.45 + y, 0.45 - y, np.full(CONTOUR, before_m), rooms_m]
        np.testing.assert_allclose(rooms.h, np.concatenate(expected), atol=ROUNDING)
        assert rooms.names[5 * CONTOUR:] == tuple(f"wall '{name}'" for name in walls)


@pytest.mark.parametrize("features", [POINTS, MOMENTS])
def test_a_plan_about_which_nothing_is_possible_is_made_anew_about_braking(features):
    law = law_of("mpc", features, **VIEW)
    X, before = turned(0.3), np.full(6, 0.01)
    law._plan = np.tile([0.0, 0.0, 3.0, 0.0, 0.0, 0.0], (law.settings.moves, 1))  # through the object and far beyond
    seen = view(X, plane=plane_of(X))
    if features is MOMENTS:
        seen.features.point_x = seen.features.point_y = ()
    twist = np.array([0.0, 0.0, 0.1, 0.0, 0.0, 0.2])
    arm = arm_of(X, twist, before, acceleration=1.0)
    ahead, braking = law._ahead(seen, arm), law._braking(arm)
    assert not law._solve(*law._program(seen, arm, twist, law._plan, ahead))[3]
    joints = law.joint_velocity(seen, arm, twist)
    assert "infeasible" not in joints.text and joints.q_dot[5] > before[5]
    law._plan = braking
    np.testing.assert_array_equal(law.joint_velocity(seen, arm, twist).q_dot, joints.q_dot)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_braking_ends_at_rest_and_keeps_the_accelerations(sign):
    law = law_of("mpc", period_s=0.1, moves=4)
    braking = law._braking(arm_of(GOAL, np.zeros(6), before=np.full(6, 0.25 * sign), acceleration=1.0))
    expected = np.maximum(0.25 - DT_S - 0.1 * np.arange(4), 0.0)  # the first move is commanded for one image's period
    np.testing.assert_allclose(braking, sign * np.tile(expected, (6, 1)).T, atol=ROUNDING)


def missed_rooms(law, X, plan):
    """Names of the rooms that a plan, (4, 6), leaves by, when it was linearised about standing still."""
    seen, arm = view(X, plane=plane_of(X)), arm_of(X, np.zeros(6))
    ahead = law._ahead(seen, arm)
    return {ahead.names[place] for place in law._missed(arm, ahead, plan.ravel(), np.zeros((4, 6)))}


@pytest.mark.parametrize("features", [POINTS, MOMENTS])
def test_what_is_linearised_wrongly_is_found_out_and_less_of_the_plan_is_commanded(features):
    X = turned(0.0)
    size = np.abs([view(X).features.point_x, view(X).features.point_y]).max() + 0.05
    law, seen = law_of("mpc", features, half_width=size, half_height=size, margin=0.0), view(X, plane=plane_of(X))
    if features is MOMENTS:
        seen.features.point_x = seen.features.point_y = ()
    twist = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 12.0])  # a point's straight way on leaves the circle that it is seen on
    before, acceleration = np.array([0.2] + [0.01] * 5), np.array([2.0] + [np.inf] * 5)  # the first joint has to brake
    arm = arm_of(X, twist, before=before, acceleration=acceleration)
    law._plan = np.tile([0.0, 0.0, 3.0, 0.0, 0.0, 0.0], (4, 1))  # through the object: nothing is possible about it
    ahead, stop = law._ahead(seen, arm), law._braking(arm)
    whole = law._solve(*law._program(seen, arm, twist, stop, ahead))[0]
    assert law._missed(arm, ahead, whole, stop) and not law._missed(arm, ahead, stop.ravel(), stop)
    joints = law.joint_velocity(seen, arm, twist)
    assert not law._missed(arm, ahead, law._plan.ravel(), stop)
    missed = {ahead.names[place] for place in law._missed(arm, ahead, 2.0 * law._plan.ravel(), stop)}
    assert missed and all(name in joints.text for name in missed) and joints.text.startswith("servoing, held back by")
    slower = [stop[0] + 0.5**k * (whole[:6] - stop[0]) for k in range(1, 6)]
    assert min(np.abs(joints.q_dot - part).max() for part in slower) < ROUNDING
    assert (joints.q_dot > arm.low - ROUNDING).all() and (joints.q_dot < arm.high + ROUNDING).all()


@pytest.mark.parametrize("angle_rad", [1.5, -1.5])
def test_a_plan_that_only_seems_possible_is_made_anew(angle_rad):
    X = turned(angle_rad)
    size = max(np.abs([view(Y).features.point_x, view(Y).features.point_y]).max() for Y in (X, GOAL)) + 0.1
    law = law_of("mpc", MOMENTS, gain=5.0, interaction="mean", half_width=size, half_height=size, margin=0.0)
    seen = view(X, plane=plane_of(X))
    twist = law.step(look_at(seen.features, DT_S, plane_of(X))).twist
    seen.features.point_x = seen.features.point_y = ()
    arm = arm_of(X, twist, velocity=50.0)
    ahead, plan = law._ahead(seen, arm), law._nominal(arm)
    x, _, _, feasible = law._solve(*law._program(seen, arm, twist, plan, ahead))
    assert feasible and law._missed(arm, ahead, x, plan)
    law.joint_velocity(seen, arm, twist)
    assert not law._missed(arm, ahead, law._plan.ravel(), np.zeros_like(plan))


@pytest.mark.parametrize("axis, at, border", [
    (0, -0.7, "left"), (0, 0.7, "right"), (1, -0.6, "upper"), (1, 0.6, "lower")])
def test_the_border_that_a_plan_would_leave_by_is_named(axis, at, border):
    law, X, plan = law_of("mpc", **VIEW), turned(0.0), np.zeros((4, 6))
    plan[:, axis] = -at / plane_of(X)[2]  # in a second the picture moves so far
    missed = missed_rooms(law, X, plan)
    assert missed and {name.split()[-2] for name in missed} == {border}


def test_a_plan_through_a_wall_or_too_near_to_the_object_is_found_out():
    X, plan = turned(0.0), np.zeros((4, 6))
    wall = WallSettings((0.0, 0.0, 1.0), float(X[2, 3]) - 0.1)
    law = law_of("mpc", walls={"table": wall}, least_depth_m=0.2)
    plan[:, :3] = X[:3, :3].T @ (0.0, 0.0, -0.15)
    assert missed_rooms(law, X, plan) == {"wall 'table'"}
    plan[:] = 0.0
    plan[:, 2] = 1.0 / plane_of(X)[2] - 0.15
    assert "point 1 before the camera" in missed_rooms(law, X, plan)


@pytest.mark.parametrize("interaction", ["current", "mean"])
@pytest.mark.parametrize("angle_rad", [0.5, 2.5, -2.5])
def test_where_nothing_binds_mpc_begins_as_ibvs_does_also_in_large_turns(interaction, angle_rad):
    law = law_of("mpc", gain=1.0, interaction=interaction, half_width=50.0, half_height=50.0, least_depth_m=0.01)
    joints, arm, _, _ = asked(law, turned(angle_rad), velocity=50.0)
    begins = law._fall[0] * arm.wanted
    assert np.abs(joints.q_dot - begins).max() < 0.05 * np.abs(begins).max()
