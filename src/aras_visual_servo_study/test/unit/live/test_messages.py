"""What a page may ask: each request is checked and described in the docs, and nonsense is answered."""

import json
import pathlib

import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import keys_of, ParameterError
from aras_visual_servo_study.live.messages import MOST_BYTES, parse, REQUESTS, Set, Speed

DOCS = pathlib.Path(__file__).resolve().parents[5] / "docs" / "reference" / "live_messages.md"


def test_a_request_is_read_with_its_number():
    number, request = parse(json.dumps({"do": "speed", "factor": 2, "id": 7}))
    assert number == 7 and request == Speed(2)


@pytest.mark.parametrize("text, said", [
    ("{", "allowed JSON"), ("[1]", "found \\[1\\], allowed an object"), ("12.5", "allowed an object"),
    ('{"do": "explode"}', "found do 'explode', allowed .*start"), ('{"do": ["start"]}', "found do"),
    ('{"do": "speed", "factor": "fast"}', "speed.factor: found fast, .*number"),
    ('{"do": "speed", "factor": -1}', "speed.factor: found -1"), ('{"do": "speed", "factor": NaN}', "speed.factor"),
    ('{"do": "speed"}', "speed.factor"), ('{"do": "stop", "now": true}', "stop.now: found"),
    ('{"do": "place_target", "position_m": [1, 2], "q_xyzw": [0, 0, 0, 1]}', "place_target.position_m"),
    ('{"do": "start", "id": "x"}', "id 'x'"), ("x" * (MOST_BYTES + 1), "bytes, allowed <="),
    ('{"do": "step", "images": 1e9}', "step.images"), ("\x00", "allowed JSON")])
def test_nonsense_is_refused_by_name(text, said):
    with pytest.raises(ParameterError, match=said):
        parse(text)


def test_the_number_of_a_refused_request_is_known():
    with pytest.raises(ParameterError) as caught:
        parse('{"do": "explode", "id": 3}')
    assert caught.value.id == 3


def test_every_request_and_field_stands_in_the_docs():
    text = DOCS.read_text()
    for name, cls in REQUESTS.items():
        assert f"| `{name}` |" in text, name
        for key in keys_of(cls):
            assert f"`{key.name}`" in text, (name, key.name)
    assert set(REQUESTS) >= {"start", "stop", "teach", "reset", "pause", "step", "speed", "set", "joint", "save"}
    assert Set.do == "set"


FIELDS = ["id", "do", "reference", "z_star_m", "paused", "images", "factor", "follow", "values", "position_m", "q_xyzw",
          "motion", "name", "position", "start_here"]
SCALARS = (st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
           | st.sampled_from(list(REQUESTS)))
VALUES = st.recursive(SCALARS, lambda inner: st.lists(inner, max_size=4)
                      | st.dictionaries(st.sampled_from(FIELDS), inner, max_size=3), max_leaves=10)


def answer(text):
    try:
        number, request = parse(text)
        assert type(request) in REQUESTS.values()
    except ParameterError as error:
        assert str(error)
        number = error.id
    assert isinstance(number, (int, type(None)))


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(st.text(max_size=200))
def test_any_text_is_a_request_or_refused(text):
    answer(text)


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(st.dictionaries(st.sampled_from(FIELDS), VALUES, max_size=5), st.sampled_from(list(REQUESTS)))
def test_any_object_is_a_request_or_refused(content, name):
    answer(json.dumps({"do": name, "id": 1, **content}))


def test_a_message_of_lists_within_lists_is_refused():
    answer("[" * 60000)
    answer('{"id": 1, "do": "set", "values": ' + "[" * 30000 + "]" * 30000 + "}")


def test_a_number_of_5000_digits_is_refused():
    answer('{"id": 1, "do": "speed", "factor": ' + "9" * 5000 + "}")
    answer('{"id": ' + "9" * 4000 + ', "do": "stop"}')
    answer('{"id": 1, "do": "speed", "factor": ' + "9" * 4000 + "}")
