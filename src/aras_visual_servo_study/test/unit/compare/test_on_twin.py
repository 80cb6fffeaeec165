"""A recorded run on the twin of its arm: which run the twin repeats, and the numbers that compare both."""
import dataclasses
import json

import numpy as np
import pytest

import aras_visual_servo as avs
from aras_visual_servo import ParameterError, cli, load_scenario
from aras_visual_servo.cli.main import main
from aras_visual_servo_study.compare import on_twin
from aras_visual_servo_study.compare.on_twin import differences, replay_on_twin, twin_scenario
from aras_visual_servo_study.compare.settling import settling_s, settling_times_s

LOOPS = {name: {"p": 80.0, "d": 4.0}
         for name in ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll")}


def scenario(p=80.0, **changes):
    loops = {name: {**loop, "p": p} for name, loop in LOOPS.items()}
    return load_scenario("so101", {"robot.dynamics": {"loops": loops}, "sim.command_delay_s": 0.03, **changes})


@pytest.fixture(scope="module")
def measured():
    return avs.run(scenario())


@pytest.fixture
def overlay(tmp_path):
    loops = "{" + ", ".join(f"{name}: {{p: 20.0, d: 4.0}}" for name in LOOPS) + "}"
    (tmp_path / "robot.identified.yaml").write_text(
        f"name: found\nextends: so101\nrobot:\n  dynamics: {{loops: {loops}}}\nsim: {{command_delay_s: 0.05}}\n")
    return str(tmp_path / "robot.identified.yaml")


def servo_alone(record, teach=False):
    """The record of a bag that begins with the servo, on an arm whose goal was taught before."""
    rows = np.r_[record.rows("teach") if teach else np.zeros(0, dtype=int), record.servo_rows]
    columns = ("stamp_ns", "phase", "status", "status_text", "s", "s_star", "e", "twist", "q", "set_point", "raw",
               "X_WC", "stop")
    return dataclasses.replace(record, **{name: getattr(record, name)[rows] for name in columns})


def test_on_the_same_robot_the_run_is_repeated_bit_for_bit(measured):
    run = replay_on_twin(measured)
    np.testing.assert_array_equal(run.twin.q, measured.q)
    numbers = differences(run)
    assert all(of["rms"] == 0.0 for of in (*numbers["features"].values(), *numbers["joints"].values()))
    assert set(numbers["features"]) == {"xn", "yn", "an", "alpha"} and set(numbers["joints"]) == set(LOOPS)


def test_an_overlay_takes_the_place_of_the_recorded_robot_and_of_nothing_else(measured, overlay):
    twin, _ = twin_scenario(measured, overlay)
    assert twin.robot["dynamics"]["loops"]["elbow_flex"]["p"] == 20.0 and twin.sim["command_delay_s"] == 0.05
    assert twin.servo == scenario().servo and twin.experiment == scenario().experiment
    numbers = differences(replay_on_twin(measured, overlay))
    assert abs(numbers["settling_s"]["twin"] - numbers["settling_s"]["measured"]) > 0.02
    assert numbers["joints"]["shoulder_lift"]["largest"] > 1e-2


def test_a_bag_without_the_way_to_the_start_gives_start_goal_camera_and_rate(measured):
    twin, notes = twin_scenario(servo_alone(measured, teach=True))
    first, taught = measured.servo_rows[0], measured.rows("teach")
    kinematics = twin.kinematics()
    by_name = dict(zip(measured.joint_names, measured.q[first]))
    np.testing.assert_allclose(twin.start_posture(kinematics), kinematics.vector(by_name))
    by_name = dict(zip(measured.joint_names, measured.q[taught].mean(axis=0)))
    np.testing.assert_allclose(twin.goal_posture(kinematics), kinematics.vector(by_name))
    assert notes == [] and twin.sim["cameras"] == scenario().sim["cameras"]
    slow, info = servo_alone(measured), dict(measured.camera_info)
    info["K"] = [info["K"][0] * 1.1, *info["K"][1:]]
    stamps = slow.stamp_ns[0] + 2 * (slow.stamp_ns - slow.stamp_ns[0])
    slow = dataclasses.replace(slow, stamp_ns=stamps, camera_info=info)
    twin, notes = twin_scenario(slow)
    (camera,) = twin.sim["cameras"]
    assert twin_scenario(slow, age_s=0.04)[0].sim["cameras"][0]["latency_s"] == 0.04
    assert camera["rate_hz"] == pytest.approx(15.0, rel=1e-3) and camera["fx_px"] == info["K"][0]
    by_name = dict(zip(measured.joint_names, measured.q[measured.servo_rows[-1]]))
    np.testing.assert_allclose(twin.goal_posture(kinematics), kinematics.vector(by_name), atol=1e-6)
    assert len(notes) == 1


def test_limits_of_the_real_arm_that_the_twin_does_not_have_are_named(measured):
    assert twin_scenario(measured)[1] == []
    settings = {**measured.settings, "real": {**measured.settings["real"], "speed_part": 0.1}}
    _, notes = twin_scenario(dataclasses.replace(measured, settings=settings))
    assert len(notes) == 1 and notes[0].endswith(": speed_part")


def test_what_is_no_run_or_another_robot_is_refused(measured):
    with pytest.raises(ParameterError) as error:
        twin_scenario(dataclasses.replace(measured, settings={}, phase=np.full(len(measured), "teach")))
    assert [fault.split(":")[0] for fault in error.value.faults] == ["scenario", "phase"]
    with pytest.raises(ParameterError, match="--robot: found ur5e"):
        twin_scenario(measured, "ur5e")


def test_errors_settle_where_an_exponential_enters_its_band(measured):
    rows, rate = measured.servo_rows, 1.5
    t = (measured.stamp_ns[rows] - measured.stamp_ns[rows[0]]) * 1e-9
    e = measured.e.copy()
    e[rows] = np.column_stack([np.exp(-rate * t), -2.0 * np.exp(-2.0 * rate * t), 1e-6 + 0.0 * t, np.exp(-0.1 * t)])
    found = settling_times_s(dataclasses.replace(measured, e=e))
    assert found["xn"] == pytest.approx(np.log(20.0) / rate, abs=2e-3)
    assert found["yn"] == pytest.approx(np.log(20.0) / (2.0 * rate), abs=2e-3)
    assert found["an"] == 0.0 and np.isnan(found["alpha"])
    assert np.isnan(settling_s(dataclasses.replace(measured, e=e)))
    e[rows] = np.exp(-rate * t)[:, None] * np.array([1.0, -3.0, 2.0, 0.5])
    assert settling_s(dataclasses.replace(measured, e=e)) == pytest.approx(np.log(20.0) / rate, abs=2e-3)


def test_the_verb_writes_page_numbers_and_a_scenario_that_repeats_the_twin(measured, overlay, tmp_path, monkeypatch):
    bags = pytest.importorskip("aras_visual_servo_controller.bags.bag")
    monkeypatch.setattr(bags, "read_bag", lambda *_: measured)
    monkeypatch.setattr(on_twin, "image_age_s", lambda *_: None)
    assert main(["replay-on-twin", "run.bag", "--robot", overlay, "--out", str(tmp_path / "out")]) == cli.EXIT_PASSED
    numbers = json.loads((tmp_path / "out" / "on_twin.json").read_text())
    again = avs.run(load_scenario(tmp_path / "out" / "twin.yaml"))
    assert settling_s(again) == pytest.approx(numbers["settling_s"]["twin"], abs=1e-12)
    page = (tmp_path / "out" / "on_twin.html").read_text()
    assert all(f'id="{name}"' in page for name in ("size", "feature_xn", "joint_wrist_roll"))
    assert f"<td>{numbers['settling_s']['measured']:.3g}</td>" in page
