"""debian/: each ROS package goes into one Debian package, and dependencies come from script/packages.txt."""
import fnmatch
import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROS_PACKAGES = sorted(path.parent.name for folder in ("src", "gazebo") for path in ROOT.glob(f"{folder}/*/package.xml"))
VERSION = ElementTree.parse(ROOT / "src/aras_visual_servo/package.xml").findtext("version")
INSTALLED = {path.stem: path.read_text(encoding="utf-8").split() for path in (ROOT / "debian").glob("*.install")}


def receivers(path):
    """The Debian packages whose lists name a path or a folder above it."""
    parts = path.split("/")

    def names(pattern):
        wanted = pattern.split("/")
        return len(wanted) <= len(parts) and all(map(fnmatch.fnmatch, parts, wanted))
    return {package for package, patterns in INSTALLED.items() if any(map(names, patterns))}


@pytest.mark.parametrize("name", ROS_PACKAGES)
def test_a_ros_package_goes_into_one_debian_package(name):
    folder = next(path for path in (ROOT / "src" / name, ROOT / "gazebo" / name) if path.is_dir())
    suffix = "-gazebo" if folder.parent.name == "gazebo" else "-learning" if name.endswith("_learning") else ""
    modules = [f"usr/lib/python3/dist-packages/{name}{rest}"
               for rest in ("/__init__.py", f"-{VERSION}.egg-info/PKG-INFO")]
    for place in [f"usr/share/{name}/package.xml", *modules * (folder / "setup.py").is_file()]:
        assert receivers(place) == {f"aras-visual-servo{suffix}"}, place


@pytest.mark.parametrize("release", ["12", "13"])
def test_what_runs_is_asked_for_without_what_compiles(release):
    def listed(*sections):
        command = f'. "{ROOT}/script/environment.sh"; packages_of debian "$@"'
        done = subprocess.run(["bash", "-c", command, "_", release, *sections], stdout=subprocess.PIPE, text=True,
                              check=True, timeout=60)
        return set(done.stdout.split())
    needed, compiles = listed("all"), listed("build")
    assert {"python3-numpy", "python3-roslaunch", "libosmesa6"} <= needed and {"cmake", "build-essential"} <= compiles
    assert not needed & compiles and not needed & listed("optional")
    control, script = ((ROOT / path).read_text(encoding="utf-8") for path in ("debian/control.in", "script/package"))
    written = set(re.findall(r" >debian/([a-z-]+)$", script, re.MULTILINE)) - {"changelog", "control"}
    assert set(re.findall(r"@([a-z-]+)@", control)) == written
