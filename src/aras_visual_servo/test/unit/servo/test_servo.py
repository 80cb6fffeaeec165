"""The servo on the true arm, exact pictures and joints that follow: decay, singular goal, limits, bad input."""

import numpy as np
import pytest
from bench import Bench, config, DT_S, LAMBDA, resting
from toy_plant import arm, GOAL, PERIOD_NS, pose_error, START

from aras_visual_servo import FEATURE_NAMES, Features, Observation, ParameterError, Reference, Servo, Status


def sag(q):  # gravity on J2, J3, J5 and a stuck gantry
    return np.array([0.0, -2e-3 * np.sin(q[1] + 0.3), -1e-3 * np.cos(q[1]), 5e-4, 3e-4, 2e-4])


TILTED = {**START, "J5": START["J5"] + 0.01}  # which the features cannot see


@pytest.mark.parametrize("changes", [
    {"law": "decoupled"}, {"law": "paper"}, {"start": TILTED}, {"sag": sag},
    {"law": "paper", "mode": "look_then_move", "gains_per_s": dict(zip(FEATURE_NAMES, (90.0, 70.0, 50.0, 30.0))),
     "sample_time_s": 0.01}], ids=["decoupled", "paper", "tilted", "joints that sag", "look then move"])
def test_servo_converges_to_the_true_pose_of_the_nearly_singular_goal(changes):
    bench = Bench(**changes)
    assert bench.run().status == Status.CONVERGED
    bench.assert_at_goal()


def test_every_feature_error_decays_at_lambda_within_one_percent():
    # Small motion in a bent pose: what is left is the arm's Jacobian turning while joint velocities are held.
    place = {**GOAL, "J2": 0.35, "J3": -0.7, "J5": 0.35}
    start = {**place, "gantry": 0.045, "J6": 0.02, "J2": 0.36, "J3": -0.72, "J5": 0.36}
    bench = Bench(goal=place, start=start)
    for _ in range(31):
        bench.step()
    e = bench.errors()
    rates = -np.log(np.abs(e[30] / e[0])) / (30 * DT_S)
    assert (np.abs(e[0]) > 1e-4).all()
    np.testing.assert_allclose(rates, LAMBDA, rtol=0.01)


def test_height_decays_at_lambda_within_one_percent_next_to_the_stretched_arm():
    bench = Bench()
    bench.run()
    z = bench.errors()[:, 2]
    near = np.flatnonzero(np.abs(z) < 1e-4)[0]  # the last 0.1 mm, elbow within 0.05 rad of stretched
    rate = -np.log(np.abs(z[near + 15] / z[near])) / (15 * DT_S)
    assert rate == pytest.approx(LAMBDA, rel=0.01)


@pytest.mark.parametrize("roll", [0.0, 0.8, np.pi / 2, -2.0])
def test_target_keeps_its_place_while_tilt_is_corrected(roll):
    bench = Bench(start={**GOAL, "J5": GOAL["J5"] + 0.01, "J6": roll})
    view = bench.look()
    _, record = bench.servo.step(view, 1e-6)  # so short that gains are those of the continuous law
    f, v, w = view.features, record.twist[:3], record.twist[3:]
    moved = -v - np.cross(w, [f.xn, f.yn, f.an])
    # 0.01 rad at 3 /s moves a target at 0.6 m by 18 mm/s unless made up for; LAMBDA * dt is 3e-6
    assert np.hypot(w[0], w[1]) == pytest.approx(LAMBDA * 0.01, rel=1e-5)
    np.testing.assert_allclose(moved, -LAMBDA * record.e[:3], atol=1e-6)


def test_without_tilt_hold_the_tilt_stays():
    bench = Bench(start=TILTED, tilt_gain_per_s=0.0)
    bench.run()
    assert pose_error(bench.X_WG, bench.arm.pose(bench.q))[1] > 1e-3


def test_joints_stay_inside_their_limits_and_the_status_says_so():
    bench = Bench(start={**GOAL, "gantry": -1.47, "J1": 0.2})
    far = bench.camera.features(bench.arm.pose(bench.goal_q))
    seen = set()
    for _ in range(60):
        far.xn, far.yn = far.xn, 5.0  # a target that stays far to the side
        _, record = bench.step(Observation(bench.stamp_ns, far, bench.q))
        seen.add(record.status)
        assert (bench.q >= bench.arm.lower).all() and (bench.q <= bench.arm.upper).all()
    assert Status.JOINT_LIMIT in seen


def test_joint_velocities_are_scaled_together():
    fast = dict.fromkeys(FEATURE_NAMES, 29.0)
    bench = Bench(gains_per_s=fast, null_space={"joint_limit_gain_per_s": 0.0, "posture_gain_per_s": 0.0})
    q = bench.q.copy()
    far = bench.camera.features(bench.arm.pose(bench.q))
    far.yn += 3.0
    command, record = bench.step(Observation(0, far, bench.q))
    q_dot = np.array([command.velocity[name] for name in bench.arm.joint_names])
    assert np.abs(q_dot).max() <= 5.0 * (1.0 + 1e-12)  # rounding of the factor
    done = bench.arm.jacobian(q + 0.5 * DT_S * q_dot) @ q_dot
    # The twist keeps its direction; the arm turns by 0.17 rad within the period, 1 % is of second order in that.
    np.testing.assert_allclose(done, record.twist, atol=0.01 * np.linalg.norm(record.twist))
    assert 0.01 < np.linalg.norm(record.twist) < 29.0 * np.linalg.norm(record.e)


@pytest.mark.parametrize("flag", ["target_visible", "valid"])
def test_lost_target_stops_the_arm_and_servoing_resumes_when_it_is_back(flag):
    bench = Bench()
    bench.step()
    lost = bench.look()
    setattr(lost.features, flag, False)
    command, record = bench.step(lost)
    assert resting(command) and len(command.velocity) == 6
    assert record.status == Status.TARGET_LOST
    command, record = bench.step()
    assert record.status == Status.SERVOING and not resting(command)


@pytest.mark.parametrize("name", [*FEATURE_NAMES, "a joint"])
def test_input_that_is_not_finite_is_a_fault_that_stays(name):
    bench = Bench()
    bench.step()
    bad = bench.look()
    if name == "a joint":
        bad.q[2] = np.inf
    else:
        setattr(bad.features, name, np.nan)
    for observation in (bad, None):
        command, record = bench.step(observation)
        assert resting(command) and record.status == Status.FAULT


def late_image(bench):
    bench.stamp_ns += 300_000_000
    return bench.step()


@pytest.mark.parametrize("answer", [
    lambda bench: bench.step(Observation(0, bench.look().features, bench.q)), late_image,
    lambda bench: bench.servo.stale(bench.stamp_ns, "no image"),
    lambda bench: bench.step(Observation(bench.stamp_ns, None, bench.q))],
    ids=["stale stamp", "gap between images", "watchdog", "no image"])
def test_stale_input_stops_the_arm_and_the_next_image_resumes(answer):
    bench = Bench()
    bench.step()
    command, record = answer(bench)
    assert resting(command) and record.status == Status.STALE_INPUT
    assert bench.step()[1].status == Status.SERVOING


def test_time_limit_ends_servoing():
    bench = Bench(time_limit_s=0.5)
    assert bench.run().status == Status.TIMED_OUT
    assert bench.servo.finished
    assert resting(bench.commands[-1])
    assert bench.stamp_ns - PERIOD_NS == pytest.approx(5e8, abs=PERIOD_NS)


def test_stop_ends_servoing():
    bench = Bench()
    bench.step()
    command, record = bench.servo.stop(bench.stamp_ns, "asked to")
    assert resting(command) and (record.status, record.status_text) == (Status.STOPPED, "asked to")
    assert bench.step()[1].status == Status.STOPPED


def test_converged_only_after_the_hold_time():
    bench = Bench(thresholds=dict.fromkeys(FEATURE_NAMES, 1e-3), hold_s=0.5, start=GOAL)
    bench.run()
    assert bench.records[-1].converged
    assert (len(bench.records) - 1) * DT_S == pytest.approx(0.5, abs=1.1 * DT_S)
    assert (len(bench.records) - 1) * DT_S >= 0.5


def test_look_then_move_takes_the_next_look_only_when_joints_rest():
    bench = Bench(mode="look_then_move", gains_per_s=dict.fromkeys(FEATURE_NAMES, 50.0))
    looks, last = [], None
    for _ in range(200):
        before = bench.q
        _, record = bench.step()
        if not looks or not np.array_equal(record.e, looks[-1]):
            looks.append(record.e)
            if len(looks) > 1:
                np.testing.assert_allclose(before, last, atol=0.002 * DT_S)  # the settle speed
        last = before
    ratios = looks[1] / looks[0]
    np.testing.assert_allclose(ratios[2:], 0.5, rtol=0.002)  # the path is followed in ten steps, of second order


def test_look_then_move_broken_off_by_late_input_does_not_jump():
    bench = Bench(mode="look_then_move", gains_per_s=dict.fromkeys(FEATURE_NAMES, 50.0))
    for _ in range(12):
        bench.step()
    bench.stamp_ns += 300_000_000
    before = bench.set_point.copy()
    for _ in range(3):
        command, record = bench.step()
        sent = [command.position[name] for name in bench.arm.joint_names]
        np.testing.assert_allclose(sent, before, atol=1e-12)  # rounding of the velocity integrated so far
        before = bench.set_point.copy()
    assert Status.STALE_INPUT in {record.status for record in bench.records}


def test_look_then_move_stopped_between_two_images_stands_where_the_move_is():
    bench = Bench(mode="look_then_move", gains_per_s=dict.fromkeys(FEATURE_NAMES, 50.0))
    bench.stamp_ns = 1_000_000_000
    bench.servo.start(bench.stamp_ns, bench.set_point)
    for _ in range(12):
        bench.step()
    then, ahead = bench.arm.vector(bench.commands[-1].position), bench.set_point.copy()
    command, _ = bench.servo.stop(bench.stamp_ns - PERIOD_NS // 2, "asked to")
    part = (bench.arm.vector(command.position) - then) / (ahead - then)
    np.testing.assert_allclose(part, 0.5, atol=0.05)  # the speed changes on the way


@pytest.mark.parametrize("changes", [{}, {"filter": {}}, {
    "mode": "look_then_move", "gains_per_s": dict.fromkeys(FEATURE_NAMES, 50.0)}])
def test_it_does_not_matter_when_the_clock_began(changes):
    first, later = benches = Bench(**changes), Bench(**changes)
    later.stamp_ns = 1_700_000_000_000_000_000
    later.servo.start(later.stamp_ns, later.set_point)
    for _ in range(40):
        for bench in benches:
            bench.step()
        np.testing.assert_array_equal(later.set_point, first.set_point)
    assert np.abs(first.set_point - first.arm.vector(START)).max() > 0.1


def test_servo_that_was_not_started_does_nothing():
    servo = Servo(arm(), config())
    command, record = servo.step(Observation(5, None, np.zeros(6)), DT_S)
    assert command.velocity == {} and command.position == {}
    assert record.status == Status.IDLE


def test_start_without_reference_is_refused():
    with pytest.raises(ParameterError, match="no reference"):
        Servo(arm(), config()).start(0)


FIT = dict(target_visible=True, valid=True, area=0.01, xg=0.1, yg=0.2, alpha=0.3, moment_names=("00",), m=(0.01,))


@pytest.mark.parametrize("change, z_star_m, word", [
    *(({key: value}, 0.6, "teach") for key, value in (("valid", False), ("target_visible", False), ("xg", np.nan))),
    *(({}, z_star_m, "z_star_m") for z_star_m in (0.0, -0.6, np.nan, np.inf))])
def test_teach_refuses_a_view_that_is_not_fit_and_a_depth_that_is_none(change, z_star_m, word):
    with pytest.raises(ParameterError, match=word):
        Servo(arm(), config()).teach(Features(**{**FIT, **change}), GOAL, z_star_m)


@pytest.mark.parametrize("before", [{}, {"has_reference": True, "xn": 5.0, "yn": 5.0, "an": 5.0, "z_star_m": 5.0}])
def test_a_taught_view_is_normalised_by_itself_whatever_reference_it_had(before):
    reference = Servo(arm(), config()).teach(Features(**{**FIT, **before}), GOAL, 0.6)
    np.testing.assert_array_equal(reference.s_star, [0.6 * 0.1, 0.6 * 0.2, 0.6, 0.3])
    assert (reference.view.z_star_m, reference.view.area_star, reference.view.an) == (0.6, 0.01, 0.6)


def test_reference_survives_being_stored():
    bench = Bench()
    stored = Reference.from_dict(bench.servo.reference.to_dict())
    bench.servo.set_reference(stored)
    bench.servo.start(0)
    assert bench.run().status == Status.CONVERGED
    bench.assert_at_goal()


def test_configuration_lists_every_fault():
    inverse = {"method": "no_such_method", "joint_weights": {"J9": 2}}
    bad = config(law="no_such_law", mode="jump", time_limit_s=-1, surprise=1, inverse=inverse)
    bad["gains_per_s"] = {"xn": 0.0, "yn": 1, "an": "x"}
    with pytest.raises(ParameterError) as caught:
        Servo(arm(), bad)
    text = str(caught.value)
    for part in ("servo.law", "servo.mode", "time_limit_s", "surprise", "inverse.method", "J9", "gains_per_s.xn",
                 "gains_per_s.an", "gains_per_s.alpha"):  # fmt: skip
        assert part in text
    assert len(caught.value.faults) == 9


@pytest.mark.parametrize("bad, word", [
    ({"mode": "look_then_move", "gains_per_s": dict.fromkeys(FEATURE_NAMES, 200.0)}, "diverge"),
    ({"on_lost": "run"}, "on_lost"), ({"lost_target": {"speed": 0.0}}, "lost_target.speed"),
    ({"lost_target": {"attempts": 1.5}}, "attempts"), ({"lost_target": {"slow_down": 1.5}}, "slow_down"),
    ({"lost_target": {"pattern": "spiral"}}, "pattern"), ({"lost_target": {"surprise": 1}}, "surprise"),
    ({"feed_forward": {"noise_m": 0.0}}, "noise_m"), ({"feed_forward": {"part": 1.5}}, "part"),
    ({"feed_forward": {"surprise": 1}}, "surprise"), ({"track": "yes"}, "track"),
    ({"track": True, "mode": "look_then_move"}, "continuous"),
    ({"filter": {}, "law": "broyden"}, "filter: found with law 'broyden'"),
    ({"filter": {}, "mode": "look_then_move", "law": "decoupled"}, "filter: found with mode: look_then_move"),
    ({"filter": {"outage_s": -1.0}}, "servo.filter.outage_s: found -1.0, .*>= 0")])
def test_faults_of_the_sections_are_named(bad, word):
    with pytest.raises(ParameterError, match=word):
        Servo(arm(), config(**bad))


def test_overrides_hold_for_the_next_start_and_can_be_taken_back():
    servo = Servo(arm(), config())
    servo.configure(law="paper", gains_per_s=[1, 2, 3, 4], time_limit_s=5.0)
    assert (servo.config.law, servo.config.gains_per_s, servo.config.time_limit_s) == ("paper", (1, 2, 3, 4), 5.0)
    servo.configure()
    assert (servo.config.law, servo.config.time_limit_s) == ("decoupled", 20.0)
    with pytest.raises(ParameterError, match="thresholds"):
        servo.configure(thresholds=[1.0, -1.0, 1.0, 1.0])


def test_the_time_limit_counts_from_the_start_and_is_met_at_its_end():
    bench = Bench(time_limit_s=3 * DT_S)
    bench.servo.start(0, bench.set_point)
    for _ in range(3):
        assert bench.step()[1].status != Status.TIMED_OUT
    assert bench.stamp_ns == round(3e9 * DT_S) and bench.step()[1].status == Status.TIMED_OUT


def test_a_retuned_servo_has_the_same_goal_and_goes_on():
    bench = Bench()
    bench.step()
    other = bench.servo.retuned(config(gains_per_s=dict.fromkeys(FEATURE_NAMES, 1.0)))
    assert other.reference is bench.servo.reference and other.status == bench.servo.status
    q = bench.q
    _, record = other.step(Observation(bench.stamp_ns, bench.camera.features(bench.arm.pose(q)), q), DT_S)
    _, before = bench.step()
    np.testing.assert_array_equal(record.e, before.e)
    np.testing.assert_array_equal(record.s_star, before.s_star)
    untaught = Servo(arm(), config())
    assert untaught.retuned(config()).reference is None


def test_errors_of_views_of_the_goal_are_those_to_the_first_of_them():
    bench = Bench()
    view, moved = bench.servo.reference.view, bench.look().features
    errors, poses = bench.servo.goal.errors([view])
    assert errors.shape == (1, 4) and not errors.any() and (poses is None or not poses.any())
    errors, _ = bench.servo.goal.errors([view, moved, view])
    assert errors[1].all() and not errors[0].any() and not errors[2].any()
