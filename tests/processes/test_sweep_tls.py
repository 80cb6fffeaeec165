"""A sweep on a Dask scheduler that speaks TLS, switched on by the three lines of docs/security.md."""
import json
import os
import pathlib
import subprocess

import pytest
from ros_graph import until

PAGE = pathlib.Path(__file__).resolve().parents[2] / "docs" / "security.md"
LIMIT_S = 120.0  # wall time for what takes some seconds
SWEEP = ("rosrun", "aras_visual_servo_controller", "sweep", "experiment_1", "--starts", "2", "--set",
         "servo.time_limit_s=0.2", "--output", "results", "--scheduler")


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    return tmp_path_factory.mktemp("home")


@pytest.fixture(scope="module")
def environment(home):
    """What a shell has in which the lines of the page were typed."""
    lines = [line for line in PAGE.read_text().splitlines() if line.startswith(("pem=", "export DASK_"))]
    assert len(lines) == 3
    words = subprocess.run(["bash", "-ec", "\n".join([*lines, "env -0"])], env=dict(os.environ, HOME=str(home)),
                           stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=LIMIT_S,
                           check=True).stdout
    return dict(word.split("=", 1) for word in words.split("\0") if word)


@pytest.fixture(scope="module")
def scheduler(home, environment):
    """Address of a scheduler with one worker."""
    processes, path = [], home / "scheduler.json"

    def start(*command):
        with open(home / f"{command[0]}.log", "wb") as log:
            processes.append(subprocess.Popen(command, cwd=home, env=environment, stdout=log, stderr=log))

    try:
        start("dask-scheduler", "--protocol", "tls", "--host", "127.0.0.1", "--port", "0", "--scheduler-file",
              str(path), "--dashboard-address", "127.0.0.1:0")
        address = until(lambda: address_in(path), "the scheduler's address", limit_s=LIMIT_S)
        start("dask-worker", address, "--nworkers", "1", "--nthreads", "1", "--host", "127.0.0.1",
              "--dashboard-address", "127.0.0.1:0")
        until(lambda: "Registered to" in (home / "dask-worker.log").read_text(), "a worker at the scheduler",
              limit_s=LIMIT_S)
        yield address
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(LIMIT_S)


def address_in(path):
    """Address that a scheduler has written into its file; None until the file is there and whole."""
    try:
        return json.loads(path.read_text())["address"]
    except (FileNotFoundError, json.JSONDecodeError):
        return None


def sweep(address, environment, folder):
    return subprocess.run([*SWEEP, address], cwd=folder, env=environment, stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=LIMIT_S, check=False)


def test_who_shows_the_certificate_sweeps(scheduler, environment, tmp_path):
    done = sweep(scheduler, environment, tmp_path)
    assert scheduler.startswith("tls://") and done.returncode == 0 and "2 runs" in done.stdout, done.stderr


def test_who_has_none_is_told_in_one_sentence(scheduler, tmp_path):
    done = sweep(scheduler, dict(os.environ), tmp_path)
    assert done.returncode == 3 and "Traceback" not in done.stderr
    assert "TLS" in done.stderr and "docs/security.md" in done.stderr and len(done.stderr.splitlines()) == 2


def test_who_speaks_plainly_is_not_heard(scheduler, tmp_path):
    done = sweep(scheduler.replace("tls://", "tcp://"), dict(os.environ), tmp_path)
    assert done.returncode == 3 and "cannot be reached" in done.stderr and "Traceback" not in done.stderr
