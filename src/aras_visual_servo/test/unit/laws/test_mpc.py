"""What mpc predicts and plans: rooms along its plan, plans that are missed, made anew or ended by braking."""

import numpy as np
import pytest
from constrained import arm_of, asked, DT_S, GOAL, law_of, MOMENTS, POINTS, ROUNDING, turned, VIEW
from views import assert_same, differences, look_at, plane_of, tilted_pose, view

from aras_visual_servo.laws.constraints import ConstraintSettings, rooms_of, WallSettings
from aras_visual_servo.laws.mpc import _contour, _poses, _rooms_of_contour, CONTOUR, MpcSettings, predicted_points


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


def test_a_horizon_shorter_than_its_moves_is_refused():
    assert list(MpcSettings(horizon=3, moves=4).check()) == ["moves: found 4, allowed at most horizon, 3"]


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


def test_a_contour_contains_the_ellipse_of_the_moments_and_its_rooms_are_those_to_the_borders():
    seen = view(turned(0.3, aside_m=0.02))
    f, mu = seen.features, seen.mu
    contour, middle = _contour(seen, 1.5), np.array([f.xg, f.yg])
    n = np.array([[mu["20"], mu["11"]], [mu["11"], mu["02"]]]) / f.area
    for angle in np.linspace(0.0, 2.0 * np.pi, 100):
        towards = np.array([np.cos(angle), np.sin(angle)])
        reach, ellipse = ((contour - middle) @ towards).max(), 1.5 * np.sqrt(towards @ n @ towards)
        assert ellipse * (1.0 - ROUNDING) <= reach <= ellipse / np.cos(np.pi / CONTOUR) * (1.0 + ROUNDING)
    settings = ConstraintSettings(**VIEW)
    X = turned(0.3, aside_m=0.02)
    pointless = view(X, plane=plane_of(X))
    pointless.features.point_x = pointless.features.point_y = ()
    h = _rooms_of_contour(settings, contour, rooms_of(settings, pointless, X)).h[:4 * CONTOUR].reshape(4, CONTOUR)
    x, y = contour.T
    np.testing.assert_allclose(h, [0.55 + x, 0.55 - x, 0.45 + y, 0.45 - y], atol=ROUNDING)


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
