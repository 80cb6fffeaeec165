"""Cameras drawn by OpenGL, as a process of its own sees them: the library, its version, its files, its memory."""
import hashlib
import json
import os
import pathlib
import subprocess
import sys

import pytest

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "ros" / "robot"
#: Makes a simulation with a flat target, a solid, and a camera for each entry of the dictionary `cameras`.
BEGIN = """
import hashlib, json, sys, yaml
from aras_visual_servo_sim import RenderError, Simulation, opengl_description
FOLDER = sys.argv[1]
def make(**cameras):
    config = yaml.safe_load(open(FOLDER + "/sim.yaml"))["sim"]
    camera = config["cameras"][0]
    config["cameras"] = [dict(camera, name=name, encoding="rgb8", **keys) for name, keys in cameras.items()]
    config["scene"]["solids"] = [dict(name="ball", sphere_m=0.03, position_m=[0.05, 0.02, 0.1])]
    return Simulation(open(FOLDER + "/pan_lift.urdf").read(), config)
def digest(image):
    return hashlib.sha256(image.tobytes()).hexdigest()
def opened():
    return [name for name in ("libOSMesa", "libEGL", "libLLVM") if name in open("/proc/self/maps").read()]
"""


def run(program, **environment):
    """What a process prints, as JSON."""
    done = subprocess.run([sys.executable, "-c", BEGIN + program, str(FOLDER)], capture_output=True, text=True,
                          check=False, env={**os.environ, **environment})
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_nothing_is_opened_before_a_camera_of_opengl_draws():
    before, after = run("""
sim = make(exact={}, shown={"renderer": "opengl"})
sim.step_to_image("exact"), sim.render("exact"), sim.render_depth("exact"), sim.render_segmentation("shown")
before = opened()
sim.render("shown")
print(json.dumps([before, opened()]))
""")
    assert before == [] and {"libOSMesa", "libEGL"} & set(after)


def test_what_drew_and_its_version_is_known_once_it_drew():
    before, after, asked = run("""
sim = make(shown={"renderer": "opengl"})
before = sim.opengl
sim.render("shown")
print(json.dumps([before, sim.opengl, opengl_description()]))
""")
    assert before == "" and after == asked and "Mesa " in after


SAME = """
sim = make(shown={"renderer": "opengl", "gl": "%s"})
sim.step_to_image("shown")
print(json.dumps([digest(sim.render("shown")), sim.run_hash, sim.opengl]))
"""


def test_images_are_the_same_in_every_process_whatever_the_number_of_threads():
    assert run(SAME % "osmesa", LP_NUM_THREADS="0") == run(SAME % "osmesa", LP_NUM_THREADS="2")


THROUGH_EGL = ", through EGL"


def test_images_are_the_same_through_egl():
    try:
        image, run_hash, drawn_by = run(SAME % "egl")
    except AssertionError as error:
        pytest.skip(f"no EGL without a display: {error}")
    software = run(SAME % "osmesa")
    if drawn_by.replace(THROUGH_EGL, "") != software[2].replace(THROUGH_EGL, ""):
        pytest.skip(f"EGL draws with {drawn_by}, OSMesa with {software[2]}")
    assert [image, run_hash] == software[:2]


def test_without_osmesa_cameras_are_drawn_through_egl_and_say_so():
    image, run_hash, drawn_by = run(SAME % "osmesa", ARAS_VISUAL_SERVO_OSMESA="libNoSuchThing.so")
    assert "llvmpipe" in drawn_by and drawn_by.endswith(THROUGH_EGL)
    expected = run(SAME % "osmesa")
    if expected[2].endswith(THROUGH_EGL):
        pytest.skip("there is no OSMesa to compare with")
    assert [image, run_hash, drawn_by] == [*expected[:2], expected[2] + THROUGH_EGL]


def test_compiled_shaders_are_kept_in_a_folder_of_ours_and_nowhere_else(tmp_path):
    environment = {"HOME": str(tmp_path / "home"), "XDG_CACHE_HOME": "", "MESA_SHADER_CACHE_DIR": ""}
    (tmp_path / "home").mkdir()
    program = """
import os
os.environ.pop("MESA_SHADER_CACHE_DIR"), os.environ.pop("XDG_CACHE_HOME")
make(shown={"renderer": "opengl"}).render("shown")
print(json.dumps([]))
"""
    run(program, ROS_HOME=str(tmp_path / "ros"), **environment)
    assert any((tmp_path / "ros" / "aras_visual_servo").rglob("*"))
    assert not list((tmp_path / "home").iterdir())


def test_hashes_of_the_coverage_renderer_do_not_depend_on_cameras_of_opengl():
    alone, beside = run("""
hashes = []
for cameras in ({"exact": {}}, {"exact": {}, "shown": {"renderer": "opengl"}}):
    sim = make(**cameras)
    hashes.append(digest(sim.render("exact")))
    if len(cameras) > 1:
        sim.render("shown")
        hashes[-1] = digest(sim.render("exact"))
print(json.dumps(hashes))
""")
    assert alone == beside != hashlib.sha256(b"").hexdigest()


SENSOR = """<gazebo reference="camera_link"><sensor type="camera" name="eye"><update_rate>20</update_rate><camera>
<horizontal_fov>1.2</horizontal_fov><image><width>64</width><height>48</height></image></camera></sensor></gazebo>"""


@pytest.mark.parametrize("keys, drawn_by_opengl", [({}, True), ({"tag_renderer": "coverage"}, False)])
def test_cameras_of_gazebos_tags_are_drawn_by_opengl_unless_told(keys, drawn_by_opengl):
    from aras_visual_servo_sim import Simulation
    sim = Simulation(f'<robot name="r"><link name="camera_link"/>{SENSOR}</robot>', keys)
    assert sim.render("eye").shape == (48, 64, 3)
    assert bool(sim.opengl) == drawn_by_opengl
