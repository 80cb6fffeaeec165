"""Features and joint states are paired by stamp, whatever the order in which they come."""

from aras_visual_servo_controller.run.pairing import StampPairer


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


def test_keeps_no_more_than_its_capacity():
    pairer = StampPairer(capacity=2)
    for stamp in (10, 20, 30):
        pairer.add_joints(stamp, f"q{stamp}")
    assert pairer.add_features(10, "f10") == [(10, "f10", None)]
    assert pairer.add_features(20, "f20") == [(20, "f20", "q20")]
