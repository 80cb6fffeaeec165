"""The workspace built by catkin_make, and run by another Python."""

import os
import pathlib
import subprocess
import sys
import xml.etree.ElementTree

import pytest
from release import RELEASE

SOURCES = pathlib.Path(__file__).resolve().parents[2] / "src"
LIMIT_S = 900.0  # wall time for what takes ten seconds of a processor
TARGETS = {"aras_visual_servo_common", "aras_visual_servo_sim_core", "aras_visual_servo_camera_core", "sim_node",
           "camera_node", "aras_visual_servo_msgs_generate_messages"}


@pytest.fixture
def environment():
    """A shell's in which no workspace was sourced: one that is built already would stand in for what is missing."""
    ours = ("CMAKE_PREFIX_PATH", "ROS_PACKAGE_PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "PKG_CONFIG_PATH")
    return {key: value for key, value in os.environ.items() if key not in (*ours, "PWD")}


def test_catkin_make_configures_every_package(tmp_path, environment):
    (tmp_path / "src").mkdir()
    packages = [path.parent for path in SOURCES.glob("*/package.xml")]
    for package in packages:
        (tmp_path / "src" / package.name).symlink_to(package)
    done = subprocess.run(["catkin_make", "-C", str(tmp_path), "--no-color", "-DPYTHON_EXECUTABLE=/usr/bin/python3",
                           "cmake_check_build_system"], cwd=tmp_path, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, timeout=LIMIT_S)
    assert done.returncode == 0, done.stdout[-3000:]
    for package in packages:
        name = xml.etree.ElementTree.parse(package / "package.xml").findtext("name")
        assert f"processing catkin package: '{name}'" in done.stdout
    listed = subprocess.run(["cmake", "--build", "build", "--target", "help"], cwd=tmp_path, env=environment,
                            stdout=subprocess.PIPE, text=True, check=True, timeout=LIMIT_S).stdout
    assert TARGETS <= {line[4:] for line in listed.splitlines() if line.startswith("... ")}


RUN_LIMIT_S = 300.0  # wall time for a command of some seconds on a busy machine


def programs():
    """Paths of the installed programs that are scripts."""
    folders = [pathlib.Path(prefix) / "lib" for prefix in os.environ["CMAKE_PREFIX_PATH"].split(":")]
    found = [path for folder in folders for path in sorted(folder.glob("aras_*/*")) if path.is_file()]
    return [path for path in found if path.read_bytes()[:2] == b"#!"]


def program(name):
    return next(path for path in programs() if path.name == name)


@pytest.fixture
def other_python(tmp_path):
    """The environment of who has another python3 first in PATH; this one only says so and ends."""
    folder = tmp_path / "bin"
    folder.mkdir()
    for name in ("python", "python3"):
        (folder / name).write_text("#!/bin/sh\necho the other Python was taken >&2\nexit 77\n")
        (folder / name).chmod(0o755)
    return dict(os.environ, PATH=f"{folder}:{os.environ['PATH']}")


@pytest.mark.parametrize("path", [pytest.param(path, id=f"{path.parent.name}/{path.name}") for path in programs()])
def test_an_installed_program_names_its_interpreter_whole(path):
    line = path.read_text(encoding="utf-8").splitlines()[0]
    assert line.startswith("#!/") and "env" not in line and os.access(line[2:], os.X_OK), line


@pytest.mark.parametrize("words", [
    ("run", "--list"), ("teleop", "--help"),
    ("run", "experiment_1", "--in-process", "--output", "results"),
    ("compare_laws", "--laws", "pbvs,points", "--tasks", "turn_45", "--workers", "2", "--output", "results"),
    ("sweep", "experiment_1", "--starts", "4", "--set", "servo.time_limit_s=0.2", "--workers", "2",
     "--output", "results"),
], ids=lambda words: words[0] + words[1])
def test_a_command_and_the_processes_it_starts_take_the_right_python(other_python, tmp_path, words):
    done = subprocess.run([program(words[0]), *words[1:]], env=other_python, cwd=tmp_path, text=True,
                          timeout=RUN_LIMIT_S, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    assert done.returncode == 0 and done.stdout and "the other Python" not in done.stderr, done.stderr


@pytest.mark.parametrize("module", ["aras_visual_servo_controller.nodes.experiment", "gazebo_ros.node.server"])
def test_what_is_installed_is_compiled(module):
    """Where Python is told to write nothing, as in many images of containers, each process would compile it anew."""
    done = subprocess.run([sys.executable, "-v", "-c", f"import {module}"], stderr=subprocess.PIPE, check=True,
                          text=True, env=dict(os.environ, PYTHONDONTWRITEBYTECODE="1"))
    compiled = [line.split()[-1] for line in done.stderr.splitlines() if line.startswith("# code object from ")]
    ours = tuple(os.environ["CMAKE_PREFIX_PATH"].split(":"))
    assert f"import '{module}'" in done.stderr and not [path for path in compiled if path.startswith(ours)]


@pytest.mark.skipif(RELEASE != "12", reason="the pybind11 of Debian 12 alone crashes with numpy 2")
def test_a_numpy_that_would_crash_the_kinematics_is_refused_in_one_sentence(tmp_path):
    (tmp_path / "numpy").mkdir()
    (tmp_path / "numpy" / "__init__.py").write_text("__version__ = '2.4.6'\n")
    code = "import sys; sys.path.insert(0, '.'); import aras_visual_servo._kinematics"
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, text=True, stderr=subprocess.PIPE, check=False)
    said = done.stderr.splitlines()[-1]
    assert done.returncode == 1 and said.startswith("ImportError: numpy: found 2.4.6 in ") and "allowed 1" in said
