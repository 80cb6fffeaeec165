"""Does the pending runs of a sweep: in this process, on the cores of this machine, or on workers of a Dask scheduler.

The result of a run depends on its start alone, so runs may be done anywhere, in any order, and again.
"""

import collections
import contextlib
import os
import sys
import time
from concurrent.futures import FIRST_COMPLETED, CancelledError, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Sequence, TextIO

from aras_visual_servo import ArasError, ParameterError, Scenario, processes
from ..report.drawing import forked
from .judge import COLUMNS
from .metrics import judge_by
from .plan import Start
from .store import FILE, SweepStore
from .worker import make_setup, plain, run_chunk

#: A worker is given this many runs at a time, about half a second of work.
CHUNK = 8
#: If the worker dies this often in a run, the run is stored as an error.
DEATHS = 3
CONNECT_S = 10.0
AHEAD = 2  # chunks that are given out for each process of this machine, so that none waits


class EngineError(ArasError):
    """There is no worker that can do the runs."""


class Progress:
    """Shows runs done, rate and time left on stderr: in one line that is rewritten, or without a terminal in a new line
    every `every_s`. `rows` are those of runs that were done before."""

    def __init__(self, total: int, rows: Sequence[Dict[str, Any]] = (), stream: Optional[TextIO] = None,
                 every_s: float = 10.0, clock: Callable[[], float] = time.monotonic) -> None:
        self.total, self.already = total, len(rows)
        self.done = len(rows)
        self._stream, self._clock = stream or sys.stderr, clock
        self._terminal = self._stream.isatty()
        self._every_s = 0.2 if self._terminal else every_s
        self._counts = collections.Counter(row["outcome"] for row in rows)
        self._began_s = self._shown_s = clock()

    def add(self, rows: List[Dict[str, Any]]) -> None:
        """Count runs that are done."""
        self.done += len(rows)
        self._counts.update(row["outcome"] for row in rows)
        if self._clock() - self._shown_s >= self._every_s or self.done == self.total:
            self._shown_s = self._clock()
            print(("\r" if self._terminal else "") + self.line(), end="" if self._terminal else "\n",
                  file=self._stream, flush=True)

    def line(self) -> str:
        """The line as text."""
        elapsed_s = self._clock() - self._began_s
        rate = (self.done - self.already) / elapsed_s if elapsed_s > 0.0 else 0.0
        left = f"{_duration((self.total - self.done) / rate)} left" if rate > 0.0 else "time left unknown"
        counts = ", ".join(f"{count} {name}" for name, count in self._counts.items())
        return f"{self.done}/{self.total} runs  {rate:.1f} runs/s  {left}  {counts}"

    def end(self) -> None:
        """End the line, so that the next output begins below it."""
        if self._terminal:
            print(file=self._stream, flush=True)


def open_sweep(folder: Path, scenario: Scenario, starts: List[Start], settings: Dict[str, Any], command: str = "",
               versions: Optional[Dict[str, str]] = None) -> SweepStore:
    """`SweepStore` of a folder, open for writing: a new one, or that of a sweep which is gone on with.

    Args: settings: dict for the report, with drive_to_start.  command: that repeats the sweep.
    Raises ParameterError: the sweep there was begun with another scenario or other starts.
    """
    folder.mkdir(parents=True, exist_ok=True)
    setup = make_setup(scenario, settings["drive_to_start"])
    if not (folder / FILE).exists():
        meta = {"setup": setup, "settings": settings, "command": command, "versions": versions or {}}
        return SweepStore.create(folder, meta, starts)
    store = SweepStore.open(folder, writing=True)
    if store.meta["setup"] != setup or list(map(plain, store.starts())) != list(map(plain, starts)):
        store.close()
        raise ParameterError(f"{folder}: found a sweep with another scenario, board or starts; choose "
                             "another name")
    return store


def run_pending(store: SweepStore, setup: Dict[str, Any], workers: Optional[int] = None,
                scheduler: Optional[str] = None, progress: Optional[Progress] = None) -> None:
    """Does every run that is pending and saves it in the store.

    Args: setup: of `worker.make_setup`.  workers: processes on this machine; None: one a core; 0: this process alone.
        scheduler: address of a Dask scheduler, "tcp://host:8786", instead of local workers.
    Raises: EngineError: there is no scheduler or no worker.  ParameterError: the workers refuse the sweep.
        Interrupted: a signal came; the runs that were done are saved.
    """
    pending = store.pending()
    if not pending:
        return
    if progress is None:
        rows = store.rows()
        progress = Progress(len(rows) + len(pending), rows)
    by_id = {start.id: start for start in pending}

    def save(results):
        store.add(results, by_id)
        progress.add([row for row, _ in results])

    try:
        if workers == 0 and scheduler is None:
            for start in pending:
                save(run_chunk(setup, [plain(start)]))
        elif scheduler is None:
            count = min(workers or os.cpu_count() or 1, len(pending))
            chunks = [[plain(start) for start in chunk] for chunk in _chunks(pending, count)]
            run_local(run_chunk, setup, chunks, count, DEATHS, save,
                      lambda start: save([(_killed(by_id[start["id"]]), 0.0)]))
        else:
            _with_dask(setup, pending, scheduler, save)
    finally:
        progress.end()


def _chunks(pending, count):
    """The runs in pieces for that many workers, so small that none has to wait long for the others at the end."""
    size = max(1, min(CHUNK, len(pending) // (4 * count)))
    return [pending[i:i + size] for i in range(0, len(pending), size)]


def run_local(run: Callable[..., Any], setup: Dict[str, Any], chunks: List[List[Dict[str, Any]]], count: int,
              deaths: int, save: Callable[[Any], None], give_up: Callable[[Dict[str, Any]], None]) -> None:
    """Runs all chunks of plain starts in `count` processes; `save` is called with results of run(setup, chunk).

    When a process dies, its run is not known. So the runs that were under way are repeated one at a time. If one
    alone lets a process die `deaths` times, `give_up` is called with its start.
    """
    for start in _run(run, setup, chunks, count, save):
        if all(_run(run, setup, [[start]], 1, save) for _ in range(deaths)):
            give_up(start)


def _run(run, setup, chunks, count, save):
    """Runs the chunks. Returns the starts that were under way when a process died."""
    waiting, suspects = collections.deque(chunks), []
    while waiting:
        with forked(count) as pool, contextlib.suppress(BrokenProcessPool):
            under_way = {}
            try:
                while waiting or under_way:
                    while waiting and len(under_way) < AHEAD * count:
                        under_way[pool.submit(run, setup, waiting[0])] = waiting[0]
                        waiting.popleft()
                    for future in wait(under_way, return_when=FIRST_COMPLETED).done:
                        results = future.result()
                        del under_way[future]
                        save(results)
            except BrokenProcessPool:
                suspects += [start for chunk in under_way.values() for start in chunk]
                raise
    return suspects


def _with_dask(setup, pending, scheduler, save):
    import dask  # only here: these take a second to import
    from distributed import Client
    with processes.temporary_folder("aras-sweep-") as folder, dask.config.set({
            "distributed.scheduler.allowed-failures": DEATHS - 1, "temporary-directory": folder,
            "distributed.comm.timeouts.connect": f"{CONNECT_S:g}s", "distributed.worker.profile.enabled": False}):
        with _client(Client, scheduler) as client:
            if not client.scheduler_info()["workers"]:
                raise EngineError(f"scheduler {scheduler}: found no workers; start one: dask-worker {scheduler}")
            _collect(client, setup, pending, save)


def _client(Client, scheduler):
    try:
        return Client(scheduler, timeout=f"{CONNECT_S:g}s")
    except (OSError, ValueError) as error:  # TimeoutError is an OSError
        raise EngineError(f"scheduler {scheduler}: cannot be reached: {error}") from error
    except TypeError as error:  # Dask's words for it tell of an argument that is None
        raise EngineError(f"scheduler {scheduler}: requires TLS, but no certificate is configured: see "
                          "docs/security.md, Several machines") from error


def _collect(client, setup, pending, save):
    from distributed import as_completed
    from distributed.scheduler import KilledWorker
    chunks = _chunks(pending, max(1, sum(client.nthreads().values())))
    # The scenario is sent with every chunk: its 5 kB are less than the results.
    futures = {_submit(client, setup, chunk): chunk for chunk in chunks}
    suspects = []
    for future in as_completed(list(futures)):
        chunk = futures.pop(future)
        try:
            save(_result(future))
        except KilledWorker:
            suspects += chunk
    # When a worker dies, Dask gives up all chunks it held. Their runs are repeated one at a time to find the fatal one.
    for start in suspects:
        try:
            save(_result(_submit(client, setup, [start])))
        except KilledWorker:
            save([(_killed(start), 0.0)])


def _submit(client, setup, chunk):
    return client.submit(run_chunk, setup, [plain(start) for start in chunk], pure=False)


def _result(future):
    try:
        return future.result()
    except (ImportError, AttributeError) as error:
        raise EngineError(f"a worker cannot run this package: {error}; source the same workspace there") from error
    except CancelledError as error:
        raise EngineError("the scheduler dropped the runs: connection lost") from error


def _killed(start):
    row = dict.fromkeys(COLUMNS)
    row.update(id=start.id, outcome="error", reason="error: worker died", converged=0, **judge_by(None),
               detail=f"the worker process died {DEATHS} times in this run")
    return row


def _duration(seconds):
    minutes, seconds = divmod(int(round(seconds)), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
