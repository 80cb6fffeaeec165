"""A robot package for Gazebo Classic and ros_control, against sim.launch alone (docs/from_gazebo_reference.md)."""

import pathlib
import signal
import sys
import time

import genmsg.gentools
import genmsg.msg_loader
import pytest
import yaml
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


HERE = pathlib.Path(__file__).resolve().parent


def servoed(folder):
    with Graph(folder) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "demo_servo", "servo.launch")

        def models():
            try:
                return graph.answer("/gazebo/get_world_properties")["model_names"]
            except AssertionError:
                return []
        graph.until(lambda: {"flying_camera", "board"} <= set(models()), "camera and board are there")
        return yaml.safe_load(graph.output(sys.executable, str(HERE / "demo_servo" / "scripts" / "servo.py")))


def test_a_free_camera_goes_home_by_its_images_and_a_second_run_is_the_same(tmp_path_factory):
    first, second = (servoed(tmp_path_factory.mktemp("ros")) for _ in range(2))
    assert first["off_mm"] < 5.0
    assert first == second


ROOT = pathlib.Path(__file__).resolve().parents[2] / "gazebo"
PUBLISHED = yaml.safe_load((pathlib.Path(__file__).parent / "md5_sums.yaml").read_text())
PACKAGES = ("gazebo_msgs", "control_msgs", "controller_manager_msgs")
SHARE = pathlib.Path("/usr/share")
#: What actionlib makes of the parts of an action, by suffix.
WRAPPED = {
    "Action": "{0}ActionGoal action_goal\n{0}ActionResult action_result\n{0}ActionFeedback action_feedback\n",
    "ActionGoal": "Header header\nactionlib_msgs/GoalID goal_id\n{0}Goal goal\n",
    "ActionResult": "Header header\nactionlib_msgs/GoalStatus status\n{0}Result result\n",
    "ActionFeedback": "Header header\nactionlib_msgs/GoalStatus status\n{0}Feedback feedback\n"}


def definitions():
    """(name, text, whether it is a service) of every message of the three packages, parts of actions included."""
    for package in PACKAGES:
        for path in sorted((ROOT / package).glob("msg/*.msg")):
            yield f"{package}/{path.stem}", path.read_text(), False
        for path in sorted((ROOT / package).glob("srv/*.srv")):
            yield f"{package}/{path.stem}", path.read_text(), True
        for path in sorted((ROOT / package).glob("action/*.action")):
            parts = dict(zip(("Goal", "Result", "Feedback"), path.read_text().split("---\n")))
            parts.update((suffix, text.format(path.stem)) for suffix, text in WRAPPED.items())
            for suffix, text in parts.items():
                yield f"{package}/{path.stem}{suffix}", text, False


@pytest.fixture(scope="module")
def sums(tmp_path_factory):
    """MD5 sum of each message of gazebo/, by name."""
    folder = tmp_path_factory.mktemp("messages")
    search = {path.name: [str(path / "msg")] for path in SHARE.glob("*_msgs")}
    search.update({package: [str(folder / package)] for package in PACKAGES})
    found = list(definitions())
    for name, text, is_service in found:
        path = folder / f"{name}.{'srv' if is_service else 'msg'}"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    made = {}
    for name, text, is_service in found:
        context = genmsg.msg_loader.MsgContext.create_default()
        if is_service:
            spec = genmsg.msg_loader.load_srv_from_string(context, text, name)
            parts = (spec.request, spec.response)
        else:
            spec = genmsg.msg_loader.load_msg_from_string(context, text, name)
            parts = (spec,)
        for part in parts:
            genmsg.msg_loader.load_depends(context, part, search)
        made[name] = genmsg.gentools.compute_md5(context, spec)
    return made


def test_every_sum_is_the_published_one(sums):
    assert sums == PUBLISHED


def test_a_field_of_another_type_changes_the_sum(sums):
    """The check sees what it is for."""
    text = (ROOT / "control_msgs" / "msg" / "GripperCommand.msg").read_text()
    context = genmsg.msg_loader.MsgContext.create_default()
    changed = genmsg.msg_loader.load_msg_from_string(context, text.replace("float64 max_effort", "float32 max_effort"),
                                                     "control_msgs/GripperCommand")
    assert genmsg.gentools.compute_md5(context, changed) != sums["control_msgs/GripperCommand"]
