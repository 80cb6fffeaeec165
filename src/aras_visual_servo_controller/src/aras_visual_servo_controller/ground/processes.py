"""How our processes end: in order when a signal comes, and with the process that started them.

>>> with signals_raise():
...     work()                  # SIGHUP, SIGINT, SIGQUIT, SIGTERM raise Interrupted here, in the main thread
"""

import contextlib
import ctypes
import importlib
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

SIGNALS = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM)
EXIT_SIGNALLED = 128   # plus the signal's number: what a shell reports of a process that a signal ended
CLOSING_S = 3.0        # wall time
MARK = "ARAS_PROCESSES_OF"
PR_SET_PDEATHSIG = 1   # linux/prctl.h


class Interrupted(KeyboardInterrupt):
    """One of SIGNALS came. `exit_code`: what this process should end with."""

    def __init__(self, number):
        super().__init__(f"interrupted by {signal.Signals(number).name}")
        self.exit_code = EXIT_SIGNALLED + number


class _Signals:
    """What came and what is held back. Signals belong to the process, so there is one."""

    def __init__(self):
        self.raised, self.since_s, self.pending, self.holds = None, 0.0, None, 0

    def came(self, number, _frame=None):
        if self.raised and time.monotonic() - self.since_s < CLOSING_S:
            return  # we are ending already: what is open gets closed
        if self.holds:
            self.pending = self.pending or number
            return
        self.raised, self.since_s, self.pending = number, time.monotonic(), None
        raise Interrupted(number)

    def let_through(self):
        if not self.holds and self.pending is not None:
            self.came(self.pending)


_signals = _Signals()


@contextlib.contextmanager
def signals_raise():
    """Inside, the first of SIGNALS raises Interrupted; others are ignored for CLOSING_S, while what is open is closed.

    A SIGHUP that is ignored stays ignored (nohup). It does nothing outside the main thread, nor inside itself.
    """
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGTERM) == _signals.came:
        yield
        return
    _signals.__init__()
    before = {number: signal.getsignal(number) for number in SIGNALS}
    if before[signal.SIGHUP] == signal.SIG_IGN:
        del before[signal.SIGHUP]
    try:
        for number in before:
            signal.signal(number, _signals.came)
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, signal.SIG_DFL if handler is None else handler)


def check_signals():
    """Raise the Interrupted that somebody else's code has swallowed, as `import cv2` and parts of rospy do."""
    if _signals.raised:
        raise Interrupted(_signals.raised)


def run_main(module):
    """Import a module of this package and run its main(), so that a signal during the import ends it too.

    Returns the exit code.
    """
    try:
        with signals_raise():
            main = importlib.import_module(module, __package__).main
            check_signals()
            return main()
    except Interrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return interrupt.exit_code


@contextlib.contextmanager
def signals_held():
    """Inside, SIGNALS wait: for what must not be left half done. They raise when the block ends."""
    _signals.holds += 1
    try:
        yield
    finally:
        _signals.holds -= 1
        _signals.let_through()


@contextlib.contextmanager
def signals_let_through():
    """Inside `signals_held`: they raise here again, between what is opened and what is closed."""
    holds, _signals.holds = _signals.holds, 0
    try:
        _signals.let_through()
        yield
    finally:
        _signals.holds = holds


@contextlib.contextmanager
def temporary_folder(prefix):
    """Path of a folder that is gone afterwards, whatever signal comes when."""
    with signals_held():
        folder = tempfile.mkdtemp(prefix=prefix)
        try:
            with signals_let_through():
                yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def end_with_parent(number=signal.SIGKILL):
    """In a child: get this signal when the parent dies, however it dies, so that no process is left behind."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, number)


def marked(environment):
    """A copy of an environment by which `processes_of` finds whoever gets it, and all that these start."""
    return dict(environment, **{MARK: f"{os.getpid()}-{os.urandom(8).hex()}"})


def processes_of(mark):
    """pid -> name of the running processes whose environment has this mark."""
    found, wanted = {}, f"{MARK}={mark}\0".encode()
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (folder / "environ").read_bytes():
                found[int(folder.name)] = (folder / "comm").read_text().strip()
        except OSError:
            pass  # it has ended, or is somebody else's
    return found
