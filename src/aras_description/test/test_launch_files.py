"""The launch files and what they refer to. Reads them with roslaunch; no ROS master."""

import pytest
import roslaunch.config
import roslaunch.xmlloader
import yaml

from urdf_model import PACKAGE

NS = "/aras_visual_servo"


@pytest.fixture
def load(monkeypatch):
    """Function (file name, arguments...) -> roslaunch configuration, with this source tree as the package."""
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(PACKAGE.parent))
    monkeypatch.setenv("ROS_MASTER_URI", "http://127.0.0.1:11401")

    def loader(name, *arguments):
        path = PACKAGE / "launch" / name
        config = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader(resolve_anon=False).load(
            str(path), config, argv=[str(path), *arguments], verbose=False)
        return config

    return loader


def node_names(config):
    return sorted(node.namespace + node.name for node in config.nodes)


def test_load_puts_the_model_on_the_parameter_server(load):
    parameters = load("load.launch").params
    assert list(parameters) == [NS + "/robot_description"]
    assert parameters[NS + "/robot_description"].value == (PACKAGE / "urdf" / "aras_arm.urdf").read_text()


def test_load_obeys_its_namespace(load):
    assert list(load("load.launch", "ns:=left").params) == ["/left/robot_description"]


def test_view_starts_positions_transforms_and_rviz(load):
    assert node_names(load("view.launch")) == [
        NS + "/joint_position_publisher", NS + "/robot_state_publisher", NS + "/rviz"]


def test_view_beside_a_simulator_starts_no_second_source_of_joint_states(load):
    config = load("view.launch", "joint_states:=false", "load:=false")
    assert node_names(config) == [NS + "/robot_state_publisher", NS + "/rviz"]
    assert NS + "/robot_description" not in config.params


def test_view_remaps_every_name_of_the_rviz_file_into_its_namespace(load):
    rviz = next(node for node in load("view.launch", "ns:=left").nodes if node.name == "rviz")
    text = (PACKAGE / "rviz" / "view.rviz").read_text()
    named = {word for word in text.split() if word.startswith(NS + "/")}
    assert {source for source, _ in rviz.remap_args} == named
    assert all(target == source[len(NS) + 1:] for source, target in rviz.remap_args)


def test_rviz_file_shows_robot_frames_images_markers_and_path():
    displays = yaml.safe_load((PACKAGE / "rviz" / "view.rviz").read_text())["Visualization Manager"]["Displays"]
    topics = {display["Class"]: display for display in displays}
    assert {"rviz/RobotModel", "rviz/TF", "rviz/Image", "rviz/MarkerArray", "rviz/Path"} <= set(topics)
    assert {display["Image Topic"] for display in displays if display["Class"] == "rviz/Image"} == {
        NS + "/camera/image_raw", NS + "/camera/overlay", NS + "/null_space_bars", NS + "/goal_view",
        NS + "/error_plot"}
    assert topics["rviz/Marker"]["Marker Topic"] == NS + "/camera_frustum"
    assert topics["rviz/InteractiveMarkers"]["Update Topic"] == NS + "/buttons/update"
    assert topics["rviz/MarkerArray"]["Marker Topic"] == NS + "/scene_markers"
    assert topics["rviz/Path"]["Topic"] == NS + "/camera_path"


def test_scripts_named_by_launch_files_are_executable(load):
    for node in load("view.launch").nodes:
        if node.package == "aras_description":
            assert (PACKAGE / "scripts" / node.type).stat().st_mode & 0o111
