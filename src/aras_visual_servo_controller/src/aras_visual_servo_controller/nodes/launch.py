"""Runs a scenario over ROS from the command line: starts roslaunch and gives back the experiment node's exit code.

However it ends, nothing is left behind: see guard.py.
"""

import contextlib
import errno
import hashlib
import json
import os
import shutil
import socket
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlparse
from typing import Optional, Sequence

import yaml

from aras_visual_servo import ArasError, Scenario, study
from aras_visual_servo.processes import MARK, check_signals, marked, signals_held, temporary_folder
from . import guard as guards
from .graph import Graph

LAUNCH_FILE = ("aras_visual_servo_controller", "servo.launch")
NAMESPACE = "aras_visual_servo"  # that of servo.launch
NODES = ("sim", "camera_node", "controller", "experiment")  # which servo.launch starts
EXIT_BROKEN = 3        # the run ended and the experiment node left no exit code
TAIL_LINES = 40        # so many last lines of the log are shown when there is no result


def run_over_ros(scenario: Scenario, results_dir: str, arguments: Sequence[str] = (), verbose: bool = False,
                 namespace: Optional[str] = None) -> int:
    """Run servo.launch and wait for its end.

    Args:
        scenario: `Scenario`; it is run as it stands, with its overrides.  results_dir: root of the result folders.
        arguments: more arguments of servo.launch, `name:=value` each.
        verbose: show the output of the nodes; without it the output goes to roslaunch.log in the result folder, and
            only the outcome is printed.
        namespace: of the graph, with a clock and frames of its own; None: that of servo.launch, with the global ones.
    Returns: exit code of the experiment node: 0 passed, 1 not passed, 2 bad parameters, 3 could not run.
    Raises:
        ArasError: there is no roslaunch in PATH, or a run of this namespace is there already.
        Interrupted: by a signal; the recording is in a closed bag.
    """
    environment = marked(_environment(dict(os.environ)))
    if environment.get("PYTHONPATH"):  # nodes run in another folder, and must find the same modules
        environment["PYTHONPATH"] = os.pathsep.join(map(os.path.abspath, environment["PYTHONPATH"].split(os.pathsep)))
    before = _folders(Path(results_dir) / scenario.name)
    if namespace is not None:
        arguments = [*arguments, f"ns:={namespace}", "side_by_side:=true"]
    with _alone("/" + (namespace or NAMESPACE).strip("/"), environment), temporary_folder("aras_run_") as folder:
        # A node that is killed while it reads a bag leaves temporary files: they are deleted with this folder.
        environment["TMPDIR"] = folder
        # roslaunch imports distutils, in whose place setuptools puts its own, which takes half of roslaunch's start.
        environment.setdefault("SETUPTOOLS_USE_DISTUTILS", "stdlib")
        outcome, resolved = Path(folder) / "exit_code", Path(folder) / f"{scenario.name}.yaml"
        resolved.write_text(scenario.as_yaml(), encoding="utf-8")
        model, controllers = scenario.urdf_path, scenario.controllers_path
        if scenario.robot.get("dynamics"):
            model, controllers = Path(folder) / "robot.urdf", Path(folder) / "controllers.yaml"
            model.write_text(scenario.urdf_xml(), encoding="utf-8")
            controllers.write_text(yaml.safe_dump(scenario.controllers(), sort_keys=False), encoding="utf-8")
        # Without the check roslaunch would add up the sizes of all logs that were ever written.
        command = ["roslaunch", "--skip-log-check", *LAUNCH_FILE, f"scenario:={scenario.path or scenario.name}",
                   f"scenario_file:={resolved}", f"model:={model}",
                   f"controllers:={controllers}", f"results_dir:={os.path.abspath(results_dir)}",
                   f"exit_code_file:={outcome}", "guard:=false", *arguments]  # ours is enough
        log = Path(folder) / "roslaunch.log"
        try:
            with open(log, "wb") as stream:
                _launch(command, environment, folder,
                        {} if verbose else {"stdout": stream, "stderr": subprocess.STDOUT})
        except KeyboardInterrupt:
            made = _keep_log(Path(results_dir) / scenario.name, before, log)
            for bag in made[-1].glob("*.bag") if made else ():
                print(f"recorded so far: {bag}", file=sys.stderr)
            raise
        code = int(outcome.read_text()) if outcome.exists() else EXIT_BROKEN
        if not verbose:
            _tell(Path(results_dir) / scenario.name, before, log, code)
        return code


@contextlib.contextmanager
def _alone(namespace, environment):
    """Reserves the namespace of a master for this process. Raises ArasError if a run is there already.

    ROS ends a node when another one of the same name starts. The master knows only nodes that have started. Therefore
    two runs that start at the same moment also compete for the name of a socket; nothing connects to it, and the name
    is free again when this process ends.
    """
    graph = Graph("/run", environment["ROS_MASTER_URI"])
    master = graph.master_uri() or environment["ROS_MASTER_URI"]
    with socket.socket(socket.AF_UNIX) as claim:
        graph_of = [f"{namespace}/{name}" for name in NODES]
        try:
            claim.bind("\0aras_run/" + hashlib.sha256(f"{master} {namespace}".encode()).hexdigest())
            found = graph.running(graph_of)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            found = graph.running(graph_of) or ["another run"]
        if found:
            raise ArasError(f"namespace {namespace} of the master {master}: {', '.join(found)} runs there already; "
                            "wait for its end, or choose another with --namespace")
        yield


def _folders(parent):
    return set(parent.iterdir()) if parent.is_dir() else set()


def _keep_log(parent, before, log):
    """Copies the logs of the nodes into the folder of the run. Returns the new folders, sorted."""
    made = sorted(_folders(parent) - before)
    for folder in made[-1:]:
        try:
            shutil.copyfile(log, folder / "roslaunch.log")
        except OSError as error:
            print(f"note: {folder / 'roslaunch.log'} cannot be written: {error.strerror}", file=sys.stderr)
    return made


def _tell(parent, before, log, code):
    """Prints the outcome of the run that made a folder in `parent`; without one, the last log lines."""
    made = _keep_log(parent, before, log)
    if made and (made[-1] / "summary.json").is_file():
        summary = json.loads((made[-1] / "summary.json").read_text(encoding="utf-8"))
        print(study("report").format_summary({**summary, "report": str(made[-1] / "report.html")}))
    else:
        lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
        print("\n".join(lines[-TAIL_LINES:]), file=sys.stderr)
        print(f"the run ended with exit code {code}, without a result", file=sys.stderr)


def _environment(environment):
    """With the master that runs, else with the address of one that roslaunch will start on a free port of the loopback.

    A graph of our own stays on the loopback, unless the user says by ROS_HOSTNAME or ROS_IP where it should listen.
    """
    uri = environment.get("ROS_MASTER_URI", "")
    if uri and Graph("/run", uri).master_answers():
        return environment
    host = urlparse(uri).hostname or "localhost"
    if not host.startswith("127.") and host not in ("localhost", "::1", socket.gethostname()):
        raise ArasError(f"ROS_MASTER_URI={uri}: no master answers there, and roslaunch can start one on this machine "
                        "only: start it there, or name a host of this machine")
    if "ROS_IP" not in environment and host != socket.gethostname():
        environment.setdefault("ROS_HOSTNAME", "localhost")
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return dict(environment, ROS_MASTER_URI=f"http://{host}:{probe.getsockname()[1]}")


def _launch(command, environment, folder, streams):
    """Run roslaunch to its end, and see that nothing that it started outlives it."""
    guard = process = None
    check_signals()
    try:
        with signals_held():
            guard = subprocess.Popen([sys.executable, "-m", guards.__name__, environment[MARK], folder],
                                     stdin=subprocess.PIPE, start_new_session=True)
            process = subprocess.Popen(command, env=environment, start_new_session=True, **streams)
        process.wait()
    except OSError as error:
        raise ArasError(f"roslaunch: {error.strerror}; source the workspace, or use --in-process") from error
    finally:
        guards.end_launch(environment[MARK])
        if process is not None:
            process.wait()
        if guard is not None:
            guard.communicate(b"ended in order")
