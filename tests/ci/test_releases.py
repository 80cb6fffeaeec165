"""script/packages.txt gives each release of Debian its packages, and any other system is refused."""
import pathlib
import subprocess

import pytest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "script"


def packages(distribution, release, *sections):
    """The finished shell that lists the packages of a release."""
    command = f'set -euo pipefail; . "{SCRIPT}/environment.sh"; packages_of "$@"'
    return subprocess.run(["bash", "-c", command, "bash", distribution, release, *sections],
                          capture_output=True, text=True, check=False)


def test_a_package_of_one_release_is_installed_there_alone():
    found = {}
    for release in ("12", "13"):
        done = packages("debian", release, "gazebo", "clang")
        assert done.returncode == 0, done.stderr
        found[release] = done.stdout.split()
    assert set(found["12"]) - set(found["13"]) == {"libsdformat-dev", "libclang-rt-14-dev"}
    assert set(found["13"]) - set(found["12"]) == {"libclang-rt-19-dev"}
    assert "clang" in found["12"] and "cmake" not in found["12"]


@pytest.mark.parametrize("distribution, release", [
    ("debian", "11"), ("debian", ""), ("ubuntu", "24.04"), ("ubuntu", "12")])
def test_another_system_is_refused_by_name(distribution, release):
    done = packages(distribution, release, "all")
    assert done.returncode != 0 and done.stdout == ""
    assert all(word in done.stderr for word in (distribution, release, "Debian", "12", "13"))
