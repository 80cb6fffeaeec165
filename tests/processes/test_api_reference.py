"""The API reference is made from the docstrings without a warning, and has what people look up."""
import pathlib
import subprocess

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
LOOKED_UP = {"public": ("load_scenario", "register_law", "ServoLoop"),
             "aras_visual_servo_learning.environment": ("ServoEnv",),
             "aras_visual_servo.laws.base": ("sampled_gains",), "aras_visual_servo_sim": ("step_to_image",)}


def test_it_is_built_without_a_warning_and_has_what_people_look_up(tmp_path):
    result = subprocess.run([WORKSPACE / "script" / "docs" / "api", tmp_path / "api"], stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=1500)
    assert result.returncode == 0, result.stdout.decode()
    for page, names in LOOKED_UP.items():
        html = (tmp_path / "api" / "html" / f"{page}.html").read_text()
        assert all(f'<span class="pre">{name}</span>' in html for name in names), page
