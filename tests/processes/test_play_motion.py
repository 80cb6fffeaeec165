"""The node play_motion: a simulated arm goes through the points of a file."""
import subprocess

import pytest
import yaml
from ros_graph import Graph

NAMESPACE = "/aras_visual_servo"
POINTS = [(0.5, [0.02, 0.1], [0.0, 0.0]), (1.5, [0.05, -0.2], [0.0, 0.0])]


@pytest.fixture(scope="module")
def graph(tmp_path_factory):
    folder = tmp_path_factory.mktemp("motion")
    with Graph(folder) as graph:
        graph.start("roscore", "-p", str(graph.port))
        graph.until(lambda: "/rosout" in graph.topics(), "a master")
        graph.start("roslaunch", "aras_visual_servo_controller", "servo.launch", "experiment:=false", "lockstep:=false",
                    "controller:=false", "real_time_factor:=1", f"results_dir:={folder}")
        graph.until(lambda: f"{NAMESPACE}/joint_states" in graph.topics(), "a simulator")
        graph.environment["ROS_NAMESPACE"] = NAMESPACE
        yield graph


def played(graph, folder, names=("gantry", "J1"), points=POINTS):
    message = {"joint_names": list(names), "points": [
        {"positions": q, "velocities": v, "time_from_start": {"secs": int(t), "nsecs": int(1e9 * (t % 1))}}
        for t, q, v in points]}
    (folder / "motion.yaml").write_text(yaml.safe_dump(message))
    return subprocess.run(["rosrun", "aras_visual_servo_controller", "play_motion", str(folder / "motion.yaml")],
                          env=graph.environment, capture_output=True, text=True, timeout=60)


def test_the_arm_ends_where_the_motion_ends(graph, tmp_path):
    done = played(graph, tmp_path)
    assert done.returncode == 0, done.stderr

    def there():
        state = graph.message(f"{NAMESPACE}/joint_states")
        q = dict(zip(state["name"], state["position"]))
        return abs(q["gantry"] - 0.05) < 1e-3 and abs(q["J1"] + 0.2) < 1e-3
    graph.until(there, "the last point")


@pytest.mark.parametrize("change, word", [({"names": ("gantry", "J9")}, "joint_names"),
                                          ({"points": POINTS[::-1]}, "time_from_start"),
                                          ({"points": [(0.5, [0.1], [0.0])]}, "points"), ({"points": []}, "points")])
def test_a_motion_that_the_arm_cannot_follow_is_named_and_nothing_moves(graph, tmp_path, change, word):
    done = played(graph, tmp_path, **change)
    assert done.returncode == 2 and word in done.stderr and "Traceback" not in done.stderr
