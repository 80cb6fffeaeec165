"""Features and joint states are paired by stamp, whatever the order in which they come."""

from aras_visual_servo.runs.pairing import StampPairer


def test_pairs_equal_stamps_whichever_comes_first():
    pairer = StampPairer()
    assert list(pairer.add_joints(10, "q10")) == []
    assert pairer.add_features(10, "f10") == [(10, "f10", "q10")]
    assert pairer.add_features(20, "f20") == []
    assert pairer.add_joints(20, "q20") == [(20, "f20", "q20")]


def test_never_takes_the_latest_joint_state_instead():
    pairer = StampPairer()
    pairer.add_joints(10, "q10")
    assert pairer.add_features(15, "f15") == []


def test_gives_up_on_a_joint_state_once_a_later_one_has_come():
    pairer = StampPairer()
    pairer.add_features(15, "f15")
    assert pairer.add_joints(20, "q20") == [(15, "f15", None)]


def test_keeps_features_in_order():
    pairer = StampPairer()
    pairer.add_features(10, "f10")
    pairer.add_features(20, "f20")
    assert pairer.add_joints(10, "q10") == [(10, "f10", "q10")]
    assert pairer.add_joints(20, "q20") == [(20, "f20", "q20")]


def test_time_that_goes_back_forgets_what_was_before():
    pairer = StampPairer()
    pairer.add_joints(1000, "old")
    pairer.add_features(1010, "old")
    assert list(pairer.add_joints(0, "q0")) == []
    assert pairer.restarts == 1
    assert pairer.add_features(0, "f0") == [(0, "f0", "q0")]


def test_features_may_show_first_that_time_went_back():
    pairer = StampPairer()
    for stamp in (0, 10, 20):
        pairer.add_joints(stamp, "old")
    for stamp in (0, 20):
        pairer.add_features(stamp, "old")
    assert pairer.add_features(0, "f0") == [], "the joint state of stamp 0 is of the time before"
    assert pairer.restarts == 1
    assert pairer.add_joints(0, "q0") == [(0, "f0", "q0")]
    assert pairer.restarts == 1


def test_joint_states_of_the_time_before_may_come_after_features_of_the_new_one():
    pairer = StampPairer()
    pairer.add_joints(20, "old")
    pairer.add_features(20, "old")
    assert pairer.add_features(0, "f0") == []
    assert pairer.add_joints(30, "old") == []
    assert pairer.add_joints(0, "q0") == [(0, "f0", "q0")]
    assert pairer.restarts == 1
    assert pairer.add_features(30, "f30") == [], "its joint state has not come, only one of the time before"


def test_features_of_the_time_before_may_come_after_joint_states_of_the_new_one():
    pairer = StampPairer()
    pairer.add_joints(20, "old")
    assert list(pairer.add_joints(0, "q0")) == []
    assert pairer.add_features(20, "old") == []
    assert pairer.add_features(0, "f0") == [(0, "f0", "q0")]


def test_even_when_the_joint_states_of_the_new_time_are_all_there():
    pairer = StampPairer()
    pairer.add_joints(30, "old")
    for stamp in (0, 10, 20):
        pairer.add_joints(stamp, f"q{stamp}")
    assert pairer.add_features(20, "old") == [(20, "old", "q20")], "taken for one of the new time"
    for stamp in (0, 10, 20):
        assert pairer.add_features(stamp, "new") == [(stamp, "new", f"q{stamp}")]


def test_time_may_go_back_again_and_again():
    pairer = StampPairer()
    for restarts in range(1, 5):
        for stamp in (0, 10):
            pairer.add_joints(stamp, f"q{stamp}")
        assert pairer.add_features(10, "f10") == [(10, "f10", "q10")]
        first, second = (pairer.add_joints, pairer.add_features)[::1 if restarts % 2 else -1]
        assert list(first(0, "new")) == []
        assert second(0, "new") == [(0, "new", "new")] and pairer.restarts == restarts


def test_keeps_no_more_than_its_capacity():
    pairer = StampPairer(capacity=2)
    for stamp in (10, 20, 30):
        pairer.add_joints(stamp, f"q{stamp}")
    assert pairer.add_features(10, "f10") == [(10, "f10", None)]
    assert pairer.add_features(20, "f20") == [(20, "f20", "q20")]
