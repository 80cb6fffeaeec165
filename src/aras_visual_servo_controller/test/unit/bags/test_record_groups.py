"""Groups of topics that a run records."""

import pytest

from aras_visual_servo import ParameterError
from aras_visual_servo_controller.bags.record_groups import group_of, GROUPS, is_chosen, lacking, parse_groups


ALL = tuple(GROUPS)


@pytest.mark.parametrize("value, groups", [
    ("all", ALL), ("", ALL), ("truth, images", ("servo", "images", "truth")), (["tf"], ("servo", "tf")),
    ("-images,-other", tuple(name for name in ALL if name not in ("images", "other"))),
    ("all, depth", (*ALL, "depth")), ("overlay", ("servo", "overlay"))])
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


@pytest.mark.parametrize("topic, group", [
    ("camera/converted_image", "converted"), ("camera/overlay", "overlay"), ("left/depth/image_raw", "depth"),
    ("left/segmentation/image_raw", "segmentation")])
def test_what_is_made_for_a_listener_is_recorded_only_when_named(topic, group):
    assert not is_chosen("/a/b/" + topic, "/a/b/", parse_groups("all"))
    assert is_chosen("/a/b/" + topic, "/a/b/", parse_groups(f"all,{group}"))


def test_what_can_be_made_from_the_rest_is_never_recorded():
    groups = parse_groups("all")
    names = ("camera_path", "null_space_bars", "J1_controller/state", "camera/image_raw/compressed",
             "image_joint_states", "camera/image_raw", "scene_markers")
    chosen = [name for name in names if is_chosen("/a/" + name, "/a/", groups)]
    assert chosen == ["camera/image_raw", "scene_markers"]


def test_what_a_report_lacks_is_said_with_the_group_that_has_it():
    assert lacking({topic for topic, _ in [("ground_truth/camera_pose", 0), ("camera/image_raw", 0),
                                           ("camera/features", 0), ("camera/camera_info", 0), ("sim/status", 0)]}) == []
    [sentence] = lacking({"camera/image_raw", "camera/features", "camera/camera_info", "sim/status"})
    assert "ground_truth/camera_pose (group truth)" in sentence
