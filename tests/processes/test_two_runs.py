"""Two runs on one master: in one namespace the second is refused, in namespaces of their own both go on."""
import os
import signal
import subprocess

import pytest
from ros_graph import Graph, LIMIT_S, until

RUN = ("rosrun", "aras_visual_servo_controller", "run")


@pytest.fixture
def graph(tmp_path):
    with Graph(tmp_path) as graph:
        graph.start("roscore", "-p", str(graph.port))
        until(lambda: "/rosout" in graph.topics(), "a master", graph.log)
        yield graph


def start(graph, tmp_path, scenario, name, *words):
    """A run that says what it says in NAME.txt and leaves its results in NAME."""
    with open(tmp_path / f"{name}.txt", "wb") as log:
        return subprocess.Popen([*RUN, str(scenario), "--output", str(tmp_path / name), *words], stdout=log, stderr=log,
                                env=dict(os.environ, ROS_MASTER_URI=graph.uri))


def recording(tmp_path, name):
    return any(path.stat().st_size > 100_000 for path in (tmp_path / name).glob("*/*/run.bag.active"))


def end(*runs):
    for run in runs:
        run.send_signal(signal.SIGTERM)
    for run in runs:
        assert run.wait(LIMIT_S) == 128 + signal.SIGTERM


def check_refused(run, tmp_path, name, who):
    assert run.wait(LIMIT_S) == 3
    said = (tmp_path / f"{name}.txt").read_text()
    assert "namespace /aras_visual_servo of the master" in said and who in said and "runs there already" in said
    assert "Traceback" not in said and not (tmp_path / name).exists()


def test_a_second_run_is_refused_by_name_and_the_first_goes_on(graph, slow_scenario, tmp_path):
    first = start(graph, tmp_path, slow_scenario, "first")
    until(lambda: recording(tmp_path, "first"), "the first run records", graph.log)
    check_refused(start(graph, tmp_path, slow_scenario, "second"), tmp_path, "second", "/aras_visual_servo/sim")
    assert first.poll() is None and recording(tmp_path, "first")
    end(first)


def test_a_run_is_refused_where_a_launch_runs(graph, slow_scenario, tmp_path):
    graph.start("roslaunch", "aras_visual_servo_controller", "servo.launch", f"scenario:={slow_scenario}",
                "experiment:=false")
    until(lambda: "/aras_visual_servo/servo_state" in graph.topics() and "/clock" in graph.topics(), "nodes", graph.log)
    check_refused(start(graph, tmp_path, slow_scenario, "second"), tmp_path, "second", "/aras_visual_servo/sim")


def test_of_two_runs_that_start_together_one_is_refused(graph, slow_scenario, tmp_path):
    runs = {name: start(graph, tmp_path, slow_scenario, name) for name in ("one", "other")}
    until(lambda: any(run.poll() is not None for run in runs.values()), "one is refused", graph.log)
    [refused] = [name for name, run in runs.items() if run.poll() is not None]
    check_refused(runs.pop(refused), tmp_path, refused, "")
    [(name, run)] = runs.items()
    until(lambda: recording(tmp_path, name), "the other records", graph.log)
    end(run)


def test_in_namespaces_of_their_own_two_run_side_by_side(graph, slow_scenario, tmp_path):
    runs = [start(graph, tmp_path, slow_scenario, name, "--namespace", name) for name in ("left", "right")]
    until(lambda: recording(tmp_path, "left") and recording(tmp_path, "right"), "both record", graph.log)
    assert all(run.poll() is None for run in runs)
    end(*runs)
