"""A run over ROS ended by a signal, at any moment: nothing is left, the bag is closed, the exit code says so."""
import contextlib
import os
import pathlib
import re
import signal
import subprocess
import uuid

import pytest
import rosbag
from ros_graph import LIMIT_S, free_port, until

RUN = ("rosrun", "aras_visual_servo_controller", "run")
NODES = {"sim_node", "controller", "experiment"}
LAUNCH = ("roslaunch", "aras_visual_servo_controller", "servo.launch")


class Watched:
    """A command, and all that it starts, told by a mark in their environment."""

    def __init__(self, command, environment, folder):
        self.results, self.temporary = folder / "results", folder / "tmp"
        self.temporary.mkdir()
        self._mark = uuid.uuid4().hex
        self._log = folder / "said.txt"
        with open(self._log, "wb") as log:
            self.process = subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True, env=dict(
                environment, TMPDIR=str(self.temporary), ARAS_WATCHED=self._mark))

    def names(self):
        """Names of the processes that run."""
        return [name for name, _ in self._running()]

    def _running(self):
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if f"ARAS_WATCHED={self._mark}\0".encode() in (folder / "environ").read_bytes():
                    yield (folder / "comm").read_text().strip(), int(folder.name)
            except OSError:
                pass  # it has ended, or is somebody else's

    def until(self, moment):
        """Wait for a moment of the run, which fails once the command has ended."""
        def came():
            assert self.process.poll() is None, f"it ended before {moment.__name__}\n{self.said()}"
            return moment(self)
        until(came, moment.__name__, self.said)

    def said(self):
        return self._log.read_text(errors="replace")

    def leave_behind(self):
        """A file in the temporary folder of each node, as one leaves there that is killed while it reads a bag."""
        for name, pid in self._running():
            if name in NODES:
                with contextlib.suppress(OSError):  # it has ended
                    [folder] = re.findall("(?:^|\0)TMPDIR=([^\0]*)", pathlib.Path(f"/proc/{pid}/environ").read_text())
                    (pathlib.Path(folder) / f"left_by_{name}").touch()

    def end(self, number):
        """Send the signal. Returns the exit code, once everything is gone."""
        self.process.send_signal(number)
        code = self.process.wait(LIMIT_S)
        until(lambda: not self.names(), "everything is gone", lambda: f"{self.names()}\n{self.said()}")
        return code

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for _, pid in self._running():
            os.kill(pid, signal.SIGKILL)
        self.process.wait()


def roslaunch_starts(watched):
    return "roslaunch" in watched.names()


def nodes_start(watched):
    return {"sim_node", "controller"} <= set(watched.names())


def recording(watched):
    return any(path.stat().st_size > 100_000 for path in watched.results.glob("*/*/run.bag.active"))


def closing(watched):
    return any(watched.results.glob("*/*/run.bag"))


def check_bag(watched):
    [path] = watched.results.glob("*/*/run.bag*")
    assert path.name == "run.bag"
    with rosbag.Bag(str(path)) as bag:
        assert bag.get_message_count() > 0


@pytest.mark.usefixtures("hang_up_is_heard")
@pytest.mark.parametrize("number, moment", [
    (signal.SIGTERM, roslaunch_starts), (signal.SIGTERM, nodes_start), (signal.SIGTERM, recording),
    (signal.SIGTERM, closing), (signal.SIGHUP, recording), (signal.SIGINT, recording), (signal.SIGQUIT, recording),
    (signal.SIGQUIT, nodes_start),
], ids=lambda value: getattr(value, "name", None) or value.__name__)
def test_a_signal_ends_a_run(number, moment, slow_scenario, own_master, tmp_path):
    scenario = "experiment_1" if moment is closing else str(slow_scenario)
    with Watched([*RUN, scenario, "--output", str(tmp_path / "results")], own_master, tmp_path) as run:
        run.until(moment)
        run.leave_behind()
        assert run.end(number) == 128 + number
        assert f"interrupted by {number.name}" in run.said() and "Traceback" not in run.said()
        assert not list(run.temporary.iterdir())
        if moment in (recording, closing):
            check_bag(run)


@pytest.mark.parametrize("moment", [nodes_start, recording], ids=lambda moment: moment.__name__)
def test_a_run_that_is_killed_leaves_nothing(moment, slow_scenario, own_master, tmp_path):
    with Watched([*RUN, str(slow_scenario), "--output", str(tmp_path / "results")], own_master, tmp_path) as run:
        run.until(moment)
        run.leave_behind()
        assert run.end(signal.SIGKILL) == -signal.SIGKILL
        assert not list(run.temporary.iterdir())
        if moment is recording:
            check_bag(run)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGQUIT, signal.SIGKILL], ids=lambda number: number.name)
def test_a_launch_leaves_nothing_whatever_ends_roslaunch(number, slow_scenario, tmp_path):
    environment = dict(os.environ, ROS_MASTER_URI=f"http://localhost:{free_port()}")
    words = [f"scenario:={slow_scenario}", f"results_dir:={tmp_path / 'results'}",
             f"exit_code_file:={tmp_path / 'code'}"]
    with Watched([*LAUNCH, *words], environment, tmp_path) as launch:
        launch.until(recording)
        launch.end(number)
        check_bag(launch)
        assert int((tmp_path / "code").read_text()) == 128 + signal.SIGINT  # what nodes are ended with
