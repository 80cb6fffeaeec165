"""Every line of docs/ros.md, typed in its order into a graph that runs."""
import pathlib
import re
import subprocess

import pytest
from ros_graph import Graph, LIMIT_S, until

PAGE = (pathlib.Path(__file__).resolve().parents[2] / "docs" / "ros.md").read_text()
LINES = [line[2:] for block in re.findall(r"```console\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lines")
    with Graph(folder) as graph:
        graph.folder = folder
        graph.start("roscore", "-p", str(graph.port))
        until(lambda: "/rosout" in graph.topics(), "a master", graph.log)
        [launch] = re.findall(r"```\n(roslaunch .*)\n```", PAGE)
        graph.start("bash", "-c", f"cd {folder} && exec {launch}")
        until(lambda: "/aras_visual_servo/servo_state" in graph.topics() and "/clock" in graph.topics(), "nodes",
              graph.log)
        yield graph


def test_the_page_has_lines_of_every_kind():
    assert len(LINES) > 25
    for kind in ("rostopic pub", "rostopic echo", "rosservice call", "rosparam set"):
        assert any(kind in line for line in LINES)


@pytest.mark.parametrize("line", LINES)
def test_a_line_works(graph, line):
    result = subprocess.run(["bash", "-c", line], env=graph.environment, cwd=graph.folder, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=2 * LIMIT_S)
    said = result.stdout.decode()
    assert result.returncode == 0 and "ERROR" not in said, said
    assert "success: False" not in said, said
    assert "success: True" in said or "reconfigure" not in line, said
    assert said.strip() or not line.startswith("rostopic echo"), "it prints nothing"
