"""The in-process loop: the real simulator, extractor and sequence; no ROS."""

import numpy as np
import pytest

from aras_visual_servo_controller import laws
from aras_visual_servo_controller.experiment import judge
from aras_visual_servo_controller.loop import ServoLoop
from aras_visual_servo_controller.record import PHASES
from aras_visual_servo_controller.scenario import load_scenario


@pytest.fixture(scope="module")
def record():
    return ServoLoop(load_scenario("experiment_1")).run()


def test_experiment_1_converges_and_passes_its_judge(record):
    judgement = judge(record)
    assert judgement.passed, judgement.faults


def test_goes_through_the_phases_in_order(record):
    order = list(dict.fromkeys(record.phase.tolist()))
    assert order == [phase for phase in PHASES if phase != "idle"]


def test_has_a_row_for_every_image_from_time_zero(record):
    assert record.stamp_ns[0] == 0
    assert np.all(np.diff(record.stamp_ns) <= 34_000_000)  # 30 Hz on ticks of 1 ms: 33 or 34 ms
    assert np.all(np.diff(record.stamp_ns) >= 33_000_000)


def test_a_second_run_gives_the_same_bytes(record):
    again = ServoLoop(load_scenario("experiment_1")).run()
    assert again.run_hash == record.run_hash
    for name in ("stamp_ns", "e", "q", "twist", "X_WC"):
        np.testing.assert_array_equal(getattr(again, name), getattr(record, name), name)


def test_another_seed_of_a_noisy_camera_gives_another_hash(record):
    noisy = {"sim.cameras": [dict(load_scenario("experiment_1").sim["cameras"][0], noise_stddev=1.0)]}
    hashes = set()
    for seed in (1, 2):
        loop = ServoLoop(load_scenario("experiment_1", {**noisy, "sim.seed": seed}))
        loop.start()
        for _ in range(3):
            loop.step()
        hashes.add(loop.sim.run_hash)
    assert len(hashes) == 2


def test_a_law_with_the_wrong_sign_does_not_converge(monkeypatch):
    def turned(original):
        class Turned(original):
            def step(self, features, dt_s):
                return -super().step(features, dt_s)
        return Turned

    scenario = load_scenario("experiment_1", {"servo.time_limit_s": 3.0})
    make_law = laws.make_law

    def make_turned(*arguments):
        law = make_law(*arguments)
        law.__class__ = turned(law.__class__)
        return law
    monkeypatch.setattr("aras_visual_servo_controller.servo.make_law", make_turned)
    record = ServoLoop(scenario).run()
    judgement = judge(record)
    assert not judgement.converged
    assert abs(judgement.final_feature_error["xn"]) > abs(record.e[record.servo_rows[0], 0])


def test_gives_up_at_the_limit_of_simulated_time():
    record = ServoLoop(load_scenario("experiment_1")).run(limit_s=0.5)
    assert record.t_s[-1] < 0.6
    assert any("given up" in note for note in record.notes)


def test_idle_steps_command_nothing():
    loop = ServoLoop(load_scenario("experiment_1"))
    for _ in range(3):
        answer, features, image = loop.step()
        assert answer.phase == "idle"
        assert image.shape[:2] == (240, 320)
    assert loop.sim.refused_commands == 0
