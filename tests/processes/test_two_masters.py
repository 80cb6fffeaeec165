"""Two simulators under two masters on one machine, at once: each its own graph, both the same bytes."""
import re

from ros_graph import LIMIT_S, Graph


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
