"""Scenarios that extend another one: what is merged, what is a fault, and in which line."""

import re

import pytest
import yaml

from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo.scenario.extends import merge
from aras_visual_servo.scenario.files import find_scenario, scenario_names
from aras_visual_servo.scenario.scenario import load_scenario
from aras_visual_servo.scenario.starter import SECTIONS, starter
from aras_visual_servo.scenario.schema import scenario_schema

BASE = load_scenario("experiment_1").as_dict()


def written(folder, name, text):
    path = folder / f"{name}.yaml"
    path.write_text(text)
    return path


def faults(path):
    with pytest.raises(ParameterError) as caught:
        load_scenario(path)
    return caught.value.faults


def test_only_what_differs_is_said_and_the_whole_is_loaded(tmp_path):
    mine = load_scenario(written(tmp_path, "mine", """
name: mine
extends: experiment_1
servo: {gains_per_s: {xn: 1.5}}
sim:
  cameras:
    - {name: camera, noise_stddev: 2.0}
experiment: {judge: null}
"""))
    expected = load_scenario("experiment_1").as_dict()
    expected.update(name="mine", description="")
    expected["servo"]["gains_per_s"]["xn"] = 1.5
    expected["sim"]["cameras"][0]["noise_stddev"] = 2.0
    del expected["experiment"]["judge"]
    assert mine.as_dict() == expected
    assert "extends" not in mine.as_yaml() and yaml.safe_load(mine.as_yaml()) == expected


def test_lists_whose_entries_have_no_names_and_other_values_take_the_place_of_the_old_ones():
    result = merge(BASE, {"extends": "x", "name": "y", "sim": {"gravity_m_s2": [0, 0, 0], "seed": 4}})
    assert result["sim"]["gravity_m_s2"] == [0, 0, 0] and result["sim"]["seed"] == 4 and result["name"] == "y"
    assert "extends" not in result and BASE["sim"]["seed"] == 0


def test_an_entry_with_a_new_name_comes_last():
    models = merge(BASE, {"sim": {"scene": {"models": [{"name": "cup"}, {"name": "target", "visible": False}]}}})
    target, cup = models["sim"]["scene"]["models"]
    assert cup == {"name": "cup"} and target == {**BASE["sim"]["scene"]["models"][0], "visible": False}


def test_gains_of_features_that_are_no_longer_used_go_with_them():
    servo = merge(BASE, {"servo": {"features": ["xn", "points2"], "gains_per_s": {"points2": 1.0}}})["servo"]
    assert servo["gains_per_s"] == {"xn": 3.0, "points2": 1.0} and servo["thresholds"] == {"xn": 0.00005}


def test_a_chain_of_files_is_followed_and_relative_names_stay_with_their_file(tmp_path):
    (tmp_path / "far").mkdir()
    urdf = load_scenario("experiment_1").urdf_path
    (tmp_path / "far" / "arm.urdf").write_text(urdf.read_text())
    written(tmp_path / "far", "base", "name: base\nextends: experiment_2\nrobot: {urdf: arm.urdf}\n")
    mine = load_scenario(written(tmp_path, "mine", "name: mine\nextends: far/base.yaml\n"))
    assert mine.urdf_path == tmp_path / "far" / "arm.urdf"
    assert mine.experiment == load_scenario("experiment_2").experiment


def test_a_circle_names_its_way(tmp_path):
    written(tmp_path, "b", "name: b\nextends: ./c.yaml\n")
    written(tmp_path, "c", "name: c\nextends: ./a.yaml\n")
    [fault] = faults(written(tmp_path, "a", "name: a\nextends: b.yaml\n"))
    assert fault == f"{tmp_path}/c.yaml:2: extends: leads in a circle, a -> b -> c -> a"


@pytest.mark.parametrize("extended, said", [
    ("experiment_99", "scenario 'experiment_99': not found, known are"), ("no/such.yaml", "no such file"),
    ("[a]", "found ['a'], allowed is the name of a scenario or the path of a file")])
def test_a_name_that_nobody_knows_is_a_fault_with_its_line(tmp_path, extended, said):
    [fault] = faults(written(tmp_path, "mine", f"name: mine\n\nextends: {extended}\n"))
    assert fault.startswith(f"{tmp_path}/mine.yaml:3: extends: ") and said in fault


def test_faults_point_to_the_line_of_the_file_that_says_the_key(tmp_path):
    base = written(tmp_path, "base", "name: base\nextends: experiment_1\nservo:\n  # a comment\n  time_limit_s: -1\n")
    mine = written(tmp_path, "mine", """name: mine
extends: ./base.yaml
sim:
  cameras:
    - name: camera
      width: wide
servo:
  lambda: 3
  stop: {rule: 5}
experiment: {z_star_m: null}
""")
    assert {fault.partition(": ")[0]: fault.partition(": ")[2].partition(":")[0] for fault in faults(mine)} == {
        f"{mine}:6": "sim.cameras[0].width", f"{mine}:8": "servo.lambda", f"{mine}:9": "servo.stop.rule",
        f"{base}:5": "servo.time_limit_s", f"{mine}:10": "experiment.z_star_m"}


def test_a_section_that_is_missing_points_to_the_file(tmp_path):
    text = "name: mine\n" + "".join(f"{section}: {{}}\n" for section in ("robot", "sim", "vision", "servo"))
    assert f"{tmp_path}/mine.yaml:1: experiment: missing" in faults(written(tmp_path, "mine", text))


def test_a_value_given_by_hand_has_no_line(tmp_path):
    with pytest.raises(ParameterError, match=r"mine.yaml: servo.lambda: unknown key"):
        load_scenario(written(tmp_path, "mine", "name: mine\nextends: experiment_1\n"), {"servo.lambda": 3})


@pytest.mark.parametrize("name", scenario_names())
def test_shipped_scenarios_repeat_nothing_of_what_they_extend(name):
    document = yaml.safe_load(find_scenario(name).read_text())
    if "extends" not in document:
        return
    base = load_scenario(document["extends"]).as_dict()

    def repeated(said, known, place):
        if isinstance(said, dict) and isinstance(known, dict):
            return [line for key, value in said.items() if key in known
                    for line in repeated(value, known[key], f"{place}.{key}")]
        return [place] if said == known and place.count(".") == 2 else []  # whole values; poses are said whole
    assert repeated(document, base, "") == []


def uncommented(text):
    """As the file's first lines tell: the # away, and what ## explains stays."""
    return re.sub(r"^#(?=\w|  )", "", text, flags=re.MULTILINE)


@pytest.mark.parametrize("base", ["experiment_1", "six_dof_points", "six_dof_photometric", "free_camera"])
def test_a_starter_does_what_its_base_does_with_its_keys_commented_or_not(tmp_path, base):
    text = starter("mine", base)
    expected = {**load_scenario(base).as_dict(), "name": "mine"}
    for name, content in (("whole", text), ("open", uncommented(text))):
        found = load_scenario(written(tmp_path, name, content)).as_dict()
        for section in ("robot", "experiment"):
            assert {key: found[section].get(key) for key in expected[section]} == expected[section]
        assert found["servo"]["gains_per_s"] == expected["servo"]["gains_per_s"]
    assert uncommented(text).count("\nservo:") == 1 and "\nservo:" not in text


def test_a_starter_has_every_key_of_the_schema_once_with_its_meaning():
    text, properties = starter("mine"), scenario_schema()["properties"]
    assert set(SECTIONS) == set(properties) - {"name", "description"}
    for section in SECTIONS:
        part = text.split(f"\n#{section}:\n")[1].split("\n\n")[0]
        assert re.findall(r"^#  ([\w]+):", part, re.MULTILINE) == list(properties[section]["properties"])
    assert "## [1/s] > 0 by name: Rate at which each feature decays" in text
    assert max(map(len, text.splitlines())) <= 160
