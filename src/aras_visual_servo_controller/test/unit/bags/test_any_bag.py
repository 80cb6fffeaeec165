"""Whatever stands in a bag, a record is read from it or it is refused with the name of the bag."""
import shutil

import pytest
import rosbag
from hypothesis import given, settings, strategies as st
from messages import messages_of, write
from std_msgs.msg import String
from synthetic import make_record

from aras_visual_servo_controller.bags.bag import BagError, read_bag
from aras_visual_servo.ground.errors import ArasError

NUMBERS = st.floats() | st.sampled_from([0.0, -1.0, 1e308, float("nan"), float("inf")])
LISTS = st.lists(NUMBERS, max_size=4)
NAMES = st.lists(st.text(max_size=4) | st.sampled_from(["xn", "J1", "gantry"]), max_size=4)
#: Fields of a ServoState that a bag of another version, or of nobody's, may have otherwise.
STATES = {"s": LISTS, "e": LISTS, "s_star": LISTS, "q": LISTS, "set_point": LISTS, "feature_names": NAMES,
          "joint_names": NAMES, "phase": st.text(max_size=5) | st.sampled_from(["servo", "done", "teach"])}


@pytest.fixture(scope="module")
def original():
    return make_record(servo_images=4)


@pytest.fixture(scope="module")
def bag(tmp_path_factory, original):
    return write(tmp_path_factory.mktemp("any") / "run.bag", messages_of(original))


def read(path):
    try:
        assert len(read_bag(path)) > 0
    except BagError as error:
        assert path.name in str(error)
    except ArasError as error:
        assert str(error)


@pytest.mark.parametrize("text", ["{servo: 3}", "{sim: []}", "a: [", "[1]", "!!python/x"])
def test_a_text_that_is_no_scenario_is_noted(bag, original, text):
    copy = bag.with_name("scenario.bag")
    write_with_scenario(copy, original, text)
    assert any("does not say which scenario" in note for note in read_bag(copy).notes)


def write_with_scenario(path, original, text):
    with rosbag.Bag(str(path), "w") as file:
        for topic, message, stamp in messages_of(original):
            if topic != "scenario":
                file.write(f"/somewhere/{topic}", message, stamp)
        file.write("/somewhere/scenario", String(text))


@settings(deadline=None, max_examples=150, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 10**6), st.binary(min_size=1, max_size=8)), min_size=1, max_size=4))
def test_any_bytes_in_a_bag_are_read_or_refused(bag, edits):
    copy = bag.with_name("bytes.bag")
    data = bytearray(bag.read_bytes())
    for at, new in edits:
        at %= len(data)
        data[at:at + len(new)] = new
    copy.write_bytes(data)
    read(copy)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.integers(0, 10**6))
def test_a_bag_that_was_cut_anywhere_is_read_or_refused(bag, size):
    copy = bag.with_name("cut.bag")
    shutil.copy(bag, copy)
    with open(copy, "r+b") as file:
        file.truncate(size % copy.stat().st_size)
    read(copy)


@settings(deadline=None, max_examples=150, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 9), st.fixed_dictionaries({}, optional=STATES)), min_size=1, max_size=3))
def test_any_values_in_a_servos_row_are_read_or_refused(bag, original, edits):
    copy = bag.with_name("rows.bag")
    states = 0
    with rosbag.Bag(str(copy), "w") as file:
        for topic, message, stamp in messages_of(original):
            if topic == "servo_state":
                for number, values in edits:
                    if number == states:
                        for name, value in values.items():
                            setattr(message, name, value)
                states += 1
            file.write(f"/somewhere/{topic}", message, stamp)
    read(copy)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.text(max_size=9) | st.sampled_from(["[1]", "{name: 1}", "{servo: 3}", "a: [", "{servo: {plugins: 1}}",
                                              "{servo: [], name: {}}", "{servo: {plugins: [nobody]}}", "!!python/x"]))
def test_any_text_for_a_scenario_is_read_or_refused(bag, original, text):
    copy = bag.with_name("scenario.bag")
    write_with_scenario(copy, original, text)
    read(copy)
