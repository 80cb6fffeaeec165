"""Nothing that roslaunch started outlives it, whatever ends it: a signal, its own mistake, SIGKILL.

roslaunch ends its nodes in order after SIGTERM, SIGINT and SIGHUP, but not at every moment of its start, and not when
it is killed. Two guards see to that, processes of their own that a kill of the others does not reach:

    python3 -m aras_visual_servo_controller.nodes.guard MARK FOLDER    of `run`: when its stdin ends, as `run` does
    guard                                                              in servo.launch: when roslaunch ends
"""

import os
import select
import shutil
import signal
import sys
import time
from pathlib import Path
from typing import Set

from aras_visual_servo.processes import processes_of

ORDERLY_S = 2.0    # wall time that nodes get to end, before they are killed
RECORDER_S = 60.0  # wall time that the simulator gets to close its bag on a slow disk
POLL_S = 0.02
CHILDREN_S = 0.2   # wall time between looks at the children of roslaunch
LAUNCHER, RECORDER = "roslaunch", "sim_node"  # names of their processes; the simulator writes the bag


def end_launch(mark: str) -> None:
    """End everything that was started in the environment of this mark: roslaunch first, which then ends its nodes.

    Processes that remain after ORDERLY_S are killed, but for the simulator, which gets RECORDER_S to close its bag.
    """
    left = processes_of(mark)
    _signal([pid for pid, name in left.items() if name == LAUNCHER], signal.SIGTERM)
    until_s, told = time.monotonic() + ORDERLY_S, set()
    while left and time.monotonic() < until_s:
        if LAUNCHER not in left.values():  # it was killed, or ended while it was still starting nodes
            _signal(set(left) - told, signal.SIGINT)
            told |= set(left)
        time.sleep(POLL_S)
        left = processes_of(mark)
    _signal([pid for pid, name in left.items() if name != RECORDER], signal.SIGKILL)
    until_s = time.monotonic() + RECORDER_S
    while processes_of(mark) and time.monotonic() < until_s:
        time.sleep(POLL_S)
    _signal(processes_of(mark), signal.SIGKILL)


def _signal(pids, number):
    for pid in pids:
        try:
            os.kill(pid, number)
        except ProcessLookupError:
            pass


def children_of(pid: int) -> Set[int]:
    """Set of the pids of the children of a process."""
    found = set()
    told = list(Path(f"/proc/{pid}/task").glob("*/children"))  # of each thread, where the kernel tells it
    for path in told or Path("/proc").glob("[0-9]*/stat"):
        try:
            if told:
                found.update(map(int, path.read_text().split()))
            elif int(path.read_text().rpartition(")")[2].split()[1]) == pid:
                found.add(int(path.parent.name))
        except OSError:
            pass  # it has ended
    return found


def guard_launch() -> int:
    """As a child of roslaunch: waits for its end, and ends its remaining processes. Returns the exit code."""
    signal.signal(signal.SIGINT, lambda *_: sys.exit(0))  # roslaunch ends in order
    parent = os.getppid()
    lives, siblings = os.pidfd_open(parent), {}  # file descriptors stand for the same process for good, pids do not
    while not select.select([lives], [], [], CHILDREN_S)[0]:
        for pid in children_of(parent) - set(siblings) - {os.getpid()}:
            try:
                siblings[pid] = os.pidfd_open(pid)
            except ProcessLookupError:
                pass
    for number in (signal.SIGINT, signal.SIGKILL):
        for descriptor in siblings.values():
            try:
                signal.pidfd_send_signal(descriptor, number)
            except ProcessLookupError:
                pass
        until_s = time.monotonic() + ORDERLY_S
        while siblings and time.monotonic() < until_s:
            ended = set(select.select(list(siblings.values()), [], [], POLL_S)[0])
            siblings = {pid: descriptor for pid, descriptor in siblings.items() if descriptor not in ended}
    return 0


def main() -> int:
    """Entry of `python3 -m`. Returns the exit code."""
    mark, folder = sys.argv[1:]
    for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    if not sys.stdin.buffer.read():  # `run` ended without a word
        end_launch(mark)
        shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
