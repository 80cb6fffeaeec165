"""The scenario's schema: sections of three packages, each key described once; any scenario is run or refused."""

import copy
from dataclasses import dataclass

import jsonschema
import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import (
    ArasError, Law, load_scenario, ParameterError, register_law, scenario_from_dict, scenario_schema, setting,
    yaml_section)
from aras_visual_servo.laws import base as laws
from aras_visual_servo.scenario.check import check
from aras_visual_servo.scenario.schema import described_sections

DESCRIBED = ("robot", "sim", "time", "vision", "servo", "experiment", "sweep")
#: Endings of names and the unit they stand for; the longer ones first.
UNITS = {"_per_s": "/s", "_m_s2": "m/s^2", "_rad_s2": "rad/s^2", "_m_s": "m/s", "_rad_s": "rad/s", "_hz": "Hz",
         "_px": "px", "_rad": "rad", "_deg": "deg", "_mm": "mm", "_m": "m", "_s": "s"}


@pytest.fixture
def document():
    return load_scenario("experiment_1").as_dict()


def keys_in(schema, before=""):
    """(dotted name, what is said of it, whether it is required) of each key of a section and of those in it."""
    for kind in [schema, *schema.get("oneOf", ()), *schema.get("anyOf", ())]:
        for key, found in kind.get("properties", {}).items():
            yield before + key, found, key in kind.get("required", ())
            yield from keys_in(found, f"{before}{key}.")
            yield from keys_in(found.get("items", {}), f"{before}{key}[].")


@pytest.mark.parametrize("name", DESCRIBED)
def test_every_key_has_a_line_of_meaning_a_unit_if_its_name_says_so_and_a_default_or_none(name):
    for key, found, required in keys_in(described_sections()[name], f"{name}."):
        assert found.get("description", "").strip(), key
        assert "\n" not in found["description"] and not (required and "default" in found), key
        ending = next((unit for end, unit in UNITS.items() if key.endswith(end)), None)
        if ending and found.get("type") != "object":
            assert found.get("unit", "").endswith(ending), (key, found.get("unit"))


def test_the_whole_is_a_json_schema():
    jsonschema.Draft7Validator.check_schema(scenario_schema())
    with pytest.raises(jsonschema.SchemaError):
        jsonschema.Draft7Validator.check_schema({"properties": {"a": {"minimum": "none"}}})


def test_defaults_are_values_that_are_allowed(document):
    """A scenario that writes every default down is accepted."""
    for name in DESCRIBED:
        section = document.setdefault(name, {})
        for key, found in scenario_schema()["properties"][name]["properties"].items():
            if "default" in found and found["default"] not in ({}, "", []):
                section.setdefault(key, found["default"])
    assert check(document) == []


def test_a_file_named_by_ref_stands_in_its_place_and_what_stands_beside_it_goes_first(tmp_path, monkeypatch):
    folder = tmp_path / "some_package"
    (folder / "schema").mkdir(parents=True)
    (folder / "package.xml").write_text("<package/>")
    (folder / "schema" / "a.yaml").write_text("type: object\nproperties: {b: {$ref: b, description: Mine.}}\n")
    (folder / "schema" / "b.yaml").write_text("{type: number, minimum: 2, description: Its own.}\n")
    (folder / "schema" / "c.yaml").write_text("properties: {c: {$ref: c}}\n")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    assert yaml_section("some_package", "a")["properties"]["b"] == {"type": "number", "minimum": 2,
                                                                    "description": "Mine."}
    for name, fault in (("c", "leads in a circle"), ("d", "no such file")):
        with pytest.raises(ParameterError, match=fault):
            yaml_section("some_package", name)


def test_a_law_whose_section_is_a_key_of_the_servo_is_refused(document):
    @dataclass(frozen=True)
    class Settings:
        size: float = setting(1.0, help="Any.")

    try:
        register_law("limits", settings=Settings)(type("Mine", (Law,), {}))
        assert [fault.path for fault in check(document)] == [("servo", "limits")]
    finally:
        laws.LAWS.pop("limits")
    assert check(document) == []


SHIPPED = {name: load_scenario(name) for name in ("experiment_1", "six_dof_rectangle")}
ODD = st.sampled_from([
    None, True, "", "xn", "..", "a/b", "package://nobody/x", 0, -1, 10**400, 2**63, 1e308, -1e308, 5e-324, float("inf"),
    float("nan"), [], {}, [[]], {"": 1}, {1: 2}, {None: 0}, [{}], "9" * 300])
VALUES = st.recursive(ODD | st.integers() | st.floats() | st.text(max_size=5),
                      lambda inner: st.lists(inner, max_size=4)
                      | st.dictionaries(st.text(max_size=5), inner, max_size=3), max_leaves=6)


def places(node, way=()):
    """Ways to everything in a document."""
    for key, value in node.items() if isinstance(node, dict) else enumerate(node):
        yield (*way, key)
        if isinstance(value, (dict, list)):
            yield from places(value, (*way, key))


def changed(document, way, value):
    *parents, last = way
    node = document
    for key in parents:
        node = node[key]
    node[last] = value


def outcome(document, base):
    try:
        scenario_from_dict(document, base=base)
    except ArasError as error:
        assert str(error)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.data())
def test_any_value_anywhere_is_accepted_or_refused(data):
    scenario = SHIPPED[data.draw(st.sampled_from(sorted(SHIPPED)))]
    document = copy.deepcopy(scenario.as_dict())
    changed(document, data.draw(st.sampled_from(list(places(document)))), data.draw(VALUES))
    outcome(document, scenario.path.parent)


@settings(deadline=None, max_examples=100, derandomize=True)
@given(st.data())
def test_any_override_is_accepted_or_refused(data):
    scenario = SHIPPED["experiment_1"]
    ways = [way for way in places(scenario.as_dict()) if all(isinstance(key, str) for key in way)]
    way = data.draw(st.sampled_from(ways))
    try:
        scenario.with_overrides({".".join(way): data.draw(VALUES)})
    except ArasError as error:
        assert str(error)
