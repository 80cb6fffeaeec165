"""Dependencies point one way, between packages and between the rooms of one, and the cores know no ROS (Debian keeps
ROS headers in the system include path, so the compiler would never notice)."""
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
ROS_MODULES = ("nodes/", "bags/bag.py", "live/over_ros.py", "ros2/relay.py", "ros2/tcpros.py")
ALLOWED = {
    "aras_description": set(),
    "aras_visual_servo_msgs": set(),
    "aras_visual_servo_common": set(),
    "aras_visual_servo_sim": {"aras_description", "aras_visual_servo_common", "aras_visual_servo_msgs"},
    # The camera takes from the description how programs of its tests are installed, and nothing else.
    "aras_visual_servo_camera": {"aras_description", "aras_visual_servo_common", "aras_visual_servo_msgs"},
    "aras_visual_servo": {"aras_description", "aras_visual_servo_common", "aras_visual_servo_sim",
                          "aras_visual_servo_camera"},
    "aras_visual_servo_controller": {"aras_description", "aras_visual_servo", "aras_visual_servo_msgs",
                                     "aras_visual_servo_sim", "aras_visual_servo_camera"},
    "aras_visual_servo_study": {"aras_description", "aras_visual_servo", "aras_visual_servo_controller",
                                "aras_visual_servo_msgs", "aras_visual_servo_sim"},
    "aras_visual_servo_learning": {"aras_description", "aras_visual_servo", "aras_visual_servo_controller",
                                   "aras_visual_servo_study"},
}
# The rooms of a C++ core, which are its folders, from the ground up. A room includes itself and rooms of lower floors.
CPP_FLOORS = {
    "aras_visual_servo_camera": [{"config"}, {"image"}, {"matching", "moments", "photometric", "tags"},
                                 {"points", "segmentation"}, {"extraction"}],
    "aras_visual_servo_sim": [{"config"}, {"image", "robot"}, {"scene", "camera", "physics"}, {"render"},
                              {"simulation"}],
}
#: Libraries of the simulator that one room alone includes.
LIBRARIES = {"Bullet": "physics", "LinearMath": "physics", "assimp": "scene", "stb": "image",
             "urdf": "robot", "tinyxml2": "robot"}


def core_files():
    for package in ("aras_visual_servo_common", "aras_visual_servo_sim", "aras_visual_servo_camera",
                    "aras_visual_servo"):
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
    ours = {element.text for element in root
            if element.tag in ("build_depend", "exec_depend") and element.text in ALLOWED}
    assert ours <= ALLOWED[package]


def test_all_packages_share_one_version():
    manifests = [*SOURCE.glob("*/package.xml"), SOURCE.parent / "tests" / "package.xml"]
    assert len({ElementTree.parse(path).getroot().findtext("version") for path in manifests}) == 1


def test_python_packages_are_set_up_by_setuptools():
    """Of setuptools catkin asks for an egg-info in the build folder; distutils leaves it in src/."""
    scripts = list(SOURCE.glob("*/setup.py"))
    assert scripts
    imported = re.compile(r"^from setuptools import .*\bsetup$", re.MULTILINE)
    assert [str(path) for path in scripts if not imported.search(path.read_text())] == []


def arrows_up(floors, arrows):
    """Imports that do not lead down.

    Args:
        floors: sets of rooms, the ground first.
        arrows: (file, room it is in, room it imports) of every import; rooms that are on no floor count as above all.
    """
    floor = {room: k for k, rooms in enumerate(floors) for room in rooms}
    return [f"{file}: {room} imports {other}" for file, room, other in arrows
            if other != room and floor.get(other, len(floors)) >= floor.get(room, -1)]


def cpp_arrows(package):
    """(file, room, room included) of every include of one of the package's own headers in its core."""
    include = re.compile(rf'#include "(?:{package}/)?(\w+)/\w')
    for folder in (SOURCE / package / "include" / package, SOURCE / package / "src" / "core"):
        for path in sorted(folder.rglob("*.[ch]pp")):
            file = path.relative_to(folder)
            for other in include.findall(path.read_text()):
                yield str(file), file.parts[0], other


def test_an_import_of_the_same_floor_or_above_is_found():
    floors = [{"ground"}, {"left", "right"}]
    down = [("a", "left", "ground"), ("b", "left", "left")]
    up = [("c", "ground", "left"), ("d", "left", "right"), ("e", "left", "attic"), ("f", "attic", "ground")]
    assert arrows_up(floors, down) == []
    assert len(arrows_up(floors, up)) == len(up)


@pytest.mark.parametrize("package", sorted(CPP_FLOORS))
def test_rooms_of_a_cpp_core_include_only_what_lies_below(package):
    arrows = list(cpp_arrows(package))
    assert len(arrows) > 20
    assert {room for _, room, _ in arrows} == set().union(*CPP_FLOORS[package])
    assert arrows_up(CPP_FLOORS[package], arrows) == []


def test_a_library_is_included_by_one_room_alone():
    core, found = SOURCE / "aras_visual_servo_sim" / "src" / "core", set()
    for path in core.rglob("*.[ch]pp"):
        for name in re.findall(r"^#include <([^>]+)>", path.read_text(), re.MULTILINE):
            for library, room in LIBRARIES.items():
                if name.startswith(library):
                    found.add(library)
                    assert path.relative_to(core).parts[0] == room, f"{path}: {name}"
    assert found == set(LIBRARIES)
