"""Packages that files written for Gazebo look up by name."""
import pathlib

import roslib.packages
import rospkg
import yaml

ASKED_FOR = ("joint_state_controller effort_controllers position_controllers velocity_controllers gazebo_plugins "
             "joint_trajectory_controller gripper_action_controller joint_state_publisher_gui rqt_gui "
             "rqt_joint_trajectory_controller").split()


def test_the_packages_are_found_with_what_they_are_asked_for():
    packages = rospkg.RosPack()
    folders = {name: pathlib.Path(packages.get_path(name)) for name in ASKED_FOR}
    for name, folder in folders.items():
        config = (folder / "cmake" / (name + "Config.cmake")).read_text(encoding="utf-8")
        assert "set(%s_FOUND_CATKIN_PROJECT TRUE)" % name in config, "find_package finds it"
    loaded = yaml.safe_load((folders["joint_state_controller"] / "joint_state_controller.yaml").read_text("utf-8"))
    assert loaded["joint_state_controller"]["type"] == "joint_state_controller/JointStateController"


def test_programs_of_these_packages_are_found():
    for package, program in (("joint_state_publisher_gui", "joint_state_publisher_gui"),
                             ("robot_state_publisher", "state_publisher"),
                             ("robot_state_publisher", "robot_state_publisher")):
        assert roslib.packages.find_node(package, program), program
