"""Scenario files: found, resolved, checked; every fault named by its path."""

import copy
import os

import numpy as np
import pytest
import yaml

from aras_visual_servo import (
    keys_of, load_scenario, load_yaml, package_path, ParameterError, resolve_uri, robot_kinematics, scenario_from_dict,
    scenario_names, scenario_schema, ServoSettings)
from aras_visual_servo.scenario import scenario as scenario_module
from aras_visual_servo.scenario.check import check
from aras_visual_servo.config.files import find_scenario

SHIPPED = scenario_names()


@pytest.fixture
def document():
    return load_scenario("experiment_1").as_dict()


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_scenario_is_valid_and_named_after_its_file(name):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert scenario.description
    assert scenario.urdf_path.is_file()


@pytest.mark.parametrize("name", SHIPPED)
def test_the_servo_accepts_what_the_schema_accepts(name):
    ServoSettings.from_dict(load_scenario(name).servo)  # raises on a key or value it does not know


def test_the_schema_knows_every_key_of_the_servo():
    properties = scenario_schema()["properties"]["servo"]["properties"]
    assert {key.name for key in keys_of(ServoSettings)} <= set(properties)
    assert {"sliding", "broyden", "photometric"} <= set(properties)


@pytest.mark.parametrize("name", [name for name in SHIPPED
                                  if not name.startswith(("six_dof", "six_axis", "free", "vit_vs", "cns"))])
def test_experiments_of_four_features_look_straight_down_at_goal_and_start(name):
    experiment = load_scenario(name).experiment
    for place in ("goal", "start"):
        joints = experiment[place]["joints"]
        # Pitch joints add up; 1e-7 rad: the degrees of the paper are written with 8 digits.
        assert abs(joints["J2"] + joints["J3"] + joints["J5"]) < 1e-7


def test_the_free_camera_sees_the_scene_of_the_arm_from_the_same_goal():
    free, arm = load_scenario("free_camera"), load_scenario("six_dof_canonical")
    assert free.sim["scene"] == arm.sim["scene"] and free.sim["cameras"] == arm.sim["cameras"]
    assert free.vision == arm.vision and {**free.servo, "inverse": arm.servo["inverse"]} == arm.servo
    poses = []
    for scenario in (free, arm):
        kinematics = robot_kinematics(scenario.urdf_xml(), "world", "camera_optical_frame")
        poses.append(kinematics.pose(scenario.goal_posture(kinematics)))
    np.testing.assert_allclose(*poses, atol=1e-6)  # as the position is written


@pytest.mark.parametrize("name, may_differ", [
    ("experiment_1_paper", {"sim.cameras", "vision.segmentation", "vision.threshold", "vision.object_grey",
                            "vision.background_grey", "servo.law", "servo.mode", "servo.gains_per_s",
                            "servo.sample_time_s", "servo.thresholds", "servo.stop", "experiment.teach_images",
                            "experiment.judge"}),
    ("experiment_1_binary", {"sim.cameras", "vision.segmentation", "vision.threshold", "vision.object_grey",
                             "vision.background_grey", "servo.thresholds", "servo.hold_s", "servo.stop",
                             "experiment.judge"}),
])
@pytest.mark.parametrize("number", ["1", "2"])
def test_a_variant_differs_from_its_experiment_only_where_it_says(number, name, may_differ):
    name = name.replace("1", number)
    base, variant = load_scenario(f"experiment_{number}").as_dict(), load_scenario(name).as_dict()
    differing = {f"{section}.{key}" for section in scenario_module.SECTIONS
                 for key in set(base[section]) | set(variant[section])
                 if base[section].get(key) != variant[section].get(key)}
    assert differing == may_differ


def test_every_fault_is_listed_with_its_path(document):
    document["servo"]["gains_per_s"]["xn"] = -1
    document["servo"]["lambda"] = 3
    document["sim"]["cameras"][0]["width"] = "wide"
    del document["experiment"]["z_star_m"]
    with pytest.raises(ParameterError) as caught:
        scenario_from_dict(document, source="mine")
    text = str(caught.value)
    assert len(caught.value.faults) == 4
    for part in ("servo.gains_per_s.xn: found -1,", "servo.lambda: found an unknown key",
                 "sim.cameras[0].width: found wide,", "experiment.z_star_m: found nothing,"):
        assert f"mine: {part}" in text


@pytest.mark.parametrize("section", ["", "robot", "sim", "time", "vision", "servo", "experiment"])
def test_an_unknown_key_in_any_section_is_rejected(document, section):
    (document[section] if section else document)["surprise"] = 1
    assert [fault.path for fault in check(document)] == [(section, "surprise") if section else ("surprise",)]


@pytest.mark.parametrize("section", ["robot", "sim", "vision", "servo", "experiment"])
def test_a_missing_section_is_a_fault(document, section):
    del document[section]
    assert [fault.path for fault in check(document)] == [(section,)]


def test_motion_of_a_model_is_checked(document):
    model = document["sim"]["scene"]["models"][0]
    model["motion"] = {"type": "circle", "radius_m": 0.1, "angular_speed_rad_per_s": -0.5, "delay_s": 1.0}
    assert check(document) == []
    model["motion"] = {"type": "circle", "speed": 1.0}
    assert {fault.path[-1] for fault in check(document)} == {"speed", "radius_m", "angular_speed_rad_per_s"}
    model["motion"] = {"type": "dance"}
    assert len(check(document)) == 1


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True])
def test_a_number_that_is_not_finite_is_a_fault(document, value):
    document["servo"]["time_limit_s"] = value
    assert [fault.path for fault in check(document)] == [("servo", "time_limit_s")]


def test_a_number_that_yaml_takes_for_text_is_explained():
    with pytest.raises(ParameterError, match=r"found '5e-5', .*5\.0e-5"):
        load_scenario("experiment_1", {"servo.thresholds.xn": yaml.safe_load("5e-5")})


def test_missing_files_are_all_named(document):
    document["robot"]["urdf"] = "package://aras_description/urdf/none.urdf"
    document["robot"]["controllers"] = "package://no_such_package/x.yaml"
    document["sim"]["scene"]["models"][0]["file"] = "/no/such/target.yaml"
    with pytest.raises(ParameterError) as caught:
        scenario_from_dict(document)
    text = str(caught.value)
    assert "robot.urdf: found package://aras_description/urdf/none.urdf," in text
    assert "robot.controllers: found package://no_such_package/x.yaml," in text
    assert "sim.scene.models[0].file" in text


@pytest.mark.parametrize("key", ["features", "plugins", "law", "gains_per_s", "mode", "source", "target_model"])
@pytest.mark.parametrize("value", [None, True, 5, "", "xn", [], {}, [[]], [None], {5: None}, {"xn": []}])
def test_whatever_stands_at_a_key_of_several_checks_is_a_fault_or_fits(document, key, value):
    document["servo"][key] = value
    assert all(fault.path[1] in (key, "thresholds", "gains_per_s", "features") for fault in check(document))


def test_an_unknown_name_gets_the_nearest_one():
    with pytest.raises(ParameterError, match="experimnt_1_binary.*did you mean experiment_1_binary?"):
        find_scenario("experimnt_1_binary")


@pytest.mark.parametrize("found, ending", [("drak", "dark?"), ({"hue": [0, 9]}, "hue_deg?"), ("grey", "")])
def test_a_word_or_a_section_is_wrong_with_the_nearest_of_both(document, found, ending):
    document["vision"]["object"] = found
    faults = [fault for fault in check(document) if fault.path[:2] == ("vision", "object")]
    assert faults and str(faults[-1]).endswith(ending) and ("did you mean" in str(faults[-1])) == bool(ending)
    document["vision"]["object"] = {"hue_deg": [340, 20]}
    assert not [fault for fault in check(document) if fault.path[:2] == ("vision", "object")]


def test_a_path_loads_and_relative_files_start_at_it(tmp_path, document):
    (tmp_path / "arm.urdf").write_text("<robot/>")
    document["robot"]["urdf"] = "arm.urdf"
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(document))
    assert load_scenario(tmp_path / "mine.yaml").urdf_xml() == "<robot/>"


@pytest.mark.parametrize("text, reason", [("a: 1\na: 2\n", "given twice"), ("[1, 2]", "mapping"), ("a: [", "not YAML")])
def test_a_file_that_is_no_mapping_is_refused_with_its_name(tmp_path, text, reason):
    path = tmp_path / "bad.yaml"
    path.write_text(text)
    with pytest.raises(ParameterError, match=reason) as caught:
        load_scenario(path)
    assert "bad.yaml" in str(caught.value)


@pytest.mark.parametrize("bytes_, reason", [
    (b"name: caf\xe9\n", "not UTF-8: found the byte 0xe9 at position 9"),
    (b"a: " + b"[" * 100_000 + b"]" * 100_000, "yaml:1: found 65 sections within sections, allowed <= 64"),
    (b"a: &a [*a]", "yaml:1: *a "),
    (b"a0: &a0 [1, 1]\n" + b"".join(b"a%d: &a%d [*a%d, *a%d]\n" % (k, k, k - 1, k - 1) for k in range(1, 40)),
     "yaml:17: found 524285 values, allowed <= 500000"),
    (b"a0: &a0 [1]\n" + b"".join(b"a%d: &a%d [*a%d]\n" % (k, k, k - 1) for k in range(1, 100)),
     "sections within sections, allowed <= 64"),
    (b"a: " + b"1" * 2**22, "found 4194307 bytes, allowed <= 4194304"),
], ids=lambda value: value[-20:] if isinstance(value, str) else "")
def test_a_file_that_would_end_the_process_is_refused_with_its_name(tmp_path, bytes_, reason):
    path = tmp_path / "bad.yaml"
    path.write_bytes(bytes_)
    with pytest.raises(ParameterError) as caught:
        load_scenario(path)
    assert reason in str(caught.value) and "bad.yaml" in str(caught.value)


def test_a_file_that_never_ends_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(ParameterError, match="pipe.yaml: not a regular file"):
        load_yaml(tmp_path / "pipe.yaml")


@pytest.mark.parametrize("name", [".", "..", "...", "a/b", ""])
def test_a_name_that_would_leave_the_folder_of_results_is_refused(document, name):
    document["name"] = name
    with pytest.raises(ParameterError, match="name: found"):
        scenario_from_dict(document)


def test_overrides_replace_values_and_are_checked():
    scenario = load_scenario("experiment_1", {"servo.gains_per_s.xn": 1.5, "sim.seed": 7})
    assert scenario.servo["gains_per_s"]["xn"] == 1.5 and scenario.sim["seed"] == 7
    assert load_scenario("experiment_1").sim["seed"] == 0
    with pytest.raises(ParameterError, match="--set servo.nonsense=1: servo.nonsense: "):
        load_scenario("experiment_1", {"servo.nonsense": 1})
    with pytest.raises(ParameterError, match="--set servo.law.name=1: servo.law.name: "):
        load_scenario("experiment_1", {"servo.law.name": 1})


def test_overrides_name_entries_of_lists_and_remove_keys():
    before = load_scenario("experiment_1")
    after = load_scenario("experiment_1", {"sim.cameras.camera.noise_stddev": 4.0, "experiment.judge": None})
    assert after.sim["cameras"][0] == {**before.sim["cameras"][0], "noise_stddev": 4.0}
    assert "judge" in before.experiment and "judge" not in after.experiment
    with pytest.raises(ParameterError, match="sim.cameras.camra.noise_stddev: .*allowed one of camera"):
        load_scenario("experiment_1", {"sim.cameras.camra.noise_stddev": 4.0})
    with pytest.raises(ParameterError, match="servo.nonsense"):
        load_scenario("experiment_1", {"servo.nonsense": None})


def test_as_dict_round_trips_and_is_a_copy(document):
    again = scenario_from_dict(copy.deepcopy(document))
    again.as_dict()["servo"]["law"] = "changed"
    assert again.as_dict() == document


def test_ros_package_path_comes_before_the_neighbours(tmp_path, monkeypatch):
    folder = tmp_path / "aras_description"
    folder.mkdir()
    (folder / "package.xml").write_text("<package/>")
    (folder / "x.txt").write_text("mine")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert package_path("aras_description") == folder
    assert resolve_uri("package://aras_description/x.txt").read_text() == "mine"
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    assert package_path("aras_description") != folder
