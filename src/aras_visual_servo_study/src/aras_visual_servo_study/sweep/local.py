"""Does runs in processes of this machine. They are forked, so that they begin at once with everything imported."""

import collections
import contextlib
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import Any, Callable, Dict, List

from aras_visual_servo import processes

AHEAD = 2  # chunks that are given out for each process, so that none waits


def run_local(run: Callable[..., Any], setup: Dict[str, Any], chunks: List[List[Dict[str, Any]]], count: int,
              deaths: int, save: Callable[[Any], None], give_up: Callable[[Dict[str, Any]], None]) -> None:
    """Run all chunks; results are saved as they come in.

    When a process dies, nobody knows in which run. So the runs that were under way are repeated one at a time.
    Args:
        run: function of (setup, chunk) that returns results.  chunks: list of lists of plain starts.
        count: processes.  save: called with the results of a chunk.
        deaths: a run in which a process has died that often alone is given up: give_up is called with its start.
    """
    for start in _run(run, setup, chunks, count, save):
        if all(_run(run, setup, [[start]], 1, save) for _ in range(deaths)):
            give_up(start)


def _run(run, setup, chunks, count, save):
    """Runs the chunks. Returns the starts that were under way when a process died."""
    waiting, suspects = collections.deque(chunks), []
    while waiting:
        with _pool(count) as pool, contextlib.suppress(BrokenProcessPool):
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


@contextlib.contextmanager
def _pool(count):
    """Processes that are gone when the block ends, at once if it ends with an error or a signal."""
    pool = ProcessPoolExecutor(count, get_context("fork"), processes.end_as_child)
    try:
        with processes.signals_blocked():
            pool.submit(int)  # forks all of them
        yield pool
    except BaseException:
        for process in list((pool._processes or {}).values()):  # nobody waits for what they are doing
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)
