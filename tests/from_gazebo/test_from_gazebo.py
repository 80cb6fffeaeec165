"""A robot package written for Gazebo Classic and ros_control, against sim.launch alone (docs/from_gazebo.md)."""
import pathlib
import signal
import sys
import time

import pytest
from ros_graph import Graph

ROBOT = pathlib.Path(__file__).resolve().parent / "robot"


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    """sim.launch with the robot's own files, under a master of its own."""
    with Graph(tmp_path_factory.mktemp("ros")) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "aras_visual_servo_sim", "sim.launch",
                    f"model:={ROBOT / 'pan_tilt.urdf'}", f"controllers:={ROBOT / 'controllers.yaml'}", "ns:=pan_tilt",
                    "gazebo_names:=true")
        graph.until(lambda: "/pan_tilt/head_camera/image_raw" in graph.topics(), "the simulator is up")
        yield graph


def test_its_topics_have_gazebos_names_and_types(graph):
    expected = {"/clock": "rosgraph_msgs/Clock", "/pan_tilt/joint_states": "sensor_msgs/JointState",
                "/pan_tilt/head_camera/image_raw": "sensor_msgs/Image",
                "/pan_tilt/head_camera/camera_info": "sensor_msgs/CameraInfo"}
    graph.until(lambda: expected.items() <= graph.topics().items(), "the topics")


def test_its_own_node_turns_the_head_and_sees(graph):
    node = graph.start(sys.executable, str(ROBOT / "look_around.py"), "_pan:=0.6", "_tilt:=-0.3")
    assert graph.message("/look_around/brightness")["data"] == 230.0  # it looks up: nothing but background in view
    node.send_signal(signal.SIGINT)


def test_joint_states_come_as_its_joint_state_controller_says(graph):
    said = graph.output("rostopic", "echo", "-p", "-n", "130", "/pan_tilt/joint_states")
    rows = [line.split(",") for line in said.splitlines() if line and line[0].isdigit()]
    assert len(rows) == 130
    stamps_ms = sorted({int(row[2]) // 10**6 for row in rows})
    # Fifty a second, and one with each of the twenty images a second.
    assert all(ms % 20 == 0 or ms % 50 == 0 for ms in stamps_ms), stamps_ms
    within = [ms for ms in stamps_ms if stamps_ms[0] <= ms < stamps_ms[0] + 1000]
    assert len(within) == 60, within
    assert "head_screw_joint" in rows[0], rows[0]


def test_its_parameters_are_where_gazebo_has_them(graph):
    assert graph.output("rosparam", "get", "/pan_tilt/tilt_position_controller/pid/i_clamp").strip() == "5.0"
    assert "/pan_tilt/pan_tilt" not in graph.output("rosparam", "list")


def test_gazebos_services_answer_with_its_meaning(graph):
    graph.answer("/gazebo/pause_physics")
    before = graph.message("/clock")
    time.sleep(0.2)
    assert graph.message("/clock") == before, "time stands still"
    graph.answer("/gazebo/reset_world")
    assert graph.message("/clock") == before, "reset_world keeps the time"
    graph.answer("/gazebo/reset_simulation")
    time.sleep(0.2)
    assert graph.message("/clock") == {"clock": {"secs": 0, "nsecs": 0}}, "and it still stands"
    graph.answer("/gazebo/unpause_physics")


def test_what_it_ignores_is_said(graph):
    text = graph.log()
    for tag in ("plugin", "mu1"):
        assert tag in text, text


def test_a_controller_of_a_joint_it_has_not_is_refused_by_name(tmp_path):
    faulty = tmp_path / "controllers.yaml"
    faulty.write_text((ROBOT / "controllers.yaml").read_text().replace("pan_joint", "nose_joint"))
    with Graph(tmp_path) as graph:
        launch = graph.start("roslaunch", "-p", str(graph.port), "aras_visual_servo_sim", "sim.launch",
                             f"model:={ROBOT / 'pan_tilt.urdf'}", f"controllers:={faulty}", "ns:=pan_tilt", "tf:=false")
        assert launch.wait(60) is not None
        assert "nose_joint" in graph.log()
