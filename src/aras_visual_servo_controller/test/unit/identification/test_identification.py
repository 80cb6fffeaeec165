"""What the fits find of arms that the simulator plays with secret parameters, and what they refuse or leave open."""
import dataclasses
import pathlib
import sys

import numpy as np
import pytest
from aras_visual_servo_sim import Simulation

from aras_visual_servo import ModelError, ParameterError
from aras_visual_servo_controller.identification.dynamics import TreeDynamics
from aras_visual_servo_controller.identification.efforts import identify_efforts
from aras_visual_servo_controller.identification.loops import identify_loops
from aras_visual_servo_controller.identification.recording import Commands, Recording

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from secret_arm import NOMINAL, TABLE, controllers, effort_recording, position_recording

#: Of 40 values in 95 % intervals, fewer than this part is inside in one of a hundred draws; the draws are fixed.
LEAST_INSIDE = 0.86


def inside(found, truth):
    assert set(found.estimates) == set(truth) and found.unknown == []
    return [low <= truth[name] <= high for name, (low, high) in
            ((name, estimate.interval) for name, estimate in found.estimates.items())]


def test_friction_gravity_and_payload_are_in_their_intervals():
    hits = []
    for seed in range(4):
        rng = np.random.default_rng(100 + seed)
        friction, gravity, extra = rng.uniform(0.05, 1.0, 4), rng.uniform(8.5, 10.5), rng.uniform(0.1, 0.8)
        found = identify_efforts(effort_recording(rng, friction, gravity, extra), NOMINAL, "b")
        truth = dict(zip(("J1.damping", "J1.friction", "J2.damping", "J2.friction"), friction))
        truth.update({"gravity_scale": gravity / 9.81, "payload.mass": extra, "payload.first_x": 0.0,
                      "payload.first_y": 0.03 * extra, "payload.first_z": -0.15 * extra,
                      "effort_delay_s": 0.00025})  # a mean over the last period of 0.5 ms
        hits += inside(found, truth)
        assert found.estimates["payload.mass"].stddev < 0.02
        assert all(0.03 < rms < 0.045 for rms in found.residual.values()), "0.15 N m over a Hann window of 0.12 s"
    assert np.mean(hits) > LEAST_INSIDE


def test_loops_and_delays_are_in_their_intervals_without_efforts():
    hits = []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        gains, damping, delay = rng.uniform(10, 50, 2), rng.uniform(1, 8, 2), rng.integers(5, 90) / 1e3
        found = identify_loops(position_recording(rng, gains, damping, delay))
        truth = {"joint_state_delay_s": 0.0045}
        for name, p, d, mass in zip(("J1", "J2"), gains, damping, (3.0, 1.0)):
            # An implicit step of 0.5 ms divides the error by 1 + k dt; positions advance with the newest velocity.
            truth.update({f"{name}.bandwidth": np.log1p((p + d) / mass * 5e-4) / 5e-4, f"{name}.gain": p / (p + d),
                          f"{name}.command_delay_s": delay - 2.5e-4})
        hits += inside(found, truth)
        assert found.estimates["J1.command_delay_s"].stddev < 1e-3
    assert np.mean(hits) > LEAST_INSIDE


def test_a_joint_that_rests_is_unknown_and_the_others_are_not():
    rng = np.random.default_rng(1)
    found = identify_efforts(effort_recording(rng, (0.3, 0.2, 0.4, 0.1), still=("J2",), seconds=8.0), NOMINAL, "b")
    unknown = {each.name: each for each in found.unknown}
    assert {"J2.damping", "J2.friction"} <= set(unknown) and "J2" in unknown["J2.friction"].motion
    assert {"J1.damping", "J1.friction"} <= set(found.estimates)
    together = unknown["payload.mass"].not_apart_from  # of one joint that turns, only the sum is seen
    assert "payload.first_z" in together and "J2.damping" not in together
    found = identify_loops(position_recording(rng, (20, 20), (1, 1), 0.02, still=("J2",), seconds=4.0))
    assert {each.name for each in found.unknown} == {f"J2.{key}" for key in ("gain", "bandwidth", "command_delay_s")}
    assert {"J1.gain", "J1.bandwidth", "J1.command_delay_s"} <= set(found.estimates)


@pytest.mark.parametrize("urdf", [NOMINAL, TABLE.format(0.0, 0.0)])
def test_inverse_dynamics_hold_the_simulated_arm(urdf):
    sim = Simulation(urdf, {"period_s": 1e-5}, controllers("effort_controllers/JointEffortController"))
    tree = TreeDynamics(urdf)
    q, v = np.array([0.3, -0.8]), np.zeros(2)
    sim.set_joint_positions(dict(zip(tree.joint_names, q)))
    a = np.array([1.5, -2.0])
    effort = tree.efforts([tree.inertias], [each[None] for each in (q, v, a)], (0.0, 0.0, -9.81))[0, 0]
    sim.set_command(effort=dict(zip(tree.joint_names, effort)))
    sim.step(200)
    np.testing.assert_allclose(sim.joint_velocities / 2e-3, a, rtol=5e-3)


def recording(**changes):
    n = 200
    times = np.arange(n) * 0.01
    values = {"joint_names": ("J1", "J2"), "times_s": times, "position": np.sin(times)[:, None] * np.ones(2)}
    return Recording(**{**values, **changes})


def test_faults_of_a_recording_are_named_all_at_once():
    times = np.arange(200) * 0.01
    back = times.copy()
    back[100] = 0.5
    with pytest.raises(ParameterError) as error:
        recording(joint_names=("J1", "J1"), times_s=back, position=np.full((200, 2), 90.0),
                  effort=np.full((200, 2), np.nan), velocity=np.zeros((3, 2)),
                  commands=Commands("torque", times, np.zeros((200, 2))))
    for key in ("joint_names", "times_s", "position of J1", "effort", "velocity", "commands.kind"):
        assert any(fault.startswith(key + ":") for fault in error.value.faults), key
    with pytest.raises(ParameterError, match="gap of 2"):
        recording(times_s=times + 2.0 * (times > 1.0))
    recording()


def test_what_cannot_be_fitted_is_refused():
    still = recording(position=np.zeros((200, 2)))
    with pytest.raises(ParameterError) as error:
        identify_efforts(dataclasses.replace(still, joint_names=("J1", "J9")), NOMINAL, "hand")
    keys = [fault.split(":")[0] for fault in error.value.faults]
    assert keys == ["effort", "joint_names", "payload_link", "position"]
    with pytest.raises(ParameterError) as error:
        identify_loops(still)
    assert [fault.split(":")[0] for fault in error.value.faults] == ["commands", "position"]
    with pytest.raises(ModelError, match="floating"):
        TreeDynamics(NOMINAL.replace('"revolute"', '"floating"', 1))


def test_a_position_loop_is_fitted_by_its_own_equation():
    rng = np.random.default_rng(3)
    goals = np.repeat(rng.uniform(-0.5, 0.5, 20), 400)  # of every millisecond
    bandwidth, gain, delay, position, q = 12.0, 0.97, 37, 0.0, []
    for k in range(len(goals)):
        q.append(position)
        goal = goals[k - delay] if k >= delay else 0.0
        position = gain * goal + (position - gain * goal) * np.exp(-bandwidth * 1e-3)
    times = np.arange(len(goals)) * 1e-3
    commands = Commands("position", times[::20], goals[::20, None])
    found = identify_loops(Recording(("J1",), times[::10], np.array(q)[::10, None] + rng.normal(0, 2e-4, (800, 1)),
                                     commands=commands))
    assert [each.name for each in found.unknown] == ["joint_state_delay_s"]
    for name, truth in (("J1.bandwidth", bandwidth), ("J1.gain", gain), ("J1.command_delay_s", delay * 1e-3)):
        estimate = found.estimates[name]
        assert abs(estimate.value - truth) < 3.3 * estimate.stddev < 0.05 * truth
