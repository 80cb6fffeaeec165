"""The files that continuous integration reads say what README says, and the job for a lab runs as it is printed."""
import os
import pathlib
import re
import shutil
import subprocess

import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAB = ROOT / "tests" / "ci" / "lab_head"
#: Lines of the jobs that the machine of this test has behind it.
DONE = ("apt-get update", "git clone", "simulator/script/bootstrap")


def read(path):
    return (ROOT / path).read_text()


def readme_commands():
    """The two commands that README begins with."""
    block = re.search(r"On a stock Debian 12 or 13, from the clone:\n```\n(.*?)```", read("README.md"), re.S).group(1)
    return [line.split("#")[0].strip() for line in block.splitlines()]


def blocks():
    """The jobs of docs/ci.md: parsed YAML."""
    return [yaml.safe_load(text) for text in re.findall(r"```yaml\n(.*?)```", read("docs/ci.md"), re.S)]


def allowed_releases():
    """The releases of Debian that script/bootstrap installs packages for."""
    return re.search(r"^releases=\((.*)\)$", read("script/environment.sh"), re.M).group(1).split()


def test_both_pipelines_run_readmes_commands_in_each_release_of_debian():
    github = yaml.safe_load(read(".github/workflows/ci.yml"))["jobs"]["debian"]
    gitlab = yaml.safe_load(read(".gitlab-ci.yml"))["debian"]
    assert github["container"] == "debian:${{ matrix.release }}" and gitlab["image"] == "debian:$RELEASE"
    assert [str(number) for number in github["strategy"]["matrix"]["release"]] == allowed_releases()
    assert [entry["RELEASE"] for entry in gitlab["parallel"]["matrix"]] == [allowed_releases()]
    scripts = [step["run"] for step in github["steps"] if step.get("run", "").startswith("script/")]
    assert scripts == gitlab["script"] == readme_commands() == ["script/demo", "script/test"]


def test_both_pipelines_fuzz_every_reader_for_a_minute():
    github = yaml.safe_load(read(".github/workflows/ci.yml"))["jobs"]["fuzz"]
    gitlab = yaml.safe_load(read(".gitlab-ci.yml"))["fuzz"]
    assert github["container"] == gitlab["image"] == "debian:12"
    assert [step["run"] for step in github["steps"] if "script/" in step.get("run", "")] == ["script/fuzz 1"]
    assert gitlab["script"] == ["script/fuzz 1"]


def test_the_image_installs_the_same_list(tmp_path):
    lines = read("Dockerfile").splitlines()
    assert lines[[line.startswith("FROM") for line in lines].index(True)] == "FROM debian:${RELEASE} AS packages"
    assert lines[lines.index("FROM debian:${RELEASE} AS packages") - 1].partition("RELEASE=")[2] in allowed_releases()
    *files, target = next(line for line in lines if line.startswith("COPY script")).split()[1:]
    assert target == "script/"
    (tmp_path / "script").mkdir()
    for name in files:
        shutil.copy(ROOT / name, tmp_path / "script")
    command = re.search(r"RUN (script/bootstrap .*)", read("Dockerfile")).group(1).split()
    assert "--packages" in command
    # Here the packages are there already: the same files are enough to find that out, and nothing is built.
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "building" not in done.stderr and not (tmp_path / "install").exists()
    container = yaml.safe_load(read(".devcontainer/devcontainer.json"))
    assert container["build"]["target"] == "packages" and container["postCreateCommand"].startswith("script/bootstrap")


def lines_of(job):
    """The shell lines of one of the jobs of docs/ci.md."""
    if "jobs" in job:
        (steps,) = [each["steps"] for each in job["jobs"].values()]
        lines = [line for step in steps for line in step.get("run", "").splitlines()]
    else:
        (lines,) = [each["script"] for each in job.values()]
    return lines


@pytest.mark.parametrize("index", [0, 1], ids=["github", "gitlab"])
def test_the_labs_job_passes_and_fails_with_its_node(tmp_path, index):
    job = blocks()[index]
    lines = lines_of(job)
    assert sum(line.startswith(DONE) for line in lines) == (2 if index == 0 else 3), "it brings what it needs"
    if "jobs" in job:
        steps = job["jobs"]["simulator"]["steps"]
        paths = [step["with"]["path"] for step in steps if "checkout" in step.get("uses", "")]
        assert paths == ["src/my_package", "simulator"]
        shutil.copytree(LAB, tmp_path / "src" / "my_package")
    else:
        shutil.copytree(LAB, tmp_path, dirs_exist_ok=True)
    (tmp_path / "simulator").symlink_to(ROOT)
    script = "\n".join(["set -e", *(line for line in lines if not line.startswith(DONE))])
    script = script.replace("rostest my_package", "rostest lab_head")
    foreign = ("CMAKE_PREFIX_PATH", "PYTHONPATH")
    environment = {name: value for name, value in os.environ.items() if name not in foreign}
    # The jobs have the same lines: that they fail is seen with one.
    for without, passes in (("false", True), ("true", False))[:2 - index]:
        done = subprocess.run(["bash", "-c", script], cwd=tmp_path, capture_output=True, text=True, timeout=600,
                              env={**environment, "WITHOUT_NODE": without, "ROS_MASTER_URI": "http://localhost:0"})
        assert (done.returncode == 0) is passes, done.stdout[-3000:] + done.stderr[-3000:]
        assert "TESTS: 1" in done.stdout, done.stdout[-3000:]
