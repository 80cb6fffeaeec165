"""The scenario that docs/real_robot.md shows is one, and names what there is."""

import re
from pathlib import Path

import pytest

from aras_visual_servo import keys_of, kinematics_of, load_scenario, RealSettings
from aras_visual_servo.arm.real import FORMS

PAGE = (Path(__file__).parents[5] / "docs" / "real_robot.md").read_text(encoding="utf-8")


@pytest.fixture
def scenario(tmp_path):
    (block,) = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)
    path = tmp_path / "my_arm.yaml"
    path.write_text(block, encoding="utf-8")
    return load_scenario(path)


def test_the_scenario_of_the_page_is_read_by_the_node(scenario):
    arm = kinematics_of(scenario.urdf_xml(), scenario.robot)
    settings = RealSettings.from_dict(scenario.real, arm.joint_names)
    assert (settings.controller, settings.speed_part) == ("/arm_controller", 0.1)


def test_the_page_names_every_form_and_only_keys_that_there_are(scenario):
    known = {key.name for key in keys_of(RealSettings)}
    assert set(re.findall(r"`real\.(\w+)", PAGE)) <= known
    rows = re.findall(r"^\| .*? \| `(\w+)` \|", PAGE, re.MULTILINE)
    assert set(rows) == set(FORMS)
