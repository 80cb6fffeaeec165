"""Groups of topics that a run records."""

import pytest

from aras_visual_servo_controller.ground.errors import ParameterError
from aras_visual_servo_controller.bags.record_groups import GROUPS, group_of, lacking, parse_groups


ALL = tuple(GROUPS)


@pytest.mark.parametrize("value, groups", [
    ("all", ALL), ("", ALL), ("truth, images", ("servo", "images", "truth")), (["tf"], ("servo", "tf")),
    ("-images,-other", tuple(name for name in ALL if name not in ("images", "other")))])
def test_groups_are_chosen_by_name_or_left_out(value, groups):
    assert parse_groups(value) == groups


@pytest.mark.parametrize("value, words", [("imges,trut", "'imges'.*\n.*'trut'"),
                                          ("-images,truth", "do not go together"),
                                          ("-servo", "cannot be left out"), ("-all", "'-all'")])
def test_wrong_groups_are_refused_with_the_allowed_ones(value, words):
    with pytest.raises(ParameterError, match=words):
        parse_groups(value)


@pytest.mark.parametrize("topic, group", [
    ("/a/b/servo_state", "servo"), ("/a/b/servo/result", "servo"), ("/a/b/camera/image_raw", "images"),
    ("/a/b/camera/features", "features"), ("/a/b/ground_truth/camera_pose", "truth"), ("/tf", "tf"),
    ("/a/b/tf_static", "tf"),
    ("/clock", "clock"), ("/a/b/clock", "clock"), ("/a/b/sim/status", "status"),
    ("/a/b/J1_controller/command", "other"),
    ("/a/b/tfx", "other"), ("/a/b/scene_markers", "other")])
def test_every_topic_has_its_group(topic, group):
    assert group_of(topic, "/a/b/") == group


def test_what_a_report_lacks_is_said_with_the_group_that_has_it():
    assert lacking({topic for topic, _ in [("ground_truth/camera_pose", 0), ("camera/image_raw", 0),
                                           ("camera/features", 0), ("camera/camera_info", 0), ("sim/status", 0)]}) == []
    [sentence] = lacking({"camera/image_raw", "camera/features", "camera/camera_info", "sim/status"})
    assert "ground_truth/camera_pose (group truth)" in sentence
