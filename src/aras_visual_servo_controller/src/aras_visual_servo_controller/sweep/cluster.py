"""Dask on the cores of this machine, listening on the loopback only and with no web pages.

Everybody who can reach a scheduler can run code with it. Dask 2022.12 serves web pages on all interfaces whatever
`host` says, on one port for the scheduler and one for each worker; `dashboard_address=None` only removes the pictures
on them.
"""

import contextlib
import os
import signal
from multiprocessing import resource_tracker

from distributed import Nanny, Scheduler, SpecCluster, Worker

from ..ground.processes import signals_held, signals_let_through

HOST = "127.0.0.1"
CLOSE_S = 5.0   # wall time that workers get to end
#: What a terminal sends to every process it holds.
TERMINAL = {signal.SIGHUP, signal.SIGINT, signal.SIGQUIT}


class _Pageless:
    """A Dask server that opens no port for HTTP."""

    def start_http_server(self, *_, **__):
        """Start no server; a sweep shows its progress as a line of text instead."""


class PagelessScheduler(_Pageless, Scheduler):
    """Listens for workers and clients alone."""


class PagelessWorker(_Pageless, Worker):
    """Listens for its scheduler and other workers alone."""


@contextlib.contextmanager
def local_cluster(workers, folder):
    """A cluster of this machine that is gone afterwards.

    Args:
        workers: processes.  folder: for what Dask writes.
    """
    nanny = {"host": HOST, "nthreads": 1, "memory_limit": 0, "local_directory": str(folder), "silence_logs": 50,
             "worker_class": PagelessWorker, "dashboard": False}
    with signals_held():
        with _terminal_held():
            cluster = SpecCluster(scheduler={"cls": PagelessScheduler, "options": {"host": HOST, "dashboard": False}},
                                  workers={name: {"cls": Nanny, "options": nanny} for name in range(workers)},
                                  silence_logs=50)
        try:
            with signals_let_through():
                yield cluster
        except BaseException:  # the results that the workers are still computing are not needed any more
            _kill(cluster)
            raise
        finally:
            with contextlib.suppress(TimeoutError):
                cluster.close(timeout=CLOSE_S)


def _kill(cluster):
    for nanny in cluster.workers.values():
        nanny.auto_restart = False
        if nanny.pid is not None:
            with contextlib.suppress(ProcessLookupError):
                os.kill(nanny.pid, signal.SIGKILL)


@contextlib.contextmanager
def _terminal_held():
    """Processes spawned inside, or later by threads started inside, never see Ctrl-C: this process ends them.

    A terminal sends it to all of them, and each worker would print a traceback. The mask is inherited by threads and
    processes; starting the resource tracker lifts it, so that comes first.
    """
    resource_tracker.ensure_running()
    signal.pthread_sigmask(signal.SIG_BLOCK, TERMINAL)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, TERMINAL)
