"""The ROS 2 environment: what is missing or mixed up is named."""
import os

import numpy as np
import pytest

from aras_visual_servo import ArasError, ParameterError, load_scenario
from aras_visual_servo_controller.ros2.environment import check_shell, find_environment, shell_faults, variables
from aras_visual_servo_controller.ros2.twist import KEPT, TwistToJoints


def test_two_ros_in_one_shell_are_named(tmp_path):
    (tmp_path / "two" / "rclpy").mkdir(parents=True)
    (tmp_path / "two" / "rclpy" / "__init__.py").touch()
    (tmp_path / "one").mkdir()
    bad = {"AMENT_PREFIX_PATH": "/opt/ros/kilted", "ROS_VERSION": "2",
           "PYTHONPATH": os.pathsep.join([str(tmp_path / "one"), str(tmp_path / "two")])}
    with pytest.raises(ParameterError) as caught:
        check_shell(bad)
    for what in ("AMENT_PREFIX_PATH", "ROS_VERSION: found '2'", f"PYTHONPATH: found '{tmp_path}/two'"):
        assert what in str(caught.value)
    assert shell_faults({"ROS_VERSION": "1", "PYTHONPATH": str(tmp_path / "one")}) == []


def test_an_environment_that_is_missing_half_made_or_old_is_named(tmp_path):
    with pytest.raises(ArasError, match="no build/ros2"):
        find_environment(tmp_path / "x")
    folder = tmp_path / "build" / "ros2"
    folder.mkdir(parents=True)
    for name, text in (("installed.txt", "ros-rclpy==1\n"), ("types.txt", "")):
        with pytest.raises(ArasError, match="not whole"):
            find_environment(tmp_path / "x")
        (folder / name).write_text(text)
    assert find_environment(tmp_path / "x") == folder
    (tmp_path / "ros2").mkdir()
    (tmp_path / "ros2" / "requirements.txt").write_text("ros-rclpy==2\n")
    with pytest.raises(ArasError, match="another version"):
        find_environment(tmp_path / "x")


def test_programs_of_ros2_do_not_see_ros1_and_open_no_network():
    found = variables({"PYTHONPATH": "/one", "LD_LIBRARY_PATH": "/one", "ROS_DISTRO": "noetic", "HOME": "/me",
                       "ROS_DOMAIN_ID": "5"})
    assert not {"PYTHONPATH", "LD_LIBRARY_PATH", "ROS_DISTRO"} & set(found)
    assert (found["HOME"], found["ROS_DOMAIN_ID"]) == ("/me", "5")
    assert found["FASTDDS_BUILTIN_TRANSPORTS"].startswith("SHM")


def test_a_twist_becomes_joint_velocities_that_move_the_camera_so():
    kinematics = load_scenario("experiment_1").kinematics()
    convert, q = TwistToJoints(kinematics), np.full(len(kinematics.joint_names), 0.1)
    for stamp_ns in range(KEPT + 5):
        convert.add(stamp_ns, q)
    twist = np.array([0.01, -0.02, 0.03, 0.0, 0.0, 0.05])
    velocities = convert.velocities(KEPT, twist)
    moved = kinematics.jacobian(q) @ [velocities[name] for name in kinematics.joint_names]
    np.testing.assert_allclose(moved[[0, 1, 2, 5]], twist[[0, 1, 2, 5]], atol=1e-3)  # damped inverse
    fast = convert.velocities(KEPT, 1e3 * twist)
    share = np.abs([fast[name] for name in kinematics.joint_names]) / kinematics.velocity
    assert share.max() == pytest.approx(1.0)
    assert convert.velocities(0, twist) is None and convert.velocities(KEPT, np.full(6, np.nan)) is None
    convert.add(3, q)  # time was set back
    assert convert.velocities(3, twist) is not None
