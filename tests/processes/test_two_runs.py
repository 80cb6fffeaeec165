"""Two runs beside each other: masters, ports, sockets."""

import os
import re
import signal
import subprocess

import psutil
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


def test_two_masters_at_once_give_the_hash_of_the_run_in_process(run, tmp_path):
    folders = [tmp_path / side for side in ("left", "right")]
    for folder in folders:
        folder.mkdir()
    with Graph(folders[0]) as left, Graph(folders[1]) as right:
        for graph in (left, right):
            graph.start("roscore", "-p", str(graph.port))
            graph.until(graph.topics, "a master")
        runs = [graph.start("rosrun", "aras_visual_servo_controller", "run", "experiment_1", "--output", str(folder))
                for graph, folder in ((left, folders[0]), (right, folders[1]))]
        for graph in (left, right):
            graph.until(lambda graph=graph: "/clock" in graph.topics(), "both run at the same time")
        codes = [process.wait(4 * LIMIT_S) for process in runs]
        assert codes == [0, 0], left.log() + right.log()
        hashes = [re.search(r"run hash +([0-9a-f]{16})", graph.log()).group(1) for graph in (left, right)]
    assert hashes == [run("experiment_1").run_hash] * 2


#: roscpp binds its XML-RPC server to every interface whatever ROS_HOSTNAME says: one port of each of these.
ROSCPP = {"rosout", "sim_node"}
ALL = ROSCPP | {"roslaunch", "rosmaster", "controller", "experiment"}


def listening(process):
    """process name -> addresses at which sockets of processes of that name wait for others, TCP and UDP."""
    found = {}
    for one in process.children(recursive=True):
        try:
            addresses = [link.laddr.ip for link in one.connections("inet")
                         if link.status == psutil.CONN_LISTEN or (link.status == psutil.CONN_NONE and not link.raddr)]
            found[one.name()] = sorted([*found.get(one.name(), []), *addresses])
        except psutil.NoSuchProcess:
            pass
    return found


def test_a_run_listens_on_the_loopback_only_as_far_as_ros_allows(slow_scenario, own_master, tmp_path):
    run = subprocess.Popen(["rosrun", "aras_visual_servo_controller", "run", str(slow_scenario), "--output",
                            str(tmp_path)], env=own_master)
    seen = {}

    def all_seen():
        assert run.poll() is None, "it ended before everything was seen"
        for name, addresses in listening(psutil.Process(run.pid)).items():
            seen[name] = max(seen.get(name, []), addresses, key=len)
        return ALL <= set(seen) and all(seen[name] for name in ALL)

    try:
        until(all_seen, "every process listens")
    finally:
        run.terminate()
        run.wait(LIMIT_S)
    for name, addresses in seen.items():
        open_to_all = [address for address in addresses if not address.startswith("127.")]
        assert len(open_to_all) == (1 if name in ROSCPP else 0), (name, addresses)
