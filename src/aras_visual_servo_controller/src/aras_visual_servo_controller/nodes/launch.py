"""Runs a scenario over ROS from the command line: starts roslaunch and gives back the experiment node's exit code."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import urlparse

from ..ground.errors import ArasError
from .graph import Graph
from ..report.report import format_summary

LAUNCH_FILE = ("aras_visual_servo_controller", "servo.launch")
STOP_TIMEOUT_S = 60.0  # wall time that roslaunch gets to end its nodes after an interrupt
EXIT_BROKEN = 3        # the run ended and the experiment node left no exit code
TAIL_LINES = 40        # so many last lines of the log are shown when there is no result


def run_over_ros(scenario, results_dir, arguments=(), verbose=False):
    """Run servo.launch and wait for its end.

    Args:
        scenario: `Scenario` with a path.  results_dir: root of the result folders.
        arguments: more arguments of servo.launch, `name:=value` each.
        verbose: show the output of the nodes; without it the output goes to roslaunch.log in the result folder, and
            only the outcome is printed.
    Returns:
        exit code of the experiment node: 0 passed, 1 not passed, 2 bad parameters, 3 could not run.
    Raises:
        ArasError: there is no roslaunch in PATH.
    """
    environment = dict(os.environ)
    environment["ROS_MASTER_URI"] = _master_uri(environment.get("ROS_MASTER_URI", ""))
    before = _folders(Path(results_dir) / scenario.name)
    with tempfile.TemporaryDirectory(prefix="aras_run_") as folder:
        outcome = Path(folder) / "exit_code"
        command = ["roslaunch", *LAUNCH_FILE, f"scenario:={scenario.path}", f"model:={scenario.urdf_path}",
                   f"controllers:={scenario.controllers_path}", f"results_dir:={os.path.abspath(results_dir)}",
                   f"exit_code_file:={outcome}", *arguments]
        log = Path(folder) / "roslaunch.log"
        with open(log, "wb") as stream:
            try:
                process = subprocess.Popen(command, env=environment, start_new_session=True,
                                           **({} if verbose else {"stdout": stream, "stderr": subprocess.STDOUT}))
            except OSError as error:
                raise ArasError(f"roslaunch: {error.strerror}; source the workspace, or use --in-process") from error
            _wait(process)
        code = int(outcome.read_text()) if outcome.exists() else EXIT_BROKEN
        if not verbose:
            _tell(Path(results_dir) / scenario.name, before, log, code)
        return code


def _folders(parent):
    return set(parent.iterdir()) if parent.is_dir() else set()


def _tell(parent, before, log, code):
    """Print the outcome of the run that made a folder in `parent`, or the last lines of the log if there is none."""
    made = sorted(_folders(parent) - before)
    for folder in made[-1:]:
        shutil.copyfile(log, folder / "roslaunch.log")
    if made and (made[-1] / "summary.json").is_file():
        summary = json.loads((made[-1] / "summary.json").read_text(encoding="utf-8"))
        print(format_summary({**summary, "report": str(made[-1] / "report.html")}))
    else:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
        print("\n".join(lines[-TAIL_LINES:]), file=sys.stderr)
        print(f"the run ended with exit code {code}, without a result", file=sys.stderr)


def _master_uri(uri):
    """The master that runs, else the address of one that roslaunch will start on a free port of the loopback."""
    if uri and Graph("/run", uri).master_answers():
        return uri
    host = urlparse(uri).hostname or "localhost"
    if not host.startswith("127.") and host not in ("localhost", "::1", socket.gethostname()):
        raise ArasError(f"ROS_MASTER_URI={uri}: no master answers there, and roslaunch can start one on this machine "
                        "only: start it there, or name a host of this machine")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return f"http://{host}:{probe.getsockname()[1]}"


def _wait(process):
    try:
        process.wait()
    except BaseException:  # after an interrupt roslaunch ends the nodes in order, so that the bag is closed properly
        process.send_signal(signal.SIGINT)
        try:
            process.wait(STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            process.kill()
        raise
