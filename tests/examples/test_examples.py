"""The numbered scripts of examples/ run as they stand, and each fits on a screen."""
import pathlib
import subprocess
import sys

import aras_visual_servo
import pytest
from ros_graph import LIMIT_S, Graph

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
SCRIPTS = sorted(EXAMPLES.glob("[0-9]*.py"))
#: What a script prints when it did what it shows.
SAYS = {"01_run_and_plot": "passed", "02_own_law": "steady", "03_own_feature": "passed", "04_own_robot": "passed",
        "05_sweep_and_compare": "success", "08_own_law_in_a_benchmark": "capped"}


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_an_example_has_fewer_than_forty_lines(script):
    assert len(script.read_text(encoding="utf-8").splitlines()) < 40


@pytest.mark.parametrize("name", SAYS)
def test_an_example_runs_from_any_folder(name, tmp_path):
    done = subprocess.run([sys.executable, EXAMPLES / f"{name}.py"], cwd=tmp_path, stdout=subprocess.PIPE, text=True,
                          timeout=4 * LIMIT_S)
    assert done.returncode == 0 and SAYS[name] in done.stdout


def test_the_node_of_the_examples_servoes(tmp_path):
    """It ends at the goal. With the latency, images from before a placement come after it for 0.25 s."""
    scenario = aras_visual_servo.load_scenario("experiment_1")
    goal = scenario.kinematics().pose(scenario.goal_posture(scenario.kinematics()))
    with Graph(tmp_path) as graph:
        graph.start("roslaunch", "-p", str(graph.port), "aras_visual_servo_controller", "servo.launch",
                    "experiment:=false", "lockstep:=false", "real_time_factor:=2",
                    "set:=sim.cameras.camera.latency_s=0.25 servo.input_timeout_s=1")
        graph.until(lambda: "/aras_visual_servo/camera/features" in graph.topics(), "the camera's features")
        node = EXAMPLES / "07_ros_node.py"
        assert "CONVERGED" in graph.output(sys.executable, str(node), "__ns:=aras_visual_servo")
        place = graph.message("/aras_visual_servo/ground_truth/camera_pose")["pose"]["position"]
        assert [place[axis] for axis in "xyz"] == pytest.approx(goal[:3, 3], abs=0.005)
