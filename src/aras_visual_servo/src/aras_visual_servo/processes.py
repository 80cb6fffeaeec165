"""Signal handling: a process closes its files when a signal comes, and child processes end with their parent.

>>> with signals_raise():
...     work()                  # SIGHUP, SIGINT, SIGQUIT, SIGTERM raise Interrupted here, in the main thread
"""

import contextlib
import ctypes
import importlib
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Any, Awaitable, Callable, Dict, Iterator, Mapping

SIGNALS = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM)
EXIT_SIGNALLED = 128   # plus the signal's number: exit code that a shell reports for a process ended by a signal
CLOSING_S = 3.0        # wall time
MARK = "ARAS_PROCESSES_OF"
PR_SET_PDEATHSIG = 1   # linux/prctl.h


class Interrupted(KeyboardInterrupt):
    """Raised on one of SIGNALS. `exit_code`: the exit code for this process."""

    def __init__(self, number: int) -> None:
        super().__init__(f"interrupted by {signal.Signals(number).name}")
        self.exit_code = EXIT_SIGNALLED + number


class _Signals:
    """The signals that came, and those that wait. Signals belong to the process, so there is one such object."""

    def __init__(self):
        self.raised, self.since_s, self.pending, self.holds = None, 0.0, None, 0

    def came(self, number, _frame=None):
        if self.raised and time.monotonic() - self.since_s < CLOSING_S:
            return  # this process is already ending and closing its resources
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
def signals_raise() -> Iterator[None]:
    """Inside this block the first of SIGNALS raises Interrupted. Others are ignored for CLOSING_S after it, so that
    files and processes can be closed.

    A SIGHUP that is ignored stays ignored (nohup). The block has no effect outside the main thread or within another
    such block.
    """
    if threading.current_thread() is not threading.main_thread() or signal.getsignal(signal.SIGTERM) == _signals.came:
        yield
        return
    _signals.__init__()  # type: ignore[misc]
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


def check_signals() -> None:
    """Raise Interrupted if a library has swallowed it, as `import cv2` and parts of rospy do."""
    if _signals.raised:
        raise Interrupted(_signals.raised)


def run_main(module: str) -> int:
    """Imports a module and runs its main(), so that a signal during the import ends it too.

    Returns the exit code.
    """
    try:
        with signals_raise():
            main = importlib.import_module(module).main
            check_signals()
            return main()
    except Interrupted as interrupt:
        print(interrupt, file=sys.stderr)
        return interrupt.exit_code


@contextlib.contextmanager
def signals_held() -> Iterator[None]:
    """Inside this block SIGNALS wait, so that nothing is left half done; they raise when the block ends."""
    _signals.holds += 1
    try:
        yield
    finally:
        _signals.holds -= 1
        _signals.let_through()


@contextlib.contextmanager
def signals_let_through() -> Iterator[None]:
    """A part of a `signals_held` block, between its opening and its closing, in which signals raise again."""
    holds, _signals.holds = _signals.holds, 0
    try:
        _signals.let_through()
        yield
    finally:
        _signals.holds = holds


def run_until_signal(work: Callable[[Any], Awaitable[None]]) -> None:
    """asyncio.run of the coroutine work(came), in the main thread. The future `came` gets the first of SIGNALS, and
    work ends soon after. Then that signal raises, as in `signals_raise`.

    Nothing may raise in an event loop from outside: an exception between a task and what wakes it would take the
    wake-up away, and the task would wait for ever.
    """
    import asyncio  # only here: most commands have no event loop

    async def heard():
        loop = asyncio.get_running_loop()
        came = loop.create_future()

        def note(number):
            _signals.came(number)
            if not came.done():
                came.set_result(number)

        for number in SIGNALS:
            if signal.getsignal(number) != signal.SIG_IGN:
                loop.add_signal_handler(number, note, number)
        if _signals.pending is not None:
            note(_signals.pending)
        await work(came)

    with signals_held():
        asyncio.run(heard())


@contextlib.contextmanager
def temporary_folder(prefix: str) -> Iterator[str]:
    """Path of a folder that is deleted when the block ends, also if a signal ends it."""
    with signals_held():
        folder = tempfile.mkdtemp(prefix=prefix)
        try:
            with signals_let_through():
                yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)


def end_with_parent(number: int = signal.SIGKILL) -> None:
    """Called in a child process, which then gets this signal when its parent dies for whatever reason, or has died.

    A process that `multiprocessing` has not made must begin this while its parent is alive.
    """
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, number)
    parent = multiprocessing.parent_process()
    if parent is not None and os.getppid() != parent.pid:
        os.kill(os.getpid(), number)


@contextlib.contextmanager
def signals_blocked() -> Iterator[None]:
    """Processes that are forked inside this block get no signal of SIGNALS before they call `end_as_child`."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_as_child() -> None:
    """Called in a forked worker: the process that forked it ends it, and it ends with that process.

    A terminal sends Ctrl-C to all processes; a worker that obeyed would print a traceback.
    """
    end_with_parent()
    for number in SIGNALS:
        signal.signal(number, signal.SIG_DFL if number == signal.SIGTERM else signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, SIGNALS)


def marked(environment: Mapping[str, str]) -> Dict[str, str]:
    """A copy of an environment with a mark, by which `processes_of` finds the processes that were started with it."""
    return dict(environment, **{MARK: f"{os.getpid()}-{os.urandom(8).hex()}"})


def processes_of(mark: str) -> Dict[int, str]:
    """pid -> name of the running processes whose environment has this mark."""
    found, wanted = {}, f"{MARK}={mark}\0".encode()
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if wanted in (folder / "environ").read_bytes():
                found[int(folder.name)] = (folder / "comm").read_text().strip()
        except OSError:
            pass  # it has ended, or belongs to another user
    return found
