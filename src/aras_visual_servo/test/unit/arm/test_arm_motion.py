"""Limits, spare motion and visibility in the closed loop of the servo, on exact pictures."""

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest
from bench import Bench, config, DT_S
from toy_plant import arm, GOAL, START

from aras_visual_servo import ParameterError, Servo, ServoSettings, Status, View
from aras_visual_servo.arm.motion import ArmMotion, LAG_S, LIMIT_HORIZON
from aras_visual_servo.features.interaction import centroid
from aras_visual_servo.servo.visibility import keep_in_view, VisibilitySettings
from aras_visual_servo.spatial import exponential

ACCELERATION = 2.0
#: A joint may use up its room in this time [s].
HORIZON_S = LIMIT_HORIZON * DT_S + LAG_S
STILL = {"posture_gain_per_s": 0.0, "joint_limit_gain_per_s": 0.0}
#: As in the scenario `redundant`: next to the gantry's stop, room in J1 only.
EDGE_GOAL = {"gantry": 1.42, "J1": 0.0, "J2": 0.9, "J3": -0.5, "J5": -0.4, "J6": 0.0}
EDGE_START = {"gantry": 1.47, "J1": 0.8, "J2": 0.95, "J3": -0.45, "J5": -0.5, "J6": -0.6}


class BentBench(Bench):
    """The target lies on the optical axis of the goal."""

    def __init__(self, goal, start, **changes):
        super().__init__(goal, start, **changes)
        self.camera.X_WT[:2, 3] = self.X_WG[:2, 3]
        self.camera.star = None
        self.camera.star = (self.X_WG[2, 3] - 0.19, self.camera.features(self.X_WG).area)
        self.servo.teach(self.camera.features(self.X_WG), self.goal_q, self.camera.star[0])
        self.servo.start(0, self.set_point)


def velocities(bench):
    return np.array([[command.velocity[name] for name in bench.arm.joint_names] for command in bench.commands])


def test_joint_accelerations_keep_their_limits_and_the_servo_arrives():
    joints = dict.fromkeys(arm().joint_names, ACCELERATION)
    bench = Bench(limits={"joint_acceleration": joints})
    assert bench.run().status == Status.CONVERGED
    bench.assert_at_goal()
    q_dot = velocities(bench)[:-1]  # the last one is the stop
    steps = np.abs(np.diff(np.vstack([np.zeros(6), q_dot]), axis=0))
    assert steps.max() <= ACCELERATION * DT_S * (1.0 + 1e-9)
    free = Bench()
    free.step()
    assert np.abs(velocities(free)[0]).max() > 10.0 * ACCELERATION * DT_S  # what the first step is without the limit


def test_the_first_twist_under_an_acceleration_limit_has_the_direction_of_the_law():
    joints = dict.fromkeys(arm().joint_names, ACCELERATION)
    bench = Bench(limits={"joint_acceleration": joints}, null_space=STILL)
    q = bench.q.copy()
    bench.step()
    free = Bench(null_space=STILL)
    free.step()
    slow, fast = velocities(bench)[0], velocities(free)[0]
    np.testing.assert_allclose(slow / np.linalg.norm(slow), fast / np.linalg.norm(fast), atol=1e-9)
    np.testing.assert_allclose(bench.records[0].twist, bench.arm.jacobian(q) @ slow, atol=1e-12)


def test_camera_speed_limits_shorten_the_twist_as_a_whole():
    bench, free = Bench(limits={"camera_speed_m_s": 0.05, "camera_turn_rad_s": 0.1}), Bench()
    for each in (bench, free):
        each.step()
    twist, wanted = bench.records[0].twist, free.records[0].twist
    assert np.linalg.norm(twist[:3]) <= 0.05 * (1 + 1e-9) and np.linalg.norm(twist[3:]) <= 0.1 * (1 + 1e-9)
    np.testing.assert_allclose(twist / np.linalg.norm(twist), wanted / np.linalg.norm(wanted), atol=1e-9)
    assert bench.run().status == Status.CONVERGED


@pytest.mark.parametrize("inverse, null_space, arrives", [
    ({"method": "naive"}, STILL, False), ({"method": "naive", "at_limits": "saturate"}, STILL, True),
    ({"method": "damped", "at_limits": "saturate"}, {}, True)])
def test_joints_that_are_not_at_a_limit_go_on(inverse, null_space, arrives):
    bench = BentBench(EDGE_GOAL, EDGE_START, inverse=inverse, null_space=null_space, time_limit_s=6.0)
    last = bench.run()
    assert (last.status == Status.CONVERGED) == arrives
    assert Status.JOINT_LIMIT in {record.status for record in bench.records}
    for record in bench.records:
        assert (record.q >= bench.arm.lower + 0.01 - 1e-9).all() and (record.q <= bench.arm.upper - 0.01 + 1e-9).all()
    if arrives:
        bench.assert_at_goal()


def test_manipulability_gradient_bends_the_arm_where_it_may():
    wanted = {"posture_gain_per_s": 0.0, "joint_limit_gain_per_s": 0.0, "projection": "large"}
    start = {**GOAL, "gantry": -0.1, "J2": -0.2, "J3": 0.1, "J5": 0.1}
    ends = []
    for gain in (0.0, 0.05):
        bench = Bench(start=start, null_space={**wanted, "manipulability_gain_per_s": gain})
        for _ in range(8):
            bench.step()
        ends.append(bench.arm.manipulability(bench.q, 0.05, [0, 1, 2, 5])[0])
    assert ends[1] > 1.2 * ends[0]


def test_projection_onto_the_norm_keeps_the_rate_of_approach():
    rates = []
    for null_space in (STILL, {"projection": "large", "posture_gain_per_s": 0.0, "joint_limit_gain_per_s": 3.0}):
        bench = Bench(null_space=null_space, tilt_gain_per_s=3.0, limits={})
        bench.run()
        assert bench.records[-1].status == Status.CONVERGED
        rates.append(np.linalg.norm(bench.records[12].twist * [20, 20, 20, 1, 1, 1])
                     / np.linalg.norm(bench.records[2].twist * [20, 20, 20, 1, 1, 1]))
    # ten images of a law of 3 /s shrink the twist by exp(-1) in both, to the order of what the arm turns in one image
    np.testing.assert_allclose(rates, np.exp(-3.0 * 10 * DT_S), rtol=0.1)


# --- visibility ---------------------------------------------------------------------------------------------------

VIEW = VisibilitySettings(half_width=0.5, half_height=0.4, margin=0.02)


def edges(features, extent=2.0):
    n20, n02 = (dict(zip(features.moment_names, features.mu))[name] / features.area for name in ("20", "02"))
    return np.array([abs(features.xg) + extent * n20**0.5, abs(features.yg) + extent * n02**0.5])


def test_a_twist_that_keeps_the_object_inside_is_left_alone():
    features = Bench(start=GOAL).look().features
    twist = np.array([0.01, 0.02, -0.01, 0.0, 0.0, 0.1])
    kept, bent = keep_in_view(VIEW, features, twist)
    assert kept is twist and not bent


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_edge_uses_up_its_room_no_faster_than_asked(sign):
    features = Bench(start=GOAL).look().features
    twist = np.array([sign * 2.0, 0.5, 0.3, 0.0, 0.0, 0.4])
    kept, bent = keep_in_view(VIEW, features, twist)
    assert bent and kept[0] != twist[0] and (kept[1:] == twist[1:]).all()
    view = View(features, np.array([0.0, 0.0, 1.0 / features.an]))
    n, area = view.mu["20"] / features.area, features.area
    L_edge = -sign * centroid(view.m, view.plane)[0] + (view.L_mu(2, 0) - n * view.L_area()) / area / n**0.5
    room = VIEW.half_width - VIEW.margin + sign * features.xg - 2.0 * n**0.5
    assert float(L_edge @ kept) == pytest.approx(VIEW.rate_per_s * room, rel=1e-9)


def test_an_object_that_would_leave_the_view_stays_and_the_servo_arrives():
    # A turn that is five times as fast as what makes up for it sideways swings the object across the view.
    def view_left(**changes):
        gains = {"xn": 2.0, "yn": 2.0, "an": 2.0, "alpha": 10.0}
        bench = Bench(start={**START, "J6": 1.6, "gantry": -0.13}, law="paper", gains_per_s=gains, **changes)
        outside = []
        while not bench.servo.finished:
            outside.append((edges(bench.look().features) - [view.half_width, view.half_height]).max())
            bench.step()
        return max(outside), bench

    view = VisibilitySettings(half_width=0.42, half_height=0.42, margin=0.02)
    worst, _ = view_left()
    kept, bench = view_left(visibility=dataclasses.asdict(view))
    assert worst > 0.015 and kept < -0.015
    assert bench.records[-1].status == Status.CONVERGED
    assert any(record.status_text == "servoing, kept in view" for record in bench.records)


@pytest.mark.parametrize("bad, word", [
    ({"inverse": {"at_limits": "clip"}}, "at_limits"), ({"null_space": {"projection": "small"}}, "projection"),
    ({"null_space": {"projection": "large", "large_from": [0.3, 0.3]}}, "large_from"),
    ({"limits": {"joint_acceleration": {"J9": 1.0}}}, "J9"), ({"limits": {"camera_speed_m_s": 0.0}}, "camera_speed"),
    ({"visibility": {"half_width": 0.5}}, "half_height"), ({"limits": {"surprise": 1}}, "surprise")])
def test_faults_of_the_sections_are_named(bad, word):
    with pytest.raises(ParameterError, match=word):
        Servo(arm(), config(**bad))


@pytest.mark.parametrize("beyond_m", [-0.001, 0.0, 0.002, 0.005])
@pytest.mark.parametrize("at_limits", ["saturate", "scale"])
def test_a_joint_at_its_margin_under_an_acceleration_limit_does_not_stop_the_others(beyond_m, at_limits):
    edge = float(arm().upper[arm().joint_names.index("gantry")]) - 0.01
    bench = BentBench(EDGE_GOAL, {**EDGE_START, "gantry": edge + beyond_m}, time_limit_s=8.0,
                      inverse={"at_limits": at_limits},
                      limits={"joint_acceleration": dict.fromkeys(GOAL, 5.0)})
    last = bench.run()
    assert last.status == Status.CONVERGED or "gantry" in last.status_text
    if at_limits == "saturate":
        bench.assert_at_goal()


def test_a_joint_with_little_room_uses_it_and_the_others_make_up_for_the_rest():
    kinematics = arm()
    setup = ServoSettings.from_dict(config(inverse={"at_limits": "saturate"}, null_space=STILL), kinematics.joint_names)
    motion = ArmMotion(kinematics, setup, sees_tilt=False)
    q = kinematics.vector({**EDGE_START, "J1": 0.4})
    twist = kinematics.jacobian(q) @ kinematics.vector(
        {"gantry": 0.3, "J1": 0.05, "J2": 0.0, "J3": 0.0, "J5": 0.0, "J6": 0.1})
    gantry = kinematics.joint_names.index("gantry")
    q[gantry] = motion.upper[gantry] - 0.1 * HORIZON_S  # room for 0.1 m/s
    found = motion.joint_velocity(q, twist, *motion.at(q), DT_S)
    assert found.status == Status.JOINT_LIMIT and "gantry" in found.text
    assert found.q_dot[gantry] == pytest.approx(0.1, rel=1e-9)
    np.testing.assert_allclose(found.twist, twist, atol=1e-9)


def moving(**changes):
    """(`ArmMotion`, joint positions in the middle of their ranges, looking down) of an arm that only this limits."""
    kinematics = arm()
    setup = ServoSettings.from_dict(config(null_space=STILL, **changes), kinematics.joint_names)
    return ArmMotion(kinematics, setup, sees_tilt=False), kinematics.vector({**GOAL, "J2": -0.4, "J3": 0.5})


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("limit, twist, rows", [
    ("camera_speed_m_s", (0.03, 0.04, 0.0, 0.0, 0.0, 0.02), slice(0, 3)),
    ("camera_turn_rad_s", (0.03, 0.04, 0.0, 0.0, 0.0, 0.2), slice(3, 6))])
def test_either_speed_limit_of_the_camera_binds_alone(limit, twist, rows, sign):
    twist = sign * np.array(twist)
    motion, q = moving(limits={limit: 0.01})
    found = motion.joint_velocity(q, twist, *motion.at(q), DT_S)
    np.testing.assert_allclose(found.twist, twist * (0.01 / np.linalg.norm(twist[rows])), atol=1e-12)
    done = motion._kinematics.jacobian(q) @ found.q_dot
    assert np.linalg.norm(done[rows]) == pytest.approx(0.01, rel=0.02)  # the Jacobian turns on the way


@pytest.mark.parametrize("side", ["upper", "lower"])
@pytest.mark.parametrize("room", [0.0, 0.004])
def test_a_joint_at_either_limit_moves_no_further_than_its_room(side, room):
    motion, q = moving(inverse={"at_limits": "saturate"})
    sign, gantry = (1.0 if side == "upper" else -1.0), motion._kinematics.joint_names.index("gantry")
    q[gantry] = getattr(motion, side)[gantry] - sign * room
    twist = motion._kinematics.jacobian(q) @ motion._kinematics.vector(
        {"gantry": sign * 0.3, "J1": 0.05, "J2": 0.0, "J3": 0.0, "J5": 0.0, "J6": 0.1})
    found = motion.joint_velocity(q, twist, *motion.at(q), DT_S)
    assert found.status == Status.JOINT_LIMIT and "gantry" in found.text
    assert found.q_dot[gantry] == pytest.approx(sign * room / HORIZON_S, abs=1e-12)
    assert np.abs(np.delete(found.q_dot, gantry)).max() > 0.01


def moving_arm(**changes):
    bench = Bench(start=GOAL, **changes)
    arm_motion, q = bench.servo._arm, bench.arm.vector({**GOAL, "J2": -0.5, "J3": 0.9, "J5": -0.4})
    return arm_motion, q, arm_motion.at(q)


def test_after_a_rest_the_next_motion_begins_at_zero():
    limits = {"joint_acceleration": dict.fromkeys(GOAL, 0.5)}
    arm_motion, q, at = moving_arm(limits=limits)
    fresh = moving_arm(limits=limits)[0]
    twist = np.array([0.05, 0.02, 0.0, 0.0, 0.0, 0.3])
    first = arm_motion.joint_velocity(q, twist, *at, DT_S)
    assert np.abs(arm_motion.joint_velocity(q, twist, *at, DT_S).q_dot).max() > 1.5 * np.abs(first.q_dot).max()
    arm_motion.rest()
    again, wanted = arm_motion.joint_velocity(q, twist, *at, DT_S), fresh.joint_velocity(q, twist, *at, DT_S)
    np.testing.assert_array_equal(again.q_dot, wanted.q_dot)


def test_the_correction_for_the_turn_of_the_jacobian_is_a_quarter_at_most():
    arm_motion, _, _ = moving_arm()
    q = moving_arm()[0]._kinematics.vector({**GOAL, "J2": -0.002, "J3": 0.004, "J5": 0.0})  # next to the stretched arm
    jacobian, inverse = arm_motion.at(q)
    q_dot = np.full(6, 1.0)
    added = arm_motion.turning(q, q_dot, jacobian, inverse, 1.0)
    assert np.linalg.norm(added) == pytest.approx(0.25 * np.linalg.norm(q_dot), rel=1e-9)


@pytest.mark.parametrize("part, near", [(0.05, False), (0.15, True)])
@pytest.mark.parametrize("size, heard", [(1.0, True), (1e-4, False)])
def test_near_a_singularity_is_where_a_tenth_of_the_twist_is_lost(part, near, size, heard, monkeypatch):
    """What is lost is put in the place of the inverse's own; below 1 mrad/s it is noise."""
    arm_motion, q, (jacobian, inverse) = moving_arm()
    twist = size * np.array([0.01, 0.0, 0.0, 0.0, 0.0, 0.1])
    monkeypatch.setattr(type(inverse), "lost", lambda self, twist: part * float(np.linalg.norm(twist)))
    motion = arm_motion.joint_velocity(q, twist, jacobian, inverse, DT_S)
    assert (motion.status == Status.NEAR_SINGULARITY) == (near and heard)


def test_the_speed_limit_of_a_joint_slows_the_twist_as_a_whole():
    motion, q = moving()
    jacobian, inverse = motion.at(q)
    for gantry, factor in ((10.0, 0.5), (4.0, 1.0)):  # the limit is 5 m/s
        twist = jacobian @ motion._kinematics.vector({**dict.fromkeys(GOAL, 0.0), "gantry": gantry, "J6": 0.5})
        found = motion.joint_velocity(q, twist, jacobian, inverse, 1e-9)  # the Jacobian has no time to change
        np.testing.assert_allclose(found.twist, factor * twist, rtol=1e-6)
        np.testing.assert_allclose(jacobian @ found.q_dot, found.twist, atol=1e-6)


@pytest.mark.parametrize("rests, status", [(False, Status.NEAR_SINGULARITY), (True, None)])
def test_a_joint_that_reverses_from_image_to_image_is_told_until_the_arm_rests(rests, status):
    motion, q = moving()
    jacobian, inverse = motion.at(q)
    for q_dot in (1.0, -1.0, 1.0, -1.0):  # a fifth of the joint's limit
        if rests:
            motion.rest()
        twist = jacobian @ motion._kinematics.vector({**dict.fromkeys(GOAL, 0.0), "J6": q_dot})
        found = motion.joint_velocity(q, twist, jacobian, inverse, DT_S)
    assert found.status == status and ("J6" in found.text) == (not rests)


@pytest.mark.parametrize("turn", [(0.3, -0.2), (-1.0, 0.4), (0.0, 0.0)])
def test_the_tilt_is_the_turn_since_the_taught_axis_and_is_turned_back_at_its_gain(turn):
    motion = moving()[0]
    inverse = SimpleNamespace(turn_about=lambda turn, point: (*turn, point))
    taught = exponential(np.array([0.1, 0.2, 0.3, 0.7, -1.1, 0.4]))
    here = taught @ exponential(np.array([0.0, 0.0, 0.5, *turn, 0.0]))
    assert motion.tilt_of(here) is None
    np.testing.assert_array_equal(motion.tilt(here, inverse, 2.0, "point"), np.zeros(6), strict=True)
    motion.set_reference(SimpleNamespace(posture=None, optical_axis_B=taught[:3, 2]))
    assert motion.tilt_of(here) == pytest.approx(turn, abs=1e-12)
    x, y, point = motion.tilt(here, inverse, 2.0, "point")
    assert (x, y) == pytest.approx((-2.0 * turn[0], -2.0 * turn[1]), abs=1e-12) and point == "point"


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("room", [0.004, -0.004])
@pytest.mark.parametrize("at_limits", ["scale", "saturate"])
def test_a_joint_that_brakes_too_late_goes_to_its_end_at_most(at_limits, room, sign):
    motion, q = moving(inverse={"at_limits": at_limits}, limits={"joint_acceleration": dict.fromkeys(GOAL, 5.0)})
    gantry, (jacobian, inverse) = motion._kinematics.joint_names.index("gantry"), motion.at(q)
    q_dot = motion._kinematics.vector({**dict.fromkeys(GOAL, 0.0), "gantry": 2.0 * sign, "J6": 0.1})
    told = motion.told(q_dot, jacobian, Status.JOINT_LIMIT, "why")
    np.testing.assert_array_equal(told.twist, jacobian @ q_dot)
    assert told.q_dot is q_dot and told[2:] == (Status.JOINT_LIMIT, "why")
    q[gantry] = (motion.upper if sign > 0.0 else motion.lower)[gantry] - sign * room
    found = motion.joint_velocity(q, jacobian @ q_dot, jacobian, inverse, DT_S)
    assert found.q_dot[gantry] == pytest.approx(sign * max(0.0, room) / DT_S, abs=1e-9)


def test_a_motion_is_split_into_what_moves_the_camera_and_what_does_not():
    motion = moving()[0]
    stretched = motion._kinematics.vector({**GOAL, "J2": 0.4, "J3": 0.0, "J5": 0.8})
    free = np.linalg.svd(motion.at(stretched)[0])[2][-1]  # the one motion of the joints that the camera does not see
    q_dot = motion._kinematics.vector({**dict.fromkeys(GOAL, 0.1), "J2": -0.2, "J6": 0.3})
    moves, null = motion.split(stretched, q_dot)
    assert abs(free @ q_dot) > 0.05
    np.testing.assert_allclose(null, (free @ q_dot) * free, atol=1e-9)
    np.testing.assert_allclose(moves, q_dot - null, atol=1e-15)
