"""URDF documents that xacro was to expand."""
import pytest

from aras_visual_servo_sim import ModelError
from gazebo_ros.world.description import read_description

ARM = ('<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">%s<link name="eye"/><joint name="j" type="fixed">'
       '<parent link="base"/><child link="eye"/></joint></robot>')


@pytest.mark.parametrize("first, told", [
    ('<xacro:macro name="m" params="n"/><link name="base"/>', "xacro:macro"), ('<box name="base"/>', "<xacro:box>")])
def test_what_was_not_expanded_is_said(first, told):
    with pytest.raises(ModelError, match=told):
        read_description(ARM % first, "", "r")


def test_an_unknown_tag_beside_all_links_is_no_error():
    assert read_description(ARM % '<link name="base"/><box name="base"/>', "", "r").children == {"j": "eye"}
