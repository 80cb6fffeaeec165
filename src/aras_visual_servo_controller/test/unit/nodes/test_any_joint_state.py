"""Whatever joint states come: positions in the order that was asked for, or a refusal that says what is missing."""
import pytest
from hypothesis import given, settings, strategies as st
from sensor_msgs.msg import JointState

from aras_visual_servo.ground.errors import ShapeError
from aras_visual_servo_controller.nodes.conversions import JointReader

NAMES = st.sampled_from(["a", "b", "c", "other", ""])


@settings(deadline=None, max_examples=500, derandomize=True)
@given(st.lists(st.tuples(st.lists(NAMES, max_size=5), st.lists(st.floats(), max_size=5)), min_size=1, max_size=4))
def test_positions_are_those_of_the_names_or_refused(messages):
    reader = JointReader(["a", "b"])
    for names, positions in messages:
        message = JointState(name=names, position=positions)
        if {"a", "b"} <= set(names) and len(names) == len(positions):
            found = reader.positions(message)
            assert list(map(repr, map(float, found))) == [repr(positions[names.index(name)]) for name in ("a", "b")]
        else:
            with pytest.raises(ShapeError, match="joint_states: found .*(missing|allowed)"):
                reader.positions(message)
