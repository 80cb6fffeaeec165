"""ROS 2 nodes in the loop: a controller, goals, and the node of docs/ros2.md, each a program beside the relay."""
import json
import pathlib
import re
import subprocess
import sys

import psutil
import pytest
from ros_graph import Graph

ROOT = pathlib.Path(__file__).resolve().parents[2]
NODES = pathlib.Path(__file__).resolve().parent / "ros2_nodes"
SERVO = [sys.executable, str(ROOT / "src" / "aras_visual_servo" / "scripts" / "aras-servo"), "ros2", "run"]
NAMESPACE, LIMIT_S = "/aras_visual_servo", 120.0
SUCCEEDED, CANCELED = 4, 5  # action_msgs/GoalStatus


@pytest.fixture(scope="module", params=["false"])
def graph(tmp_path_factory, request):
    """servo.launch in lockstep with the relay, paused; without a controller, unless a test asks for it."""
    with Graph(tmp_path_factory.mktemp("ros2")) as graph:
        graph.environment["ROS_DOMAIN_ID"] = str(graph.port % 100)
        graph.start("roslaunch", "aras_visual_servo_controller", "servo.launch", "experiment:=false", "ros2:=true",
                    f"controller:={request.param}", "start_paused:=true", "lockstep:=true", "real_time_factor:=0",
                    "guard:=false")
        yield graph


def printed(graph, *program):
    """What a ROS 2 program prints."""
    done = subprocess.run([*SERVO, *map(str, program)], env=graph.environment, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=LIMIT_S)
    assert done.returncode == 0, done.stderr + graph.log()
    return done.stdout


def test_a_controller_in_rclpy_gives_the_run_hash_of_this_process(graph, run):
    told = json.loads(printed(graph, NODES / "controller.py", "experiment_1").splitlines()[-1])
    assert told["hash"] == run("experiment_1").run_hash
    # The last image is of the moment at which the simulator pauses itself.
    assert told["status"] == "CONVERGED" and 0 <= told["frames"] - told["answered"] <= 1 and told["dropped"] == 0


def test_the_relay_listens_on_the_loopback_only_and_its_ros2_side_nowhere(graph):
    ours = [process for process in psutil.process_iter(["cmdline"])
            if environment(process).get("ROS_MASTER_URI") == graph.uri]
    relay, door = ([process for process in ours if any(word.endswith(program) for word in process.info["cmdline"])]
                   for program in ("/ros2_relay", "/door.py"))
    assert len(relay) == len(door) == 1
    # The connections of ROS 1's topics are handed over: nobody can open another.
    assert {one.status for one in door[0].connections("inet")} <= {psutil.CONN_ESTABLISHED, psutil.CONN_CLOSE_WAIT}
    addresses = {one.laddr.ip for process in (*relay, *door) for one in process.connections("inet")}
    assert addresses and addresses <= {"127.0.0.1", "::1"}


def environment(process):
    try:
        return process.environ()
    except psutil.Error:
        return {}


def test_the_node_of_the_page_servoes_back_to_the_view_that_it_taught(graph, tmp_path):
    program = re.search("```python\n(.*?)```", (ROOT / "docs" / "ros2.md").read_text(), re.DOTALL)[1]
    (tmp_path / "my_servo.py").write_text(program)
    graph.answer(f"{NAMESPACE}/sim/reset")
    graph.answer(f"{NAMESPACE}/sim/unpause")
    said = printed(graph, tmp_path / "my_servo.py")
    assert float(said.split()[-1]) <= 1e-3
    # It waits for the answer to the image after the last one that the node answered.
    status = graph.message(f"{NAMESPACE}/sim/status")
    assert status["lockstep_armed"] and status["holding"] and status["dropped_frames"] == 0


@pytest.mark.parametrize("graph", ["true"], indirect=True)
def test_goals_are_taken_and_every_kind_of_topic_comes(graph):
    told = json.loads(printed(graph, NODES / "goals.py").splitlines()[-1])
    assert (told["cancelled"], told["status"], told["converged"]) == (CANCELED, SUCCEEDED, True), told["reason"]
    assert told["features"] == ["xn", "yn", "an", "alpha"]
    assert len(told["phases"]) > 1  # not all: of a run at full speed ROS 2 drops feedback that is not taken in time
    assert all(told["came"].values()), told["came"]
    assert told["image"] == [320, 240, "rgb8", 320 * 240 * 3]
    assert told["joints"] == sorted(told["joints"]) and told["k"][8] == 1.0
