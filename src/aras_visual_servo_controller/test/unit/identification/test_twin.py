"""The fit of the simulator's own parameters, on a small arm with secret ones."""
import dataclasses
import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor
from unittest import mock

import numpy as np
import pytest
import yaml

from aras_visual_servo import ParameterError, Scenario, load_scenario, simulation_of
from aras_visual_servo_controller import Commands, Recording, identify_loops, identify_twin
from aras_visual_servo_controller.cli.identify import _rows
from aras_visual_servo_controller.identification import fit as fit_module
from aras_visual_servo_controller.identification import twin as twin_module
from aras_visual_servo_controller.identification.bandwidth import bandwidth
from aras_visual_servo_controller.identification.dynamics import TreeDynamics
from aras_visual_servo_controller.identification.estimates import Estimate
from aras_visual_servo_controller.identification.excite import _condition, design, trajectory_yaml
from aras_visual_servo_controller.identification.profile import profile
from aras_visual_servo_controller.identification.replayed import ReplayedRobot

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from secret_arm import NOMINAL, controllers

NOISE = 1e-4
TRUTH = {"J1.damping": 2.0, "J1.friction": 0.7, "J1.p": 250.0, "J1.d": 25.0, "J2.damping": 0.6, "J2.friction": 0.3,
         "J2.p": 120.0, "J2.d": 14.0, "gravity_scale": 1.04, "command_delay_s": 0.023}


def scenario(folder, dynamics=None, **sim):
    """A scenario of the arm with two joints, whose controllers follow their commands exactly."""
    (folder / "arm.urdf").write_text(NOMINAL.replace('effort="500"', 'effort="40"'))
    plain = controllers("position_controllers/JointPositionController")
    (folder / "controllers.yaml").write_text(yaml.safe_dump(plain))
    robot = {"urdf": str(folder / "arm.urdf"), "controllers": str(folder / "controllers.yaml"), "base_link": "base",
             "tip_link": "b", **({"dynamics": dynamics} if dynamics else {})}
    return Scenario("two", "", robot, sim, {}, {}, {}, {})


def recording(folder, rng, kind, still=(), seconds=4.0, back=None, hold_s=0.0, noise=NOISE, **more):
    """With `back`, J2 moves one way at a constant speed, and back after this part of the time. The arm is told first to
    stay where it was told to be for hold_s."""
    loops = {name: {key: TRUTH[f"{name}.{key}"] for key in "pd"} for name in ("J1", "J2")}
    dynamics = {"loops": loops, **{key: {name: TRUTH[f"{name}.{key}"] for name in loops}
                                   for key in ("damping", "friction")}, **more}
    sim = simulation_of(scenario(folder, dynamics, gravity_m_s2=[0.0, 0.0, -9.81 * TRUTH["gravity_scale"]],
                                 command_delay_s=TRUTH["command_delay_s"]))
    sim.step(1000)
    rows, stamps, values = [], [], []
    for k in range(int((seconds + hold_s) * 100)):
        if k >= 50:
            t = max((k - 50) / 100 - hold_s, 0.0)
            wave = np.array([0.5, 0.4]) * np.sin(np.array([2.3, 3.1]) * t) + np.array([0.1, -0.1]) * np.sin(7.7 * t)
            slope = np.array([1.15, 1.24]) * np.cos(np.array([2.3, 3.1]) * t)
            slope += np.array([0.77, -0.77]) * np.cos(7.7 * t)
            goal = {name: 0.0 if name in still else value
                    for name, value in zip(loops, wave if kind == "position" else slope)}
            if back is not None:
                goal["J2"] = 0.3 if k < back * 100 * seconds else -0.3
            sim.set_command(**{kind: goal})
            stamps.append(sim.time_s)
            values.append(list(goal.values()))
        sim.step(10)
        rows.append((sim.time_s, sim.joint_positions, sim.joint_velocities))
    times, q, v = (np.array(column) for column in zip(*rows))
    q, v = q + rng.normal(0.0, noise, q.shape), v + rng.normal(0.0, 10.0 * noise, v.shape)
    return Recording(("J1", "J2"), times, q, v, commands=Commands(kind, np.array(stamps), np.array(values)))


@pytest.mark.parametrize("kind, hold_s", [("velocity", 0.0), ("position", 0.0), ("position", 2.0)])
def test_secret_parameters_are_in_their_intervals_and_the_twin_repeats_what_was_not_fitted(tmp_path, kind, hold_s):
    told = []
    twin = identify_twin(recording(tmp_path, np.random.default_rng(4), kind, hold_s=hold_s), scenario(tmp_path),
                         progress=lambda *each: told.append(each))
    assert told[0][1] > told[-1][1] and told[-1] == pytest.approx((2.6, 0.8), rel=0.4)
    found = twin.identified
    assert [each.name for each in found.unknown] == ["joint_state_delay_s"] and set(found.estimates) == set(TRUTH)
    off = {name: (found.estimates[name].value - value) / found.estimates[name].stddev for name, value in TRUTH.items()}
    assert sum(abs(each) < 2.0 for each in off.values()) >= 8 and max(map(abs, off.values())) < 4.0, \
        [f'{name} {value:.1f}' for name, value in off.items()]
    assert found.estimates["J1.p"].stddev < 0.1 * TRUTH["J1.p"]
    assert max(twin.held_out.values()) < 1.5 * NOISE
    tree, q = TreeDynamics(NOMINAL), twin.measured.mean(axis=0)
    inertia = tree.efforts([tree.inertias], (np.tile(q, (2, 1)), np.zeros((2, 2)), np.eye(2)), np.zeros(3))[0]
    for name, M in zip(("J1", "J2"), inertia.diagonal()):
        gains = {"i": 0.0, **{key: TRUTH[f"{name}.{key}"] for key in "pd"}}
        true = bandwidth(gains, TRUTH[f"{name}.damping"], M, False)
        assert abs(twin.bandwidth[name].value - true) < 4.0 * twin.bandwidth[name].stddev < 0.2 * true
    np.testing.assert_allclose(np.sqrt(np.diag(twin.covariance))[0], found.estimates["J1.damping"].stddev)
    section = twin.overlay["robot"]["dynamics"]
    assert section["friction"]["J2"] == pytest.approx(TRUTH["J2.friction"], rel=0.1)
    assert twin.overlay["sim"]["command_delay_s"] == pytest.approx(TRUTH["command_delay_s"], abs=6e-4)


def test_static_friction_is_found_where_it_shows(tmp_path):
    truth = {"J1.friction": TRUTH["J1.friction"], "J1.stribeck": 1.2, "J1.stribeck_velocity": 0.2}
    twin = identify_twin(recording(tmp_path, np.random.default_rng(6), "velocity", static_friction={"J1": 1.9},
                                   stribeck_velocity={"J1": 0.2}), scenario(tmp_path))
    found = twin.identified.estimates
    assert twin.converged and set(found) == {*TRUTH, *truth}
    assert all(abs(found[name].value - value) < 3.0 * found[name].stddev for name, value in truth.items())
    section = twin.overlay["robot"]["dynamics"]
    assert section["static_friction"] == {"J1": pytest.approx(1.9, rel=0.1)}
    assert set(section["stribeck_velocity"]) == {"J1"}
    again = ReplayedRobot(recording(tmp_path, np.random.default_rng(6), "velocity"), scenario(tmp_path, section))
    assert {"J1.stribeck", "J1.stribeck_velocity"} <= {each.name for each in again.parameters}


def test_a_motion_back_that_the_fitted_part_does_not_tell_is_no_reason_to_distrust_the_fit(tmp_path):
    twin = identify_twin(recording(tmp_path, np.random.default_rng(5), "velocity", back=0.8), scenario(tmp_path))
    assert twin.held_out["J2"] > fit_module.EXPLAINED * twin.identified.residual["J2"]
    found = twin.identified.estimates
    assert twin.converged and "J2.friction" not in found
    assert found["J1.friction"].stddev < 0.1 * TRUTH["J1.friction"]


def test_friction_of_a_joint_that_moved_one_way_is_one_with_the_place_where_its_set_point_began(tmp_path):
    twin = identify_twin(recording(tmp_path, np.random.default_rng(5), "velocity", back=0.85), scenario(tmp_path))
    unknown = {each.name: each.not_apart_from for each in twin.identified.unknown}
    assert unknown["J2.friction"] == ("J2.start",) and "J1.friction" in twin.identified.estimates


def test_what_is_simulated_is_straight_in_the_delay_within_a_period(tmp_path):
    robot = ReplayedRobot(recording(tmp_path, np.random.default_rng(4), "velocity", seconds=2.5), scenario(tmp_path))
    x = np.array([each.start for each in robot.parameters])
    at = [each.name for each in robot.parameters].index("command_delay_s")

    def replayed(delay):
        return np.hstack(robot.replay(np.where(np.arange(len(x)) == at, delay, x), robot.first))
    ends = [replayed(0.0231), replayed(0.0239)]
    np.testing.assert_allclose(replayed(0.0235), np.mean(ends, axis=0), atol=1e-9)
    assert np.abs(np.diff(ends, axis=0)).max() > 1e-3


def test_the_bandwidth_is_that_of_loops_of_first_and_second_order():
    plain = {"p": 100.0, "i": 0.0, "d": 0.0}
    assert bandwidth(plain, 0.0, 2.0, True) == pytest.approx(50.0 / (2.0 * np.pi), rel=1e-4)
    assert bandwidth(plain, 30.0, 2.0, True) == pytest.approx(65.0 / (2.0 * np.pi), rel=1e-4)
    natural, ratio = 30.0, 0.6  # [rad/s], 1: s^2 + 2 ratio natural s + natural^2
    part = 1.0 - 2.0 * ratio**2
    expected = natural * np.sqrt(part + np.sqrt(part**2 + 1.0)) / (2.0 * np.pi)
    assert bandwidth({**plain, "p": natural**2}, 2.0 * ratio * natural, 1.0, False) == pytest.approx(expected, rel=1e-4)


def test_an_estimate_without_an_interval_is_shown_without_one_and_others_with_theirs():
    rows = _rows({"J1.p": Estimate(2.0, np.inf, "1"), "image_delay_s": Estimate(0.1, 0.01, "s")})
    assert rows[0]["interval"] == "unknown" and rows[1]["interval"].startswith("0.0804")


def test_a_fit_that_did_not_converge_has_no_intervals(tmp_path, monkeypatch):
    for module in (fit_module, twin_module):
        monkeypatch.setattr(module, "ROUNDS", 0)
    monkeypatch.setattr(fit_module, "FIRST_ROUNDS", 1)
    twin = identify_twin(recording(tmp_path, np.random.default_rng(4), "position", seconds=2.5), scenario(tmp_path))
    assert not twin.converged and np.isinf(twin.covariance).all()
    assert all(estimate.interval == (-np.inf, np.inf) for name, estimate in twin.identified.estimates.items())


def test_a_profile_follows_a_cost_that_is_no_parabola():
    """Two values are known by their sum well, and the inverse of the first is known by 0.1."""
    def residual(way):
        return np.array([(1.0 / (1.0 + way[0]) - 1.0) / 0.1, (way[0] + way[1]) / 1e-3])
    slope = np.array([[-10.0, 0.0], [1e3, 1e3]])
    with ThreadPoolExecutor(1) as pool:
        found = profile(residual, slope, pool)
        low, high = sorted(found.ends[0, :, 0])
        np.testing.assert_allclose((low, high), (1.0 / 1.196 - 1.0, 1.0 / 0.804 - 1.0), rtol=0.05)
        np.testing.assert_allclose(found.ends[0].sum(axis=1), 0.0, atol=1e-3)
        assert found.lower is None and found.ends.shape == (1, 2, 2)
        assert profile(lambda way: slope @ way, slope, pool).directions.shape == (2, 0)
        lower = profile(lambda way: np.append(slope @ way, 9.0 * (way[0] < 0.05)),
                        np.vstack([slope, np.zeros(2)]), pool).lower
        assert lower is not None and lower[0] > 0.05


def test_what_the_model_lacks_widens_the_intervals_and_is_told(tmp_path):
    rng = np.random.default_rng(5)
    exact = recording(tmp_path, rng, "position", seconds=8.0, noise=1e-5)
    jitter_s = rng.uniform(-0.0015, 0.0015, len(exact.commands.times_s))
    commands = dataclasses.replace(exact.commands, times_s=exact.commands.times_s + jitter_s)
    late = dataclasses.replace(exact, commands=commands)
    finished = []

    def identified(each):
        with mock.patch.object(fit_module.Fit, "finish", autospec=True, side_effect=fit_module.Fit.finish) as finish:
            twin = identify_twin(each, scenario(tmp_path))
        finished.append(finish.call_count)
        return twin
    twin, plain = identified(late), identified(exact)
    assert twin.converged and twin.by_noise > 3.0 and plain.converged and plain.by_noise < 3.0
    assert finished == [1, 1]  # the other starts of `late` end no lower in its first part, and go no further
    found, narrow = (each.identified.estimates for each in (twin, plain))
    for name in ("J1.p", "J1.d", "J2.p", "J2.d", "gravity_scale"):
        assert found[name].value == pytest.approx(TRUTH[name], rel=0.05)
        assert found[name].stddev > 3.0 * narrow[name].stddev


@pytest.mark.parametrize("beside_s", (-1e-5, 1e-5))
def test_a_delay_beside_a_whole_number_of_periods_stops_no_other_parameter(tmp_path, monkeypatch, beside_s):
    monkeypatch.setitem(TRUTH, "command_delay_s", 0.029)  # joint states just before the next set point
    given = recording(tmp_path, np.random.default_rng(4), "position")
    with ThreadPoolExecutor(2) as pool:
        fit = fit_module.Fit(given, ReplayedRobot(given, scenario(tmp_path)), pool, None)
        truth = np.array([TRUTH[name] for name in fit.names])
        begin = truth * np.where(np.array(fit.names) == "J1.damping", 0.9, 1.0)
        begin[fit.delay] += beside_s
        found = fit.descend(begin, fit.robot.fit, fit.weights, 20, 1e-4)
        assert fit.cost(found) < fit.cost(truth) < fit.cost(begin)


def test_a_fit_that_leaves_little_more_than_the_noise_begins_anew(tmp_path, monkeypatch):
    """A payload of the wrong mass has left 2.9 times the noise."""
    given, scales = recording(tmp_path, np.random.default_rng(4), "position"), []
    begin, finish = fit_module.Fit.begin, fit_module.Fit.finish

    def poor(fit, gains, mass):
        x = begin(fit, gains, mass)
        x[fit.names.index("J1.damping")] *= 1.0 if scales else 0.97
        return x

    def finished(fit, x):
        x = finish(fit, x) if scales else x
        scales.append(fit.scaled(x)[2])
        return x
    monkeypatch.setattr(fit_module.Fit, "begin", poor)
    monkeypatch.setattr(fit_module.Fit, "finish", finished)
    twin = identify_twin(given, scenario(tmp_path))
    assert len(scales) == 2 and 1.2 < scales[0] < 3.0 and twin.converged and twin.by_noise < 1.0


def test_a_lost_joint_state_is_no_noise():
    times = np.arange(400) * 0.01
    values = np.column_stack([np.sin(3.0 * times), np.cos(2.0 * times)]) + np.random.default_rng(1).normal(
        0.0, NOISE, (400, 2))
    kept = np.r_[:200, 206:400]
    np.testing.assert_allclose(fit_module._noise(times[kept], values[kept]), NOISE, rtol=0.15)


def test_a_joint_state_that_arrives_before_its_stamp_tells_no_delay(tmp_path):
    exact = recording(tmp_path, np.random.default_rng(5), "velocity", seconds=2.5)
    found = identify_loops(dataclasses.replace(exact, received_s=exact.times_s - 0.002))
    assert "joint_state_delay_s" not in found.estimates
    assert "joint_state_delay_s" in [each.name for each in found.unknown]


def test_a_joint_that_rests_is_named_with_the_motion_that_would_tell_it(tmp_path):
    still = recording(tmp_path, np.random.default_rng(5), "velocity", still=("J2",), seconds=2.5)
    late = dataclasses.replace(still, received_s=still.times_s + 0.004)
    twin = identify_twin(late, scenario(tmp_path))
    assert twin.overlay["time"] == {"joint_state_delay_s": pytest.approx(0.004)}
    unknown = {each.name: each.motion for each in twin.identified.unknown}
    assert {"J2.damping", "J2.d"} <= set(unknown) and "J2" in unknown["J2.damping"]
    assert {"J1.damping", "J1.friction"} <= set(twin.identified.estimates)


def test_what_cannot_be_fitted_is_refused_all_at_once(tmp_path):
    times = np.arange(200) * 0.01
    still = Recording(("J1", "J9"), times, np.zeros((200, 2)))
    with pytest.raises(ParameterError) as error:
        identify_twin(still, scenario(tmp_path), "hand")
    keys = [fault.split(":")[0] for fault in error.value.faults]
    assert keys == ["joint_names", "payload_link", "commands", "position"]
    late = dataclasses.replace(still, joint_names=("J1", "J2"), position=np.sin(times)[:, None] * np.ones(2),
                               commands=Commands("position", times[-1:], np.zeros((1, 2))))
    with pytest.raises(ParameterError, match="times_s: found 0 joint states"):
        identify_twin(late, scenario(tmp_path))


def test_a_designed_motion_keeps_the_limits_and_is_conditioned_better_than_a_sine(tmp_path):
    arm = load_scenario("so101")
    motion = design(arm, 10.0)
    kinematics = arm.kinematics(calibrated=False)
    assert np.all(motion.position >= kinematics.lower) and np.all(motion.position <= kinematics.upper)
    np.testing.assert_allclose(motion.velocity[[0, -1]], 0.0, atol=0.02)
    np.testing.assert_allclose(motion.position[0], arm.goal_posture(kinematics), atol=2e-3)
    wave = np.sin(2.0 * np.pi * 0.1 * motion.times_s)[:, None] * np.full(len(kinematics.joint_names), 0.3)
    alike = [wave + motion.position[0], *(np.gradient(wave, 0.05, axis=0) for _ in range(2))]
    assert 1.0 < motion.condition < 0.3 * _condition(TreeDynamics(arm.urdf_xml()), motion.joint_names, alike,
                                                     arm.robot["tip_link"])
    message = yaml.safe_load(trajectory_yaml(motion))
    assert message["joint_names"] == list(motion.joint_names) and len(message["points"]) == len(motion.times_s)
    assert message["points"][1]["time_from_start"] == {"secs": 3, "nsecs": 50_000_000}
    with pytest.raises(ParameterError, match="--seconds"):
        design(arm, 5.0)
