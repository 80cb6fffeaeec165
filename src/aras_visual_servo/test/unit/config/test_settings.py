"""Settings described once, read and checked; any YAML is read or refused."""

import random
from dataclasses import dataclass
from typing import Dict, Optional, Tuple

import jsonschema
import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import keys_of, load_yaml, Names, ParameterError, read, setting
from aras_visual_servo.config.reader import faults_of
from aras_visual_servo.config.schema import schema_of
from aras_visual_servo.config.tables import table_of
from aras_visual_servo.ground.registry import one_of


@dataclass(frozen=True)
class Inner:
    """A section in the section."""

    weight: float = setting(above=0, help="Of the inner thing.")
    name: str = setting("x", choices=("x", "y"), help="What it is called.")


@dataclass(frozen=True)
class Everything:
    """A key of every kind."""

    gain_per_s: float = setting(unit="1/s", above=0, at_most=10, help="A number that has to be there.")
    boundary: Tuple[float, ...] = setting(above=0, by="feature", not_empty=True, help="A number per feature.")
    count: int = setting(3, at_least=1, help="A whole number.")
    open: bool = setting(False, help="True or false.")
    file: str = setting("", not_empty=True, help="A text.")
    normal: Tuple[float, ...] = setting((0.0, 0.0, 1.0), size=3, help="Three numbers.")
    names: Tuple[str, ...] = setting((), help="Texts.")
    weights: Dict[str, float] = setting({}, at_least=0, by="joint", help="A number per joint.")
    ranges: Dict[str, Tuple[float, ...]] = setting({}, size=2, help="Two numbers per name.")
    inner: Inner = setting(Inner(1.0), help="A section.")
    maybe: Optional[Inner] = setting(None, help="A section that may be left out.")
    anything: object = setting(None, help="Anything.")
    made_of_it: object = None  # no key

    def check(self):
        """More than one key."""
        if self.count > 5 and self.open:
            yield f"count: found {self.count}, allowed <= 5 with open: true"


GOOD = {"gain_per_s": 2, "boundary": {"pair": 0.1}}
NAMES = Names(("a", "b"), ("J1", "J2"), expand=lambda names: [n for name in names for n in
                                                              (("a", "b") if name == "pair" else (name,))])


def test_values_come_typed_and_what_is_missing_has_its_default():
    settings = read(Everything, {**GOOD, "count": 4.0, "normal": [1, 0, 0], "names": ["n"], "weights": {"J2": 0},
                                 "ranges": {"x": [0, 1]}, "maybe": {"weight": 2}}, "here", NAMES)
    assert settings == Everything(2.0, (0.1, 0.1), 4, normal=(1.0, 0.0, 0.0), names=("n",), weights={"J2": 0.0},
                                  ranges={"x": (0.0, 1.0)}, maybe=Inner(2.0))
    assert isinstance(settings.gain_per_s, float) and isinstance(settings.count, int)


@pytest.mark.parametrize("change, key, found, allowed", [
    ({"gain_per_s": 11}, "gain_per_s", "11", ["> 0", "<= 10"]),
    ({"gain_per_s": True}, "gain_per_s", "true", ["number"]),
    ({"gain_per_s": float("nan")}, "gain_per_s", "nan", ["finite"]),
    ({"gain_per_s": "1,5"}, "gain_per_s", "'1,5'", ["decimal mark", "1.5"]),
    ({"gain_per_s": "5e-5"}, "gain_per_s", "'5e-5'", ["5.0e-5"]),
    ({"count": 2.5}, "count", "2.5", ["whole", ">= 1"]),
    ({"open": 1}, "open", "1", ["true, false"]),
    ({"normal": [0, 1]}, "normal", "[0, 1]", ["3 numbers"]),
    ({"normal": [0, 1, "x"]}, "normal[2]", "x", ["number"]),
    ({"names": "n"}, "names", "n", ["a list"]),
    ({"weights": {"J3": 1}}, "weights.J3", "an unknown joint", ["J1, J2"]),
    ({"weights": {"J1": -1}}, "weights.J1", "-1", [">= 0"]),
    ({"ranges": {"x": [0]}}, "ranges.x", "[0]", ["2 numbers"]),
    ({"boundary": {"a": 1}}, "boundary.b", "nothing", ["number"]),
    ({"boundary": {"pair": 1, "c": 1}}, "boundary.c", "an unknown key", ["a, b"]),
    ({"boundary": 1}, "boundary", "1", ["table"]),
    ({"inner": {"name": "z", "weight": 1}}, "inner.name", "z", ["x, y"]),
    ({"maybe": {}}, "maybe.weight", "nothing", ["> 0", "required"]),
    ({"inner": []}, "inner", "[]", ["table"]),
    ({"contn": 1}, "contn", "an unknown key", ["did you mean count?"]),
    ({"contn": None}, "contn", "an unknown key", ["did you mean count?"]),
    ({"ranges": {"x": [0, 1], 5: None}}, "ranges.5", "a key without a value", ["decimal mark"]),
    ({"made_of_it": 1}, "made_of_it", "an unknown key", []),
    ({"count": 6, "open": True}, "count", "6", ["<= 5", "open: true"])])
def test_a_fault_names_place_value_and_what_is_allowed(change, key, found, allowed):
    with pytest.raises(ParameterError) as caught:
        read(Everything, {**GOOD, **change}, "here", NAMES)
    [fault] = caught.value.faults
    said, _, rest = fault.partition(", allowed ")
    assert said == f"here.{key}: found {found}" and all(part in rest for part in allowed), fault


def test_every_fault_is_listed():
    with pytest.raises(ParameterError) as caught:
        read(Everything, {"count": 0, "inner": {"weight": 0, "extra": 1}, "normal": 3, "boundary": {}}, "here", NAMES)
    assert sorted(fault.split(":")[0] for fault in caught.value.faults) == [
        "here.boundary", "here.boundary.a", "here.boundary.b", "here.count", "here.gain_per_s", "here.inner.extra",
        "here.inner.weight", "here.normal"]


def test_of_many_names_a_fault_says_how_many_there_are_and_the_nearest():
    names = [f"name_{k}" for k in range(60)]
    assert one_of(names, "nme_7") == "one of 60 names; did you mean name_7?"
    assert one_of(names, "else") == "one of 60 names"


def test_what_is_made_in_python_gets_the_same_check():
    assert faults_of(Everything(1.0, (0.1,))) == []
    bad = Everything(11.0, (0.1,), normal=(0.0, 1.0), inner=Inner(-1.0), count=0)
    assert sorted(str(fault).split(":")[0] for fault in faults_of(bad)) == [
        "count", "gain_per_s", "inner.weight", "normal"]
    assert [fault.path for fault in faults_of(Everything(1.0, (), count=6, open=True))] == [("count",)]


def test_positions_of_joints_keep_their_limits():
    @dataclass(frozen=True)
    class Place:
        joints: Dict[str, float] = setting(by="joint_position", help="Where.")

    names = Names(joints=("J1", "J2"), limits={"J1": (-1.0, 1.0)})
    assert read(Place, {"joints": {"J1": 1, "J2": 9}}, "place", names).joints == {"J1": 1.0, "J2": 9.0}
    with pytest.raises(ParameterError, match=r"place.joints.J1: found 2, .*>= -1.0 and <= 1.0"):
        read(Place, {"joints": {"J1": 2}}, "place", names)


def test_reader_and_schema_take_and_refuse_the_same():
    """Random documents; what only the reader knows (names of joints, `check`) is kept out of them."""
    rng = random.Random(0)
    values = [0, 1, -1, 2.5, 3.0, 11, True, "x", "", "z", None, [], [1, 2, 3], [1, 2], ["n"], {}, {"weight": 1},
              {"weight": 0}, {"weight": 1, "name": "y"}, {"weight": 1, "more": 1}, {"x": [0, 1]}, {"J1": 1}, {"J1": -1}]
    keys = [key.name for key in keys_of(Everything) if key.name != "boundary"]
    validator, taken = jsonschema.Draft7Validator(schema_of(Everything)), 0
    for _ in range(3000):
        document = {**GOOD, "boundary": {"a": 1, "b": 2}}
        for _ in range(rng.choice([1, 1, 2])):
            document[rng.choice(keys)] = rng.choice(values)
        faults = []
        read(Everything, document, "here", Names(("a", "b")), faults=faults)
        accepted = not [fault for fault in faults if "with open" not in fault]
        assert accepted == validator.is_valid(document), (document, faults)
        taken += accepted
    assert 300 < taken < 2700


def test_the_table_says_unit_default_range_and_meaning():
    rows = table_of(schema_of(Everything))
    assert "| `gain_per_s` | required | (0, 10] 1/s | A number that has to be there. |" in rows
    assert "| `count` | 3 | integer >= 1 | A whole number. |" in rows
    assert "| `boundary` | required | > 0 by name | A number per feature. |" in rows
    assert "| `inner.name` | `x` | `x`, `y` | What it is called. |" in rows
    assert "| `maybe` | off |  | A section that may be left out. |" in rows
    one_row = table_of(schema_of(Everything), {"part": schema_of(Everything)["properties"]["inner"]})
    assert not any("`inner.name`" in row for row in one_row) and any("table `part`" in row for row in one_row)


def test_a_class_that_does_not_describe_its_keys_is_refused():
    @dataclass(frozen=True)
    class NoHelp:
        speed: float = setting(1.0, help="")

    @dataclass(frozen=True)
    class NoType:
        speed: set = setting(1.0, help="How fast.")

    @dataclass
    class NotFrozen:
        speed: float = setting(1.0, help="How fast.")

    for cls in (NoHelp, NoType, NotFrozen, int):
        with pytest.raises(ParameterError, match=f"settings {cls.__name__}"):
            keys_of(cls)


#: Pieces that YAML gives a meaning to.
PIECES = st.sampled_from([
    "a", "b: ", "- ", "{", "}", "[", "]", ",", "? ", ": ", "\n", "\n  ", "&x ", "*x", "<<: ", "!!int ", "!!float ",
    "!!timestamp ", "!!binary ", "!!set ", "!!python/name:os.system ", "2001-99-99", "1e999", "0x", "9" * 5000, ".inf",
    "~", "'", '"', "|\n", ">\n", "---\n", "%TAG", "# ", "\t", "\ufeff", "12:61"])
TEXTS = st.one_of(st.lists(PIECES, max_size=30).map("".join), st.text(max_size=200))


def load(folder, data):
    path = folder / "any.yaml"
    path.write_bytes(data)
    try:
        found = load_yaml(path)
    except ParameterError as error:
        assert str(path) in str(error)
        return error
    assert isinstance(found, dict)
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("yaml")


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(TEXTS)
def test_any_text_is_a_mapping_or_refused_by_the_name_of_its_file(folder, text):
    load(folder, text.encode("utf-8", "surrogatepass"))


@settings(deadline=None, max_examples=300, derandomize=True)
@given(st.binary(max_size=200))
def test_any_bytes_are_a_mapping_or_refused_by_the_name_of_their_file(folder, data):
    load(folder, data)


@pytest.mark.parametrize("text", ["a: 2001-99-99", "a: " + "9" * 5000, "a: !!int b", "a: !!float b", "a: !!timestamp b",
                                  "a: 2001-01-01 00:00:00 +99", "[a]: b", "? {a: b}\n: c", "a: !!set {[b]}",
                                  "a: !!set b"])
def test_a_value_that_does_not_exist_is_refused_with_its_line(folder, text):
    error = load(folder, f"first: 1\n{text}\n".encode())
    assert isinstance(error, ParameterError), f"found {error}"
    assert str(error).startswith(f"{folder}/any.yaml:2: ")


@pytest.mark.parametrize("text", ["a:\n\tb: 1", "a:\n  b: 1\n\tc: 2", "a: 1\n\tb: 2"])
def test_a_tab_in_the_indentation_is_called_a_tab(folder, text):
    error = load(folder, text.encode())
    line = 1 + text[:text.index("\t")].count("\n")
    assert str(error).startswith(f"{folder}/any.yaml:{line}: ") and "tab" in str(error)


def test_other_tabs_and_other_faults_are_not_blamed_on_tabs(folder):
    assert load(folder, b"a:\tb # \t\n") == {"a": "b"}
    assert "tab" not in str(load(folder, b"a: [\n"))
