"""The blocks printed in docs/extending.md, run as they stand there, from a folder of their own."""
import importlib
import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest
import yaml

import aras_visual_servo as avs
from aras_visual_servo.scenario.extends import merge

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "extending.md"
MAX_LINES = 45
BOUNDS = {"x_mm": 0.2, "y_mm": 0.2, "z_mm": 0.5, "angle_deg": 0.05}
ROUNDING = 1e-12


def block(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE.read_text(), re.DOTALL)[0]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with both files in it, where Python looks for modules; what it registers is forgotten afterwards."""
    from aras_visual_servo.features import base as features
    from aras_visual_servo.laws import base as laws

    (tmp_path / "my_servo.py").write_text(block("python"))
    (tmp_path / "mine.yaml").write_text(block("yaml"))
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield tmp_path
    sys.modules.pop("my_servo", None)
    features.FEATURES.pop("log_an", None)
    laws.LAWS.pop("bounded", None)


def overrides():
    document = merge(avs.load_scenario("experiment_1").as_dict(), yaml.safe_load(block("yaml")))
    return {f"servo.{key}": value for key, value in document["servo"].items()}


def test_the_module_is_short():
    assert len([line for line in block("python").splitlines() if line.strip()]) <= MAX_LINES


def test_its_feature_and_its_law_arrive_at_the_true_pose_no_faster_than_they_say(folder):
    record = avs.run(avs.load_scenario("experiment_1", overrides()))
    judgement = avs.judge(record)
    assert judgement.converged, judgement.reason
    for name, bound in BOUNDS.items():
        assert abs(judgement.final_error[name]) <= bound, (name, judgement.final_error)
    assert record.feature_names == ("xn", "yn", "log_an", "alpha")
    twist = record.twist[record.servo_rows]
    # Of the law's own twist; what holds the attitude comes on top, and is small.
    assert 0.078 < np.linalg.norm(twist[:, :3], axis=1).max() < 0.085


def test_its_row_is_that_of_the_depth_over_the_depth(folder):

    importlib.import_module("my_servo")
    loop = avs.ServoLoop(avs.load_scenario("experiment_1", overrides()))
    loop.run(limit_s=4.0)
    here = avs.View(loop.servo.reference.view, (0.1, -0.2, 1.7))
    L = avs.FeatureSet(("an", "log_an")).matrix(here)
    np.testing.assert_allclose(L[1] * here.features.an, L[0], atol=ROUNDING)


def commands():
    """The lines to type that the page prints after the scenario."""
    return re.findall(r"```\n(PYTHONPATH=.*?)\n```", PAGE.read_text())


def test_the_command_is_run_as_printed_and_passes(folder):
    [command] = commands()
    result = subprocess.run(["bash", "-c", command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            timeout=240)
    said = result.stdout.decode()
    assert result.returncode == 0 and "PASSED" in said, said


def test_settings_have_their_defaults_and_hold(folder):
    slow = {**overrides(), "servo.bounded": {"max_speed_m_s": 0.04}, "servo.time_limit_s": 3.0}
    loop = avs.ServoLoop(avs.load_scenario("experiment_1", slow))
    assert loop.servo.config.settings["bounded"].max_turn_rad_s == 0.4
    twist = loop.run(limit_s=9.0).twist
    assert 0.038 < np.nanmax(np.linalg.norm(twist[:, :3], axis=1)) < 0.043


@pytest.mark.parametrize("law", ["bounded", "ibvs"])
def test_every_bad_setting_is_named_with_what_is_allowed_whichever_law_is_in_use(folder, law):
    bad = {"max_speed_m_s": 0.0, "max_turn_rad_s": 4, "max_jerk": 1.0}
    faults = ["servo.bounded.max_jerk: unknown key, known are max_speed_m_s, max_turn_rad_s",
              "servo.bounded.max_speed_m_s: found 0.0, allowed > 0",
              "servo.bounded.max_turn_rad_s: found 4, allowed <= 3"]
    with pytest.raises(avs.ParameterError) as caught:
        avs.load_scenario("experiment_1", {**overrides(), "servo.law": law, "servo.bounded": bad})
    assert [fault.split(": ", 1)[1] for fault in caught.value.faults] == faults
    good = avs.load_scenario("experiment_1", {**overrides(), "servo.law": law}).servo
    with pytest.raises(avs.ParameterError) as caught:  # as the controller node reads it
        avs.ServoSettings.from_dict({**good, "bounded": bad})
    assert sorted(caught.value.faults) == [
        "servo/bounded/max_jerk: unknown key, allowed max_speed_m_s, max_turn_rad_s",
        "servo/bounded/max_speed_m_s: found 0.0, allowed a finite number > 0",
        "servo/bounded/max_turn_rad_s: found 4, allowed a finite number > 0 and <= 3"]


def test_over_ros_the_law_and_its_settings_give_the_run_in_process(folder):
    command = commands()[0].replace(" --in-process", "")
    result = subprocess.run(["bash", "-c", command], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                            timeout=240)
    said = result.stdout.decode()
    assert result.returncode == 0, said
    in_process = avs.run(avs.load_scenario(folder / "mine.yaml"))
    assert re.search(r"run hash +([0-9a-f]{16})", said).group(1) == in_process.run_hash


def test_a_module_that_is_not_there_and_an_unknown_name_list_what_is_known(folder):
    changes = {**overrides(), "servo.plugins": ["my_servo", "not_there"], "servo.law": "unbounded"}
    with pytest.raises(avs.ParameterError) as caught:
        avs.ServoLoop(avs.load_scenario("experiment_1", changes))
    text = str(caught.value)
    assert "'not_there'" in text and "ModuleNotFoundError" in text
    listed = text.split("found unbounded, allowed ")[1].splitlines()[0].split(", ")
    assert {"bounded", "decoupled", "ibvs"} <= set(listed) and listed == sorted(listed)
