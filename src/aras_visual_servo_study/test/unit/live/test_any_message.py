"""Whatever a page sends, it is a request or refused; and what was found by trying has a test of its own."""
import json

from hypothesis import given, settings, strategies as st

from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo_study.live.messages import REQUESTS, parse

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
