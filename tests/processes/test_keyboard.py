"""The node teleop, at a terminal: keys move the arm while they are held, and nothing else is sent."""
import os
import pty
import subprocess
import time

import pytest
from ros_graph import LIMIT_S, Graph, until

NAMESPACE = "/aras_visual_servo"
JOINT = "J1"  # the first by name, which key 1 chooses
TURN_RAD = 0.05  # by which it has moved at the least


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    folder = tmp_path_factory.mktemp("keyboard")
    with Graph(folder) as graph:
        graph.start("roscore", "-p", str(graph.port))
        graph.until(lambda: "/rosout" in graph.topics(), "a master")
        graph.start("roslaunch", "aras_visual_servo_controller", "servo.launch", "experiment:=false", "lockstep:=false",
                    "real_time_factor:=1", f"results_dir:={folder}")
        graph.until(lambda: f"{NAMESPACE}/servo_state" in graph.topics(), "a controller")
        graph.environment["ROS_NAMESPACE"] = NAMESPACE
        yield graph


@pytest.fixture
def terminal(graph):
    """(process, function that types a key)."""
    ours, its = pty.openpty()
    process = subprocess.Popen(["rosrun", "aras_visual_servo_controller", "teleop"], env=graph.environment, stdin=its,
                               stdout=subprocess.PIPE, text=True)
    os.close(its)
    assert "Tab: joints or camera" in process.stdout.readline()
    graph.until(lambda: f"{NAMESPACE}/teleop" in publishers(graph, f"{NAMESPACE}/joint_command"), "the node")
    yield process, lambda key: os.write(ours, key.encode())
    process.kill()
    process.wait()
    os.close(ours)


def publishers(graph, topic):
    said = graph.output("rostopic", "info", topic)
    return said[said.index("Publishers:"):said.index("Subscribers:")]


def angle_rad(graph):
    """Position of the joint."""
    said = graph.message(f"{NAMESPACE}/joint_states")
    return said["position"][said["name"].index(JOINT)]


def hold(type_key, key, seconds):
    """As a terminal that repeats a key at 25 Hz."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        type_key(key)
        time.sleep(0.04)


def test_a_held_key_moves_the_arm_until_it_is_let_go(graph, terminal):
    process, type_key = terminal
    before = angle_rad(graph)
    type_key("1")
    end = time.monotonic() + LIMIT_S
    while angle_rad(graph) < before + TURN_RAD:
        assert time.monotonic() < end, "the key does not move it"
        hold(type_key, "d", 0.5)
    until(lambda: angle_rad(graph) == pytest.approx(angle_rad(graph), abs=1e-5), "it stands again")
    moved = angle_rad(graph)
    while angle_rad(graph) > moved - TURN_RAD:
        assert time.monotonic() < end, "the other key does not move it back"
        hold(type_key, "a", 0.5)
    type_key("x")
    assert process.wait(LIMIT_S) == 0


def test_without_a_terminal_it_says_so(graph):
    done = subprocess.run(["rosrun", "aras_visual_servo_controller", "teleop"], env=graph.environment,
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=LIMIT_S)
    assert done.returncode == 2 and "terminal" in done.stdout


def test_bad_parameters_are_refused_by_name(graph):
    done = subprocess.run(["rosrun", "aras_visual_servo_controller", "teleop", "_joint_speed:=-1.0"],
                          env=graph.environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S)
    assert done.returncode == 2 and "joint_speed: found -1.0, allowed > 0" in done.stdout
