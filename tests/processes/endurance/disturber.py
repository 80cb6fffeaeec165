"""Makes a machine crowded for chosen processes: stops and continues them, nices them, pins them to one core, and keeps
one core or two busy. What it does next is drawn from a seed; when it happens depends on the wall clock.
"""
import os
import pathlib
import random
import signal
import subprocess
import sys
import threading

MARK = "ARAS_ENDURANCE"          # in the environment of the processes that are disturbed
STOP_S = (0.001, 0.12)           # wall time for which a process is stopped
BUSY_S = (0.05, 0.4)             # wall time for which cores are kept busy
PAUSE_S = (0.0, 0.1)             # wall time between two disturbances
MOST_NICE = 19
BURN = "while True: pass"


def marked(mark):
    """Ids of the processes with this mark in their environment."""
    found, wanted = [], f"{MARK}={mark}\0".encode()
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (folder / "environ").read_bytes():
                found.append(int(folder.name))
        except OSError:
            pass  # it has ended, or is somebody else's
    return sorted(found)


class Disturber:
    """Context manager: disturbs the processes with a mark until the block ends, then lets all of them run again.

    Attributes:
        counts: {what: how often it was done}.
    """

    def __init__(self, mark, seed):
        self._mark, self._random = mark, random.Random(seed)
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._work, daemon=True)
        self._cores = sorted(os.sched_getaffinity(0))
        self.counts = {}

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()

    def _work(self):
        kinds = (self._stop, self._stop, self._nice, self._pin, self._spread, self._occupy)
        while not self._ended.wait(self._random.uniform(*PAUSE_S)):
            processes = marked(self._mark)
            kind, choice = self._random.choice(kinds), self._random.random()
            if processes:
                kind(processes[int(choice * len(processes))])
                name = kind.__name__.strip("_")
                self.counts[name] = self.counts.get(name, 0) + 1

    def _stop(self, process):
        seconds = self._random.uniform(*STOP_S)
        try:
            os.kill(process, signal.SIGSTOP)
        except ProcessLookupError:
            return
        try:
            self._ended.wait(seconds)
        finally:
            os.kill(process, signal.SIGCONT)

    def _nice(self, process):
        least = os.getpriority(os.PRIO_PROCESS, 0)
        value = self._random.randint(least, MOST_NICE)
        for thread in _threads(process):
            _unless_gone(os.setpriority, os.PRIO_PROCESS, thread, max(value, _niceness(thread) if os.getuid() else 0))

    def _pin(self, process):
        core = {self._random.choice(self._cores)}
        for thread in _threads(process):
            _unless_gone(os.sched_setaffinity, thread, core)

    def _spread(self, process):
        for thread in _threads(process):
            _unless_gone(os.sched_setaffinity, thread, self._cores)

    def _occupy(self, _process):
        burners = [subprocess.Popen([sys.executable, "-c", BURN])
                   for _ in range(self._random.randint(1, min(2, len(self._cores))))]
        try:
            self._ended.wait(self._random.uniform(*BUSY_S))
        finally:
            for burner in burners:
                burner.kill()
                burner.wait()


def _threads(process):
    try:
        return [int(name) for name in os.listdir(f"/proc/{process}/task")]
    except OSError:
        return []


def _niceness(thread):
    try:
        return os.getpriority(os.PRIO_PROCESS, thread)
    except OSError:
        return MOST_NICE


def _unless_gone(function, *arguments):
    try:
        function(*arguments)
    except (ProcessLookupError, PermissionError):
        pass
