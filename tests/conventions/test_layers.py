"""Dependencies point one way, and the cores know no ROS (Debian keeps ROS headers in the system include path, so the
compiler would never notice)."""
import pathlib
import re
import xml.etree.ElementTree as ElementTree

import pytest

SOURCE = pathlib.Path(__file__).resolve().parents[2] / "src"
ROS_INCLUDE = re.compile(
    r"#include\s*[<\"](ros/|roscpp|nodelet|pluginlib|cv_bridge|image_transport|dynamic_reconfigure|tf2?[_/]|"
    r"[a-z_]+_msgs/|std_srvs/|aras_visual_servo_msgs/|xmlrpcpp/|XmlRpc)")
ROS_IMPORT = re.compile(r"^\s*(import|from)\s+(rospy|actionlib|roslib|rostopic|rosgraph|roslaunch|tf|tf2_ros|cv_bridge|"
                        r"[a-z_]+_msgs)\b", re.MULTILINE)
# The only Python modules that may know ROS: the nodes, and what reads rosbag files, which needs no master.
ROS_MODULES = ("nodes/", "bags/bag.py")
ALLOWED = {
    "aras_description": set(),
    "aras_visual_servo_msgs": set(),
    "aras_visual_servo_sim": {"aras_description", "aras_visual_servo_msgs"},
    "aras_visual_servo_camera": {"aras_description", "aras_visual_servo_msgs"},
    "aras_visual_servo_controller": {"aras_description", "aras_visual_servo_msgs", "aras_visual_servo_sim",
                                     "aras_visual_servo_camera"},
}


def core_files():
    for package in ("aras_visual_servo_sim", "aras_visual_servo_camera", "aras_visual_servo_controller"):
        for folder in ("include", "src"):
            for path in sorted((SOURCE / package / folder).rglob("*.[ch]pp")):
                if "ros" not in path.relative_to(SOURCE / package).parts:
                    yield path


def test_there_are_cores_to_look_at():
    assert len(list(core_files())) > 20


def test_no_core_file_includes_a_ros_header():
    assert [str(path) for path in core_files() if ROS_INCLUDE.search(path.read_text())] == []


def test_only_the_thin_python_modules_import_ros():
    modules = [path for path in SOURCE.glob("*/src/**/*.py")
               if not any(f"/{name}" in str(path) for name in ROS_MODULES)]
    assert len(modules) > 10
    assert [str(path) for path in modules if ROS_IMPORT.search(path.read_text())] == []


@pytest.mark.parametrize("package", sorted(ALLOWED))
def test_package_depends_only_on_what_stands_below_it(package):
    root = ElementTree.parse(SOURCE / package / "package.xml").getroot()
    ours = {element.text for element in root if "depend" in element.tag and element.text in ALLOWED}
    assert ours <= ALLOWED[package]


def test_all_packages_share_one_version():
    manifests = [*SOURCE.glob("*/package.xml"), SOURCE.parent / "tests" / "package.xml"]
    assert len({ElementTree.parse(path).getroot().findtext("version") for path in manifests}) == 1
