"""A real arm: commands as float32, the numbers of its page."""

import re
from pathlib import Path

import numpy as np
import pytest

from aras_visual_servo import Command, kinematics_of, load_scenario, RealSettings
from aras_visual_servo_controller.real.float_commands import SetPointIntegrator

SECOND_NS = 1_000_000_000
FLOAT_ROUNDING = 1e-12  # a hundred additions of numbers near 1


def integrator(timeout_s=10.0):
    return SetPointIntegrator(("a", "b"), np.array([-1.0, -np.inf]), np.array([1.0, np.inf]), int(timeout_s * 1e9))


def test_integrates_a_velocity_from_the_measured_position():
    points = integrator()
    points.advance(0)
    points.command(Command(0, velocity={"a": 0.5}), [0.1, 0.2])
    for tick in range(1, 101):
        result = points.advance(tick * SECOND_NS // 100)
    assert result["a"] == pytest.approx(0.6, abs=FLOAT_ROUNDING)
    assert result["b"] == 0.2


def test_a_position_is_taken_at_once_and_clamped_to_the_limits():
    points = integrator()
    points.command(Command(0, position={"a": 5.0, "b": 5.0}), [0.0, 0.0])
    assert points.advance(0) == {"a": 1.0, "b": 5.0}


def test_integration_stops_at_the_limit_and_does_not_wind_up():
    points = integrator()
    points.advance(0)
    points.command(Command(0, velocity={"a": 1.0}), [0.9, 0.0])
    assert points.advance(SECOND_NS)["a"] == 1.0
    points.command(Command(SECOND_NS, velocity={"a": -1.0}), [0.9, 0.0])
    assert points.advance(3 * SECOND_NS // 2)["a"] == pytest.approx(0.5, abs=FLOAT_ROUNDING)


def test_a_velocity_without_successor_stops_after_the_timeout():
    points = integrator(timeout_s=0.2)
    points.advance(0)
    points.command(Command(0, velocity={"b": 1.0}), [0.0, 0.0])
    points.advance(SECOND_NS)
    assert points.advance(2 * SECOND_NS)["b"] == pytest.approx(0.2, abs=FLOAT_ROUNDING)


def test_a_joint_that_is_not_commanded_any_more_stops():
    points = integrator()
    points.advance(0)
    points.command(Command(0, velocity={"b": 1.0}), [0.0, 0.0])
    points.advance(SECOND_NS)
    points.command(Command(SECOND_NS), [0.0, 0.0])
    assert points.advance(2 * SECOND_NS)["b"] == pytest.approx(1.0, abs=FLOAT_ROUNDING)


def test_reset_forgets_everything():
    points = integrator()
    points.command(Command(0, position={"a": 0.5}), [0.0, 0.0])
    points.reset()
    assert points.advance(0) == {}


PAGE = (Path(__file__).parents[5] / "docs" / "real_robot.md").read_text(encoding="utf-8")


@pytest.fixture
def scenario(tmp_path):
    (block,) = [each for each in re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL) if "command: trajectory" in each]
    path = tmp_path / "my_arm.yaml"
    path.write_text(block, encoding="utf-8")
    return load_scenario(path)


def test_the_scenario_of_the_page_is_read_by_the_node(scenario):
    arm = kinematics_of(scenario.urdf_xml(), scenario.robot)
    settings = RealSettings.from_dict(scenario.real, arm.joint_names)
    assert (settings.controller, settings.speed_part) == ("/arm_controller", 0.1)
