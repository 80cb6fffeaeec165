"""Scenarios that extend another one: what is merged, what is a fault, and in which line."""

import re

import pytest
import yaml

from aras_visual_servo import load_scenario, ParameterError, scenario_names, scenario_schema
from aras_visual_servo.scenario.extends import merge
from aras_visual_servo.config.files import find_scenario
from aras_visual_servo.scenario.starter import SECTIONS, starter

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


def with_robot(folder, *joints):
    """Writes arm.urdf, the arm of experiment_1 with other names of its joints J1, J2, ..."""
    text = load_scenario("experiment_1").urdf_path.read_text()
    for old, new in zip(("J1", "J2", "J3", "J5", "J6"), joints):
        text = text.replace(f'"{old}"', f'"{new}"')
    (folder / "arm.urdf").write_text(text)


def test_numbers_by_joint_are_inherited_for_joints_that_the_robot_has(tmp_path):
    with_robot(tmp_path, "K1", "K2", "K3", "K5", "K6")
    written(tmp_path, "base", """
name: base
extends: experiment_1
servo: {inverse: {joint_weights: {J1: 5.0}}, limits: {joint_acceleration: {J1: 5.0, gantry: 2.0}}}
sweep: {joints: {J1: [-0.1, 0.1]}}
""")
    text = """name: mine
extends: base.yaml
robot: {urdf: arm.urdf}
experiment: {goal: {joints: {gantry: 0.0, K1: 0.1}}, start: {joints: {J2: null, K2: 0.2}}}
"""
    mine = load_scenario(written(tmp_path, "mine", text))
    assert mine.experiment["goal"] == {"joints": {"gantry": 0.0, "K1": 0.1}}
    assert mine.experiment["start"] == {"joints": {"gantry": -0.1, "K2": 0.2}}
    assert mine.sim["initial_positions"] == {"gantry": 0.0}
    assert mine.servo["inverse"] == {"method": "damped"} and "joints" not in mine.sweep
    assert mine.servo["limits"] == {"joint_acceleration": {"gantry": 2.0}}
    wrong = text.replace("K1: 0.1", "K1: 0.1, J1: 0.0")
    [fault] = faults(written(tmp_path, "wrong", wrong))  # what the file says itself is checked
    assert fault.startswith(f"{tmp_path}/wrong.yaml:4: experiment.goal.joints.J1: found an unknown joint")
    camera = text.replace("joints: {gantry: 0.0, K1: 0.1}", "camera: {position_m: [0, 0, 1], rpy_rad: [0, 0, 0]}")
    (tmp_path / "arm.urdf").write_text((tmp_path / "arm.urdf").read_text().replace('"gantry"', '"rail"'))
    assert set(load_scenario(written(tmp_path, "camera", camera)).experiment["goal"]) == {"camera"}


def written_arm(folder):
    """An arm of other joint names than those of the scenarios, as a scenario with a task."""
    with_robot(folder, "K1", "K2", "K3", "K5", "K6")
    return written(folder, "arm", """
name: arm
task: experiment_2
robot: {urdf: arm.urdf}
experiment: {goal: {joints: {gantry: 0.05, K2: -0.1}}, start: {joints: {gantry: 0.0, K2: 0.2}}, z_star_m: 0.6}
""")


def test_an_arm_is_put_over_its_task_or_over_the_scenario_that_is_named_with_it(tmp_path):
    arm = written_arm(tmp_path)
    (tmp_path / "far").mkdir()
    alone = load_scenario(arm)
    assert alone.servo == load_scenario("experiment_2").servo and alone.experiment["z_star_m"] == 0.6
    assert alone.experiment["goal"]["joints"] == {"gantry": 0.05, "K2": -0.1} and alone.name == "arm"
    texts = {"listed": "extends: [../arm.yaml, six_dof_hybrid]", "named": "extends: six_dof_hybrid\nrobot: ../arm.yaml",
             "chain": "extends: [mine.yaml, six_dof_hybrid]"}
    written(tmp_path / "far", "mine", "name: mine\nextends: ../arm.yaml\n")
    for name, text in texts.items():
        both = load_scenario(written(tmp_path / "far", name, f"name: both\n{text}\n"))
        assert both.servo == load_scenario("six_dof_hybrid").servo
        assert {**both.experiment, "judge": None} == {**alone.experiment, "judge": None}
        assert both.urdf_path == tmp_path / "arm.urdf"
    over = load_scenario("six_dof_hybrid", {"robot": str(arm), "sim.seed": 3})
    assert over.experiment == both.experiment and over.robot == both.robot and over.sim["seed"] == 3
    mine = load_scenario(tmp_path / "far" / "mine.yaml")
    assert mine.servo == alone.servo and mine.experiment == alone.experiment
    task = load_scenario(written(tmp_path, "task", "name: task\nextends: arm.yaml\ntask: six_dof_hybrid\n"))
    assert task.servo == both.servo and task.experiment == both.experiment


def test_a_robot_that_is_no_arm_and_a_task_that_leads_back_are_faults(tmp_path):
    [fault] = faults(written(tmp_path, "mine", "name: mine\nextends: experiment_1\nrobot: experiment_2\n"))
    assert fault.startswith(f"{tmp_path}/mine.yaml:3: robot: found experiment_2,")
    [fault] = faults(written(tmp_path, "back", "name: back\ntask: back.yaml\n"))
    assert fault.startswith(f"{tmp_path}/back.yaml: task: found")


def test_a_circle_names_its_way(tmp_path):
    written(tmp_path, "b", "name: b\nextends: ./c.yaml\n")
    written(tmp_path, "c", "name: c\nextends: ./a.yaml\n")
    [fault] = faults(written(tmp_path, "a", "name: a\nextends: b.yaml\n"))
    assert fault.startswith(f"{tmp_path}/c.yaml:2: extends: ") and "a -> b -> c -> a" in fault


@pytest.mark.parametrize("extended, said", [
    ("experimnt_1", "found experimnt_1,"), ("experimnt_1", "did you mean experiment_1?"),
    ("no/such.yaml", "no/such.yaml"), ("[a]", "found a,"), ("[5]", "found 5,")])
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
    assert any(fault.startswith(f"{tmp_path}/mine.yaml:1: experiment: found nothing")
               for fault in faults(written(tmp_path, "mine", text)))


PLANTED = """name: mine
extends: experiment_1
sim:
  period_s: -1
vision:
  ordr: 3
servo:
  law: decupled
  features: [xn, yn, an, alfa]
  mode: look_than_move
  lamda: 3
  foo:
  hold_s: soon
  gains_per_s: {xn: 1,5}
  time_limit_s: 0
real:
  command: trajectry
"""
#: Line -> key, and what the fault says of it.
EXPECTED = {
    4: ("sim.period_s", "found -1"), 6: ("vision.ordr", "did you mean order?"),
    8: ("servo.law", "did you mean decoupled?"), 9: ("servo.features[3]", "did you mean alpha?"),
    10: ("servo.mode", "did you mean look_then_move?"), 11: ("servo.lamda", "unknown key"),
    12: ("servo.foo", "unknown key"), 13: ("servo.hold_s", "found soon"),
    14: ("servo.gains_per_s.5", "decimal mark is a point"), 15: ("servo.time_limit_s", "> 0"),
    17: ("real.command", "did you mean trajectory?")}


def by_line(found, file):
    """Line -> (key, text) of the faults of one file."""
    parts = [fault[len(f"{file}:"):].split(": ", 2) for fault in found if fault.startswith(f"{file}:")]
    assert len(parts) == len(found), found
    return {int(line): (key, text) for line, key, text in parts}


@pytest.mark.parametrize("extended", [False, True], ids=["its own", "that it extends"])
def test_all_faults_that_are_planted_come_in_one_error_each_with_its_line(tmp_path, extended):
    planted = written(tmp_path, "planted", PLANTED)
    mine = written(tmp_path, "mine", "name: mine\nextends: ./planted.yaml\nsim: {seed: 3}\n") if extended else planted
    found = faults(mine)
    assert max(map(len, found)) < 300 + len(str(planted)), "no list of every name"
    placed = by_line(found, planted)
    assert {line: key for line, (key, _) in placed.items()} == {line: key for line, (key, _) in EXPECTED.items()}
    for line, (_, part) in EXPECTED.items():
        assert part in placed[line][1]


def test_the_same_faults_stand_in_a_file_that_extends_nothing(tmp_path):
    document = load_scenario("experiment_1").as_dict()
    document["servo"].update(law="decupled", foo=None, hold_s="soon", mode="look_than_move")
    document["sim"]["cameras"][0]["width"] = "wide"
    mine = written(tmp_path, "mine", yaml.safe_dump(document))
    lines = mine.read_text().splitlines()
    for line, (key, _) in by_line(faults(mine), mine).items():
        assert lines[line - 1].strip(" -").startswith(key.split(".")[-1] + ":")
    assert len(faults(mine)) == 5


def test_faults_of_set_are_blamed_on_it_and_those_of_the_file_stay_with_the_file(tmp_path):
    planted = written(tmp_path, "planted", PLANTED)
    with pytest.raises(ParameterError) as caught:
        load_scenario(planted, {"servo.law": "pbv", "servo.nothing": None, "real.ahead_s": -1, "servo.law.name": 1})
    found = caught.value.faults
    assert {fault.split(": ")[0] for fault in found if fault.startswith("--set")} == {
        "--set servo.law=pbv", "--set servo.nothing=null", "--set real.ahead_s=-1", "--set servo.law.name=1"}
    in_file = by_line([fault for fault in found if not fault.startswith("--set")], planted)
    assert sorted(in_file) == sorted(set(EXPECTED) - {8})


LATE = "sim.cameras[0].latency_s"


@pytest.mark.parametrize("said, key", [
    ("mode: look_then_move\n  law: qp", "servo.mode"),
    ("features: [xn, yn, an, alpha, sx]", "servo.thresholds.sx"),
    ("law: paper\n  features: [xn, yn]", "servo.features"),
    ("sample_time_s: 3.0\n  mode: look_then_move", "servo.gains_per_s.xn"),
    ("features: [photometric]\n  gains_per_s: {photometric: 1}\n  thresholds: {photometric: 1}\n  law: photometric",
     "vision.photometric"),
    ("filter: {}\n  law: broyden", "servo.filter"),
    ("input_timeout_s: 0.03", LATE), ("source: sonar", "servo.source"),
    ("plugins: [no_such_module]", "servo.plugins"),
    ("inverse: {joint_weights: {J9: 2}}", "servo.inverse.joint_weights.J9")])
def test_what_does_not_fit_is_blamed_on_the_file_that_said_it_last(tmp_path, said, key):
    mine = written(tmp_path, "mine", f"name: mine\nextends: experiment_1\nservo:\n  {said}\n")
    late = {"sim.cameras": [{**BASE["sim"]["cameras"][0], "latency_s": 0.05}]} if key == LATE else {}
    if late:
        mine.write_text(mine.read_text() + "sim: {cameras: [{name: camera, latency_s: 0.05}]}\n")
    found = faults(mine)
    assert any(fault.split(": ")[1] == key for fault in found), found
    assert all(re.match(rf"{mine}:\d+: ", fault) for fault in found), found
    values = {f"servo.{name}": value for name, value in yaml.safe_load(mine.read_text())["servo"].items()}
    with pytest.raises(ParameterError) as caught:
        load_scenario("experiment_1", {**values, **late})
    assert all(fault.startswith("--set ") for fault in caught.value.faults), caught.value.faults
    assert any(key in fault for fault in caught.value.faults)


def test_values_set_before_stay_where_they_are_and_are_still_known(tmp_path):
    first = load_scenario("experiment_1", {"servo.mode": "look_then_move", "sim.seed": 3})
    first.sim["seed"] = 4
    assert first.with_overrides({"time.real_time_factor": 2.0}).sim["seed"] == 4
    with pytest.raises(ParameterError) as caught:
        first.with_overrides({"servo.law": "qp"})
    assert all(fault.startswith("--set servo.") for fault in caught.value.faults)


@pytest.mark.parametrize("base, said, key", [
    ("experiment_1", "servo: {features: [[1], {a: 1}]}", "servo.features"),
    ("six_dof_matches", "vision: {matches: 5}\nservo: {pose_from: depth}", "vision.matches"),
    ("experiment_1", "sim: {scene: {models: [5]}}\nrobot: {target_link: a}", "sim.scene.models[0]")])
def test_a_value_of_another_kind_where_sections_meet_is_a_fault(tmp_path, base, said, key):
    found = faults(written(tmp_path, "mine", f"name: mine\nextends: {base}\n{said}\n"))
    assert any(f": {key}" in fault for fault in found), found


def test_a_null_takes_away_what_may_be_left_out_and_nothing_else(tmp_path):
    text = "name: mine\nextends: experiment_1\nexperiment: {judge: null}\nservo: {visibility: null}\n"
    mine = load_scenario(written(tmp_path, "mine", text))
    assert "judge" not in mine.experiment and "visibility" not in mine.servo
    [fault] = faults(written(tmp_path, "mine", text + "real: {foo: null}\n"))
    assert fault.startswith(f"{tmp_path}/mine.yaml:5: real.foo: ")


def test_a_module_that_fails_on_import_is_a_fault_with_the_line_of_its_code(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    (tmp_path / "own_laws.py").write_text("import math\n\nmath.no_such_thing\n")
    (tmp_path / "unreadable_laws.py").write_text("def f(:\n")
    found = faults(written(tmp_path, "mine", "name: mine\nextends: experiment_1\nservo:\n"
                                             "  plugins: [own_laws, unreadable_laws]\n"))
    assert [fault.split(": ")[0] for fault in found] == [f"{tmp_path}/mine.yaml:4"] * 2
    assert f"{tmp_path}/own_laws.py:3: AttributeError" in found[0]
    assert f"{tmp_path}/unreadable_laws.py:1: SyntaxError" in found[1]


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


def test_an_arm_put_under_a_scenario_does_not_undo_what_the_scenario_says_of_the_real_arm(tmp_path):
    own = written(tmp_path, "own", "name: own\nextends: [ur5e, six_dof_points]\n"
                                   "real: {controller: /nowhere}\nservo: {time_limit_s: 7.0}\n")
    plain = written(tmp_path, "plain", "name: plain\nextends: six_dof_points\nreal: {controller: /nowhere}\n")
    assert load_scenario(own, {"robot": "ur5e"}).as_dict() == load_scenario(own).as_dict()
    under = load_scenario(plain, {"robot": "ur5e"})
    assert under.real["controller"] == "/nowhere" and under.robot == load_scenario("ur5e").robot
    assert load_scenario(own, {"robot": "panda"}).real == load_scenario("panda").real
