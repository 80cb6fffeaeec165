"""A servoing script as they were written for Gazebo: a free camera moved by set_model_state before a textured board."""
import pathlib
import sys

import yaml
from ros_graph import Graph

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
