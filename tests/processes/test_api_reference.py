"""The API reference is made from the docstrings without a warning, and has what people look up."""
import pathlib
import subprocess

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
LOOKED_UP = {"aras_visual_servo.scenario.scenario": ("load_scenario", "Nested dict, as in the file"),
             "aras_visual_servo.laws.base": ("sampled_gains", "as exp(-gain t) does in that time"),
             "aras_visual_servo_learning.environment": ("ServoEnv", "Servo the camera to the goal of a scenario"),
             "aras_visual_servo_sim": ("step_to_image", "Advances to the next frame of a camera")}


def test_it_is_built_without_a_warning_and_has_what_people_look_up(tmp_path):
    result = subprocess.run([WORKSPACE / "script" / "docs" / "api", tmp_path / "api"], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=1500)
    assert result.returncode == 0, result.stdout.decode()
    for page, texts in LOOKED_UP.items():
        html = (tmp_path / "api" / "html" / f"{page}.html").read_text()
        assert all(text in html for text in texts), page
