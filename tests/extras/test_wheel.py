"""A wheel of the workspace runs without ROS, with the run hash of this release."""
import re
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = """
import sys
import aras_visual_servo as avs
record = avs.run(avs.load_scenario("experiment_1"))
print(record.run_hash, avs.__file__, sorted({"rospy", "roslib", "genpy"} & set(sys.modules)))
"""


def run(*command, **options):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=600, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    run(ROOT / "script" / "wheel", folder / "dist")
    return folder


def test_it_runs_without_ros_with_the_hash_of_the_release(made):
    (wheel,) = made.glob("dist/*.whl")
    assert re.fullmatch(r"aras_visual_servo-[\d.]+-cp(\d+)-cp\1-manylinux_2_\d+_x86_64\.whl", wheel.name)
    clean = {"PATH": "/usr/bin:/bin", "HOME": str(made), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    run("/usr/bin/python3", "-m", "venv", made / "venv", env=clean)
    run(made / "venv/bin/pip", "install", "-q", wheel, env=clean)
    run_hash, path, ros = run(made / "venv/bin/python", "-c", PROGRAM, cwd=made, env=clean).split(maxsplit=2)
    assert Path(path).is_relative_to(made / "venv") and ros.strip() == "[]"
    here = run(sys.executable, "-c", PROGRAM, cwd=made).split()[0]
    assert run_hash == here
    assert "PASSED" in run(made / "venv/bin/aras-servo", "run", "experiment_1", "--output", made / "results", env=clean)


def test_the_source_distribution_has_what_a_build_reads(made):
    (archive,) = made.glob("dist/*.tar.gz")
    names = {name.partition("/")[2] for name in tarfile.open(archive).getnames()}
    assert {"PKG-INFO", "pyproject.toml", "script/bootstrap", "src/aras_visual_servo/package.xml"} <= names
    assert not any(name.startswith(("build/", "install/", "results/")) for name in names)
