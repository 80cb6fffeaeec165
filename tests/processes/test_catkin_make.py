"""Who builds with catkin_make has all packages in one run of CMake: names of targets and needs must agree."""
import os
import pathlib
import subprocess
import xml.etree.ElementTree

import pytest

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
