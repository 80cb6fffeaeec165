"""The fit of the simulator's own parameters, on a small arm with secret ones."""
import dataclasses
import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import yaml

from aras_visual_servo import ParameterError, Scenario, load_scenario, simulation_of
from aras_visual_servo_controller import Commands, Recording, identify_twin
from aras_visual_servo_controller.identification import twin as twin_module
from aras_visual_servo_controller.identification.dynamics import TreeDynamics
from aras_visual_servo_controller.identification.excite import _condition, design, trajectory_yaml
from aras_visual_servo_controller.identification.profile import profile

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


def recording(folder, rng, kind, still=(), seconds=4.0):
    loops = {name: {key: TRUTH[f"{name}.{key}"] for key in "pd"} for name in ("J1", "J2")}
    dynamics = {"loops": loops, **{key: {name: TRUTH[f"{name}.{key}"] for name in loops}
                                   for key in ("damping", "friction")}}
    sim = simulation_of(scenario(folder, dynamics, gravity_m_s2=[0.0, 0.0, -9.81 * TRUTH["gravity_scale"]],
                                 command_delay_s=TRUTH["command_delay_s"]))
    sim.step(1000)
    rows, stamps, values = [], [], []
    for k in range(int(seconds * 100)):
        if k >= 50:
            t = (k - 50) / 100
            wave = np.array([0.5, 0.4]) * np.sin(np.array([2.3, 3.1]) * t) + np.array([0.1, -0.1]) * np.sin(7.7 * t)
            slope = np.array([1.15, 1.24]) * np.cos(np.array([2.3, 3.1]) * t)
            slope += np.array([0.77, -0.77]) * np.cos(7.7 * t)
            goal = {name: 0.0 if name in still else value
                    for name, value in zip(loops, wave if kind == "position" else slope)}
            sim.set_command(**{kind: goal})
            stamps.append(sim.time_s)
            values.append(list(goal.values()))
        sim.step(10)
        rows.append((sim.time_s, sim.joint_positions, sim.joint_velocities))
    times, q, v = (np.array(column) for column in zip(*rows))
    return Recording(("J1", "J2"), times, q + rng.normal(0.0, NOISE, q.shape), v + rng.normal(0.0, 1e-3, v.shape),
                     commands=Commands(kind, np.array(stamps), np.array(values)))


@pytest.mark.parametrize("kind", ["velocity", "position"])
def test_secret_parameters_are_in_their_intervals_and_the_twin_repeats_what_was_not_fitted(tmp_path, kind):
    twin = identify_twin(recording(tmp_path, np.random.default_rng(4), kind), scenario(tmp_path))
    found = twin.identified
    assert [each.name for each in found.unknown] == ["joint_state_delay_s"] and set(found.estimates) == set(TRUTH)
    off = {name: (found.estimates[name].value - value) / found.estimates[name].stddev for name, value in TRUTH.items()}
    assert sum(abs(each) < 2.0 for each in off.values()) >= 8 and max(map(abs, off.values())) < 4.0, \
        [f'{name} {value:.1f}' for name, value in off.items()]
    assert found.estimates["J1.p"].stddev < 0.1 * TRUTH["J1.p"]
    assert max(twin.held_out.values()) < 1.5 * NOISE
    np.testing.assert_allclose(np.sqrt(np.diag(twin.covariance))[0], found.estimates["J1.damping"].stddev)
    section = twin.overlay["robot"]["dynamics"]
    assert section["friction"]["J2"] == pytest.approx(TRUTH["J2.friction"], rel=0.1)
    assert twin.overlay["sim"]["command_delay_s"] == pytest.approx(TRUTH["command_delay_s"], abs=6e-4)


def test_a_fit_that_did_not_converge_has_no_intervals(tmp_path, monkeypatch):
    monkeypatch.setattr(twin_module, "ROUNDS", 0)
    monkeypatch.setattr(twin_module, "FIRST_ROUNDS", 1)
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


def test_a_joint_that_rests_is_named_with_the_motion_that_would_tell_it(tmp_path):
    twin = identify_twin(recording(tmp_path, np.random.default_rng(5), "velocity", still=("J2",), seconds=2.5),
                         scenario(tmp_path))
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
