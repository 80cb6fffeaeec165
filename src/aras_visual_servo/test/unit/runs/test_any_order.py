"""Features and joint states in any order, of any stamps: each is paired with its own, and nothing piles up."""
from hypothesis import given, settings, strategies as st

from aras_visual_servo.runs.pairing import StampPairer

CAPACITY = 5
STAMPS = st.integers(0, 12) | st.integers(-2**63, 2**63)


@settings(deadline=None, max_examples=1000, derandomize=True)
@given(st.lists(st.tuples(st.booleans(), STAMPS), max_size=60))
def test_each_features_message_is_handed_out_once_with_the_joints_of_its_stamp(messages):
    pairer, handed = StampPairer(CAPACITY), []
    for n, (is_features, stamp_ns) in enumerate(messages):
        add, what = (pairer.add_features, n) if is_features else (pairer.add_joints, ("joints of", stamp_ns))
        pairs = add(stamp_ns, what)
        for stamp, features, joints in pairs:
            handed.append(features)
            assert messages[features] == (True, stamp) and joints in (None, ("joints of", stamp))
    assert handed == sorted(set(handed)), "each once, in the order in which they came"
    if not pairer.restarts:
        given_ = [n for n, (is_features, _) in enumerate(messages) if is_features]
        assert handed == given_[:len(handed)] and len(given_) - len(handed) <= CAPACITY


def test_features_that_no_joint_state_answers_do_not_pile_up():
    pairer = StampPairer(CAPACITY)
    pairs = [pair for k in range(1000) for pair in pairer.add_features(k, "seen")]
    assert pairs == [(k, "seen", None) for k in range(1000 - CAPACITY)]
