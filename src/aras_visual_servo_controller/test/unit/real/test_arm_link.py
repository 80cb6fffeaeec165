"""What goes to a real arm: set-points within limits, and rest in the very period in which something is wrong."""

import numpy as np
import pytest
from toy_plant import arm, GOAL

from aras_visual_servo import Command, make_form, RealSettings
from aras_visual_servo_controller.real.arm_link import ArmLink

MS = 1_000_000
PERIOD_S = 0.008
KINEMATICS = arm()
NAMES = KINEMATICS.joint_names
START = KINEMATICS.vector(GOAL)
SLOW = {"gantry": 0.1, "J2": 0.05}
#: Sums of products of the order of one: some eps.
ROUNDING = 1e-9


class Bench:
    """A link with time: joint states and the dead-man's switch come in every period unless told otherwise."""

    def __init__(self, **settings):
        self.settings = RealSettings.from_dict({"joint_acceleration": 1000.0, **settings}, NAMES)
        self.link = ArmLink(KINEMATICS, self.settings, command_timeout_s=0.2)
        self.now_ns, self.q, self.ticks = 1_000 * MS, START.copy(), []
        self.joints_come, self.held = True, True

    def run(self, periods=1, step_ms=8):
        for _ in range(periods):
            self.now_ns += step_ms * MS
            if self.joints_come:
                self.link.joints(self.now_ns, self.q, self.now_ns)
            if self.held is not None:
                self.link.deadman(self.held, self.now_ns)
            self.ticks.append(self.link.tick(self.now_ns))
            if self.ticks[-1].point is not None:
                self.q = np.array(self.ticks[-1].point.position)
        return self.ticks[-1]

    def move(self, velocity=None, position=None):
        velocity = SLOW if velocity is None else velocity
        self.link.take(Command(self.now_ns, position or {}, dict(velocity)), self.now_ns)


def moving():
    bench = Bench()
    bench.run(3)
    bench.move()
    assert bench.run(3).point.velocity.any()
    return bench


def still(tick):
    return tick.point.resting and not np.any(tick.point.velocity)


def test_nothing_is_sent_before_the_first_command():
    bench = Bench()
    assert bench.run(5).point is None


def test_a_velocity_is_integrated_from_the_measured_positions():
    bench = Bench()
    bench.run(2)
    bench.move()
    bench.run(5)
    way = KINEMATICS.by_name(bench.ticks[-1].point.position - START)
    assert way["gantry"] == pytest.approx(5 * PERIOD_S * 0.1, abs=ROUNDING)
    assert way["J1"] == 0.0


def test_a_trajectory_is_caught_up_with():
    bench = Bench()
    bench.run(2)
    for _ in range(400):
        bench.move(dict.fromkeys(NAMES, 0.0), {**GOAL, "gantry": GOAL["gantry"] + 0.1})
        bench.run()
    assert KINEMATICS.by_name(bench.q)["gantry"] == pytest.approx(GOAL["gantry"] + 0.1, abs=1e-6)


@pytest.mark.parametrize("held", [False, None])
def test_the_dead_mans_switch_stops_the_arm_within_one_period(held):
    bench = moving()
    bench.held = held
    if held is None:  # not let go, but silent: the arm rests in the period in which the time is over
        for _ in range(25):
            bench.move()
            assert not still(bench.run())
        bench.move()
    before = bench.q.copy()
    tick = bench.run()
    assert still(tick) and tick.unfit.ends and "dead" in tick.unfit.reason and (bench.q == before).all()


def test_without_the_switch_ever_heard_nothing_moves():
    bench = Bench()
    bench.held = None
    bench.run(2)
    bench.move()
    assert still(bench.run()) and "deadman" in bench.ticks[-1].unfit.reason


def test_a_switch_that_is_not_asked_for_is_not_needed():
    bench = Bench(deadman=False)
    bench.held = None
    bench.run(2)
    bench.move()
    assert not still(bench.run())


def test_joint_states_that_stop_stop_the_arm_and_the_goal_goes_on():
    bench = moving()
    bench.joints_come = False
    bench.run(12)
    assert not still(bench.ticks[-1])
    tick = bench.run()
    assert still(tick) and not tick.unfit.ends and "no joint state for 0.104 s, allowed 0.1 s" in tick.unfit.reason


def test_joint_states_that_are_old_or_not_finite_count_as_none():
    bench = moving()
    bench.joints_come = False
    for _ in range(13):
        assert not bench.link.joints(bench.now_ns + MS, np.full(len(NAMES), np.nan), bench.now_ns)
        bench.link.joints(900 * MS, START, bench.now_ns)
        bench.run()
    assert still(bench.ticks[-1])


def test_the_joint_whose_states_stop_is_named_while_others_come():
    """The linear axis has a driver of its own. It stops, and the arm's goes on."""
    bench = Bench()
    bench.joints_come = False
    axis = np.array([name == "gantry" for name in NAMES])

    def hear(*parts):
        for part in parts:
            assert bench.link.joints(bench.now_ns + 8 * MS, np.where(part, bench.q, np.nan), bench.now_ns + 8 * MS)
        return bench.run()

    reason = hear(~axis).unfit.reason
    assert "gantry" in reason and "J1" not in reason
    assert hear(axis, ~axis).unfit is None
    bench.move()
    assert not still(hear(axis, ~axis))
    for _ in range(13):
        bench.move()
        tick = hear(~axis)
    assert still(tick) and not tick.unfit.ends and "gantry for 0.104 s" in tick.unfit.reason


@pytest.mark.parametrize("step_ms", [-50, 300])
def test_a_clock_that_jumps_stops_the_arm_at_once(step_ms):
    bench = moving()
    before = bench.q.copy()
    bench.now_ns += step_ms * MS
    tick = bench.link.tick(bench.now_ns)
    assert still(tick) and tick.unfit.ends and tick.unfit.jumped and (tick.point.position == before).all()
    assert f"the clock jumped by {1e-3 * step_ms:.3f} s" in tick.unfit.reason


def test_what_comes_late_from_before_a_clock_was_set_back_is_not_taken():
    bench = moving()
    before_ns = bench.now_ns
    bench.now_ns -= 900 * MS
    assert bench.link.tick(bench.now_ns).unfit.jumped
    bench.link.clear()
    assert not bench.link.joints(before_ns, bench.q, bench.now_ns)
    bench.link.image(before_ns, "features", bench.now_ns)
    bench.run(3)
    assert bench.ticks[-1].unfit is None
    bench.link.image(bench.now_ns, "new features", bench.now_ns)
    assert [sight.stamp_ns for sight in bench.link.sights(bench.now_ns)] == [bench.now_ns]


def test_after_a_stop_only_a_new_command_moves_the_arm():
    bench = moving()
    bench.held = False
    bench.run()
    bench.held = True
    assert still(bench.run(5))
    bench.move()
    assert not still(bench.run())


def test_a_velocity_that_no_command_renews_ends():
    bench = moving()
    tick = bench.run(26)
    assert still(tick) and tick.slowed == "the last command is too old"


def test_after_the_goal_it_rests_and_then_leaves_the_arm_to_others():
    bench = moving()
    bench.link.end(bench.now_ns)
    assert still(bench.run()) and bench.run(80).point is None


def test_speed_is_limited_by_one_factor():
    bench = Bench(joint_speed={"gantry": 0.05})
    bench.run(2)
    bench.move({"gantry": 0.2, "J2": 0.1})
    tick = bench.run()
    velocity = KINEMATICS.by_name(tick.point.velocity)
    assert (velocity["gantry"], velocity["J2"]) == (pytest.approx(0.05), pytest.approx(0.025))
    assert "slowed to 0.25" in tick.slowed


def test_acceleration_is_limited():
    bench = Bench(joint_acceleration=1.0)
    bench.run(2)
    bench.move({"gantry": 0.2})
    bench.run(4)
    speeds = [KINEMATICS.by_name(tick.point.velocity)["gantry"] for tick in bench.ticks[2:]]
    assert speeds == pytest.approx([PERIOD_S * k for k in (1, 2, 3, 4)])


def test_the_camera_stays_in_its_workspace_and_may_come_back():
    x, y, z = KINEMATICS.pose(START)[:3, 3]
    box = {"lower_m": [x - 0.5, y - 0.5, z - 0.5], "upper_m": [x + 0.5, y + 0.05, z + 0.5]}
    bench = Bench(workspace=box, joint_acceleration=5.0)
    bench.run(2)
    for _ in range(100):
        bench.move({"gantry": 0.2})  # along y
        bench.run()
    assert KINEMATICS.pose(bench.q)[1, 3] <= y + 0.05
    assert KINEMATICS.pose(bench.q)[1, 3] > y + 0.03
    assert bench.ticks[-1].blocked and "workspace" in bench.ticks[-1].slowed
    told = bench.ticks[-1].slowed
    bench.move({"gantry": 0.0})
    assert bench.run(3)[2:] == (told, True), "why the camera stands is told for as long as it stands"
    before = bench.q.copy()
    for _ in range(10):
        bench.move({"gantry": -0.2})
        bench.run()
    assert (bench.q != before).any() and not bench.ticks[-1].blocked
    for _ in range(100):
        bench.move({"gantry": 0.2})
        bench.run()
    bench.link.end(bench.now_ns)
    assert bench.run()[2:] == ("", False)


def test_a_joint_stops_at_its_limit():
    bench = Bench(speed_part=1.0)
    bench.q = KINEMATICS.vector({**GOAL, "gantry": 1.45})
    bench.run(2)
    for _ in range(60):
        bench.move({"gantry": 0.5})
        bench.run()
    at = KINEMATICS.by_name(bench.q)["gantry"]
    assert 1.49 < at <= 1.5 and bench.ticks[-1].blocked and "gantry" in bench.ticks[-1].slowed


def test_an_image_waits_for_the_joint_state_that_follows_it():
    bench = Bench()
    bench.run(3)
    stamp_ns = bench.now_ns + 15 * MS
    bench.link.image(stamp_ns, "features", bench.now_ns)
    assert bench.link.sights(bench.now_ns) == []
    bench.run(2)
    (sight,) = bench.link.sights(bench.now_ns)
    assert sight.stamp_ns == stamp_ns and sight.q == pytest.approx(START) and sight.refusal == ""
    assert sight.timing.gap_s == pytest.approx(0.008)


def test_an_image_whose_joint_states_do_not_come_is_refused():
    bench = Bench()
    bench.run(3)
    bench.link.image(bench.now_ns + 15 * MS, "features", bench.now_ns)
    bench.joints_come = False
    bench.run(30)
    (sight,) = bench.link.sights(bench.now_ns)
    assert sight.q is None and "older than the image" in sight.refusal


def test_the_delay_of_a_cameras_stamps_is_taken_off():
    bench = Bench(image_delay_s=0.02)
    for k in range(10):
        bench.q = START + 0.001 * k
        bench.run()
    bench.link.image(bench.now_ns, "features", bench.now_ns)
    (sight,) = bench.link.sights(bench.now_ns)
    assert sight.q == pytest.approx(START + 0.001 * (9 - 20 / 8))
    assert sight.timing.image_age_s == pytest.approx(0.02)
    bench.link.image(bench.now_ns - 5 * MS, "features", bench.now_ns)
    latency = bench.link.image_latency.summary()
    assert (latency.least_s, latency.most_s) == (pytest.approx(0.02), pytest.approx(0.025))


def test_the_prediction_ends_where_everything_sent_is_done():
    """50 ms after the image, at 0.1 m/s, with joint states that are up to date but for the last two periods."""
    bench = moving()
    bench.run(10)
    bench.link.image(bench.now_ns, "features", bench.now_ns)
    bench.run(4)
    bench.joints_come = False
    bench.run(2)
    (sight,) = bench.link.sights(bench.now_ns)
    asked = []

    def predicted(features, plane_C, X_C0C1):
        asked.append((features, plane_C, X_C0C1))
        return "later"

    later = bench.link.predict(sight, bench.now_ns, lambda q: ("plane at", tuple(q)), predicted)
    assert later.features == "later" and later.q == pytest.approx(bench.q, abs=ROUNDING)
    assert later.timing.predicted_s == pytest.approx(6 * PERIOD_S)
    (_, plane, X), = asked
    assert plane == ("plane at", tuple(sight.q))
    assert X == pytest.approx(np.linalg.inv(KINEMATICS.pose(sight.q)) @ KINEMATICS.pose(bench.q), abs=ROUNDING)


def test_a_prediction_over_too_long_a_time_is_refused():
    bench = moving()
    bench.link.image(bench.now_ns, "features", bench.now_ns)
    bench.run(45)
    (sight,) = bench.link.sights(bench.now_ns)
    assert "predicted over 0.360 s, allowed 0.3 s" in \
        bench.link.predict(sight, bench.now_ns, lambda q: q, lambda *_: None).refusal


@pytest.mark.parametrize("frame", ["camera", "base"])
def test_the_twist_is_the_motion_of_the_camera_that_the_limited_velocities_make(frame):
    bench = Bench(joint_speed={"gantry": 0.05}, twist_frame=frame)
    bench.run(2)
    bench.move({"gantry": 0.2, "J2": 0.1})
    tick = bench.run()
    h, q, q_dot = 1e-6, START, tick.point.velocity
    before, after = KINEMATICS.pose(q - h * q_dot), KINEMATICS.pose(q + h * q_dot)
    v, R = (after[:3, 3] - before[:3, 3]) / (2.0 * h), KINEMATICS.pose(q)[:3, :3]
    W = (after[:3, :3] - before[:3, :3]) / (2.0 * h) @ R.T
    w = np.array([W[2, 1], W[0, 2], W[1, 0]])
    wanted = np.concatenate([v, w] if frame == "base" else [R.T @ v, R.T @ w])
    assert np.linalg.norm(wanted[:3]) > 0.01 and np.linalg.norm(wanted[3:]) > 0.01
    np.testing.assert_allclose(tick.point.twist, wanted, atol=1e-8)
    (message,) = make_form(bench.settings, "twist").messages(tick.point._replace(frame_id="here"))
    assert message.topic == "servo_server/delta_twist_cmds" and message.kind == "geometry_msgs/TwistStamped"
    assert message.fields == {"header": bench.now_ns, "frame_id": "here", "twist": tick.point.twist.tolist()}
    bench.held = False
    (message,) = make_form(bench.settings, "twist").messages(bench.run().point)
    assert message.fields["twist"] == [0.0] * 6
