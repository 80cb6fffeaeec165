"""Draws the figure of a run in a process of its own. It imports matplotlib, which takes as long as a run, while the run
is computed. Then it is forked: one of both makes the PNG, the other the PDF.

    with Drawing() as drawing:
        record = run(scenario)
        save_results(record, folder, drawing=drawing)
"""

import contextlib
import importlib
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any, Callable, Iterator, List, Sequence, Tuple

from aras_visual_servo import RunRecord, processes

WORKERS = 2  # of `drawn_side_by_side`


class Drawing:
    """A process that waits for a record.

    Args: at_once: import what drawing needs now; False: when `prepare` says so, or when there is a record. A process
        that will have threads makes it before them, since a fork copies only one of them.
    """

    def __init__(self, at_once: bool = True) -> None:
        self._pool = ProcessPoolExecutor(1, get_context("fork"), processes.end_as_child)
        with processes.signals_blocked():
            self._pool.submit(prepare if at_once else int)  # type: ignore[arg-type]

    def prepare(self) -> None:
        """Import what drawing needs, without waiting for it."""
        self._begin(prepare)

    def side_by_side(self, draw: Callable[..., Any], jobs: Sequence[Tuple[Any, ...]]) -> List[Any]:
        """[draw(*job) for job in jobs], as `drawn_side_by_side`."""
        return self._begin(drawn_side_by_side, draw, jobs)()

    def _begin(self, work, *arguments):
        """Begin work(*arguments) in the process. Returns a function that waits for what it returns or raises; where the
        process was killed, the function does the work."""
        try:
            future = self._pool.submit(work, *arguments)
        except BrokenProcessPool:
            return lambda: work(*arguments)

        def wait():
            try:
                return future.result()
            except BrokenProcessPool:
                return work(*arguments)
        return wait

    def __enter__(self) -> "Drawing":
        return self

    def __exit__(self, kind: Any, *_: Any) -> None:
        if kind is not None:
            for process in list(self._pool._processes.values()):  # their results are not wanted
                process.kill()
        self._pool.shutdown()

    def save(self, record: RunRecord, png_path: Path, pdf_path: Path) -> Callable[[], Any]:
        """Begin to draw both files. Returns a function that waits for them; it raises the OSError of one that fails."""
        record = replace(record, images={})  # the figure shows none of them
        return self._begin(_draw_both, record, png_path, pdf_path)


def prepare() -> None:
    """Import what drawing needs.

    matplotlib writes the documentation of a hundred classes when it is imported, in a sixth of that time: nobody reads
    it here. Where it has no such function, it is imported as it is.
    """
    importlib.import_module("matplotlib.artist").kwdoc = lambda artist: ""  # type: ignore[attr-defined]
    for name in (f"{__package__}.figure", "matplotlib.backends.backend_agg", "matplotlib.backends.backend_pdf"):
        importlib.import_module(name)


def _draw_both(record, png_path, pdf_path):
    from .figure import save_figure
    with forked(1) as pool:
        other = pool.submit(save_figure, record, None, pdf_path)
        save_figure(record, png_path, None)
        other.result()


def drawn_side_by_side(draw: Callable[..., Any], jobs: Sequence[Tuple[Any, ...]]) -> List[Any]:
    """[draw(*job) for job in jobs], by processes that are forked here, with everything imported."""
    with forked(WORKERS) as pool:
        return [future.result() for future in [pool.submit(draw, *job) for job in jobs]]


@contextlib.contextmanager
def forked(count: int) -> Iterator[ProcessPoolExecutor]:
    """Yields a pool of forked processes, which are gone when the block ends: at once after an error or a signal."""
    pool = ProcessPoolExecutor(count, get_context("fork"), processes.end_as_child)
    try:
        with processes.signals_blocked():
            pool.submit(int)  # forks all of them
        yield pool
    except BaseException:
        for process in list((pool._processes or {}).values()):  # their results are not wanted
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
