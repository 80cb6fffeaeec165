"""Runs the recorder node (src/ros/recorder.cpp) as a child process and ends it so that the bag is closed."""

import functools
import os
import signal
import subprocess
from pathlib import Path

from ..ground.errors import ArasError
from ..ground.processes import end_with_parent


COMPRESSIONS = {"lz4": ("--lz4",), "bz2": ("--bz2",), "none": ()}


class RecorderError(ArasError):
    """The recorder could not start, died, or left no bag."""


class Recorder:
    """Records topics to a bag. The buffer has no limit, so no message of a run is lost.

    Args:
        program: path of the recorder node.  bag: path of the bag, must not exist.  topics: resolved names.
        node: absolute name for the recorder's node.
        clock: resolved name of /clock; the bag is in simulated time.
        split_mb: size after which a new bag begins, NAME_0.bag, NAME_1.bag, ... [MiB]; 0 writes one bag.
        compression: one of COMPRESSIONS.
    """

    def __init__(self, program, bag, topics, node, clock="/clock", split_mb=0, compression="lz4"):
        self.bag, self.node, self.topics, self._split = Path(bag), node, list(topics), bool(split_mb)
        namespace, _, name = node.rpartition("/")
        command = [program, *COMPRESSIONS[compression]]
        command += ["--split", "--size", str(int(split_mb))] if split_mb else []
        command += ["-O", str(self.bag)]
        command += self.topics + [f"__name:={name}"] + ([f"/clock:={clock}"] if clock != "/clock" else [])
        # In a process group of its own, so that Ctrl-C in the terminal does not close the bag before the run has ended.
        self._process = subprocess.Popen(command, env=dict(os.environ, ROS_NAMESPACE=namespace or "/"),
                                         start_new_session=True,
                                         preexec_fn=functools.partial(end_with_parent, signal.SIGINT))

    def check(self):
        """Raises RecorderError if the recorder has ended."""
        code = self._process.poll()
        if code is not None:
            raise RecorderError(f"the recorder ended by itself with exit code {code}")

    def bags(self):
        """Paths of the bags so far in order, the closed ones and the one that is being written."""
        names = [f"{self.bag.stem}_*.bag", f"{self.bag.stem}_*.bag.active"] if self._split else \
            [self.bag.name, f"{self.bag.name}.active"]
        found = [path for name in names for path in self.bag.parent.glob(name)]
        return sorted(found, key=lambda path: (len(path.name.partition(".")[0]), path.name))

    def written_bytes(self):
        """Size of the recording so far [B]."""
        size = 0
        for path in self.bags():
            try:
                size += path.stat().st_size
            except FileNotFoundError:
                pass  # the recorder has renamed it meanwhile
        return size

    def stop(self, timeout_s=60.0):
        """End the recording and wait until the bag is closed. Does no harm if the recording has ended already.

        Args:
            timeout_s: wall time after which the recorder is killed [s].
        Raises:
            RecorderError: the bag was not closed.
        """
        if self._process.poll() is None:
            _signal_group(self._process.pid, signal.SIGINT)
            try:
                self._process.wait(timeout_s)
            except subprocess.TimeoutExpired:
                _signal_group(self._process.pid, signal.SIGKILL)
                self._process.wait()
        if not self.bags():
            raise RecorderError(f"{self.bag}: the recorder ended before it opened the bag")
        if any(path.suffix == ".active" for path in self.bags()):
            raise RecorderError(f"{self.bag}: the recorder did not close the bag")


def _signal_group(pid, number):
    try:
        os.killpg(pid, number)
    except ProcessLookupError:
        pass
