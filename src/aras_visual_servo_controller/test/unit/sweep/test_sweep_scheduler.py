"""Runs on the workers of a Dask scheduler: the rows of this process, and clear words where there is nobody to do them."""
import sys
import time
from types import SimpleNamespace

import pytest

from aras_visual_servo_controller.scenario.scenario import load_scenario
from aras_visual_servo_controller.sweep import engine
from aras_visual_servo_controller.sweep.plan import Start
from aras_visual_servo_controller.sweep.store import SweepStore
from aras_visual_servo_controller.sweep.worker import make_setup, run_chunk

distributed = pytest.importorskip("distributed")
RUNS = 9  # two chunks of them for one worker: one run in four is done at a time
HERE = {"gantry": -0.02, "J1": 0.0, "J2": 0.1, "J3": -0.05, "J5": 0.045, "J6": 0.1}


def cluster(workers):
    """A scheduler and threads of this process as its workers."""
    ours = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
    return distributed.SpecCluster(
        {number: {"cls": distributed.Worker, "options": {**ours, "nthreads": 1}} for number in range(workers)},
        {"cls": distributed.Scheduler, "options": {**ours, "port": 0}})


@pytest.fixture(scope="module")
def address():
    with cluster(1) as found:
        yield found.scheduler_address


@pytest.fixture(scope="module")
def setup():
    return make_setup(load_scenario("experiment_1", {"servo.time_limit_s": 0.1}), False)


def rows_done(folder, setup, **where):
    """Rows of a sweep of RUNS starts, the odd ones refused."""
    starts = [Start(k, None, refusal="far: away") if k % 2 else Start(k, HERE) for k in range(1, RUNS + 1)]
    folder.mkdir()
    with SweepStore.create(folder, {"setup": setup, "settings": {}}, starts) as store:
        engine.run_pending(store, setup, **where)
        return store.rows()


def test_a_scheduler_gives_the_rows_of_this_process(address, setup, tmp_path):
    rows = rows_done(tmp_path / "there", setup, scheduler=address)
    assert rows == rows_done(tmp_path / "here", setup, workers=0)
    assert [row["id"] for row in rows] == list(range(1, RUNS + 1)) and rows[1]["run_hash"]


def test_no_workers_are_forked_where_there_is_a_scheduler(address, setup, tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "run_local", None)
    assert len(rows_done(tmp_path / "there", setup, scheduler=address, workers=0)) == RUNS


def test_only_the_run_that_kills_workers_is_given_up(address, setup, tmp_path, monkeypatch):
    def deadly(setup, starts):
        if any(start["id"] == 3 for start in starts):  # what Dask says of a chunk whose workers died
            raise distributed.scheduler.KilledWorker("run", SimpleNamespace(address="there"), engine.DEATHS)
        return run_chunk(setup, starts)

    monkeypatch.setattr(engine, "run_chunk", deadly)
    rows = rows_done(tmp_path / "there", setup, scheduler=address)
    assert [row["reason"] for row in rows if row["outcome"] == "error"] == ["error: worker died"]
    assert rows[2]["outcome"] == "error" and rows[2]["detail"] == "the worker process died 3 times in this run"
    assert rows[2]["success"] == rows[2]["converged"] == 0


@pytest.mark.parametrize("error, words", [
    (ImportError("no module"), "a worker cannot run this package: no module; source the same workspace there"),
    (AttributeError("no such name"), "a worker cannot run this package: no such name; source the same workspace there"),
    (engine.CancelledError("gone"), "the scheduler dropped the runs: connection lost")])
def test_workers_that_cannot_do_the_runs_are_told_in_one_sentence(address, setup, tmp_path, monkeypatch, error, words):
    def broken(*_):
        raise error
    monkeypatch.setattr(engine, "run_chunk", broken)
    with pytest.raises(engine.EngineError) as caught:
        rows_done(tmp_path / "there", setup, scheduler=address)
    assert str(caught.value) == words


def test_a_scheduler_without_workers_is_told_at_once(setup, tmp_path):
    with cluster(0) as empty, pytest.raises(engine.EngineError, match="it has no workers; start some: dask-worker tcp"):
        rows_done(tmp_path / "there", setup, scheduler=empty.scheduler_address)


@pytest.mark.parametrize("count, workers, sizes", [
    (1, 1, [1]), (9, 1, [2, 2, 2, 2, 1]), (64, 2, [8] * 8), (63, 2, [7] * 9), (1000, 1, [8] * 125), (4, 8, [1] * 4)])
def test_every_worker_is_given_four_pieces_at_least_and_none_has_more_than_eight_runs(count, workers, sizes):
    pieces = engine._chunks(list(range(count)), workers)
    assert [len(piece) for piece in pieces] == sizes and sum(pieces, []) == list(range(count))


@pytest.mark.parametrize("seconds, text", [
    (0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (125.0, "2 min 5 s"), (3599.4, "59 min 59 s"),
    (3600.0, "1 h 0 min"), (3725.0, "1 h 2 min"), (90000.0, "25 h 0 min")])
def test_a_time_left_has_two_units_at_most(seconds, text):
    assert engine._duration(seconds) == text


class Screen:
    """A stream. Args: terminal: whether it says that it is one."""

    def __init__(self, terminal):
        self.text, self.isatty = "", lambda: terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def progress_of(terminal, seconds, every_s=10.0, total=4, done=()):
    """What is shown when a run comes in at each of these times."""
    now, screen = [0.0], Screen(terminal)
    progress = engine.Progress(total, done, screen, every_s, lambda: now[0])
    for now[0] in seconds:
        progress.add([{"outcome": "success"}])
    progress.end()
    return screen.text


def test_a_terminal_has_one_line_that_is_written_again():
    text = progress_of(True, [0.19, 0.2, 0.3, 0.39])
    assert text.startswith("\r2/4 runs") and text.count("\r") == 2 and text.endswith("4 success\n")
    assert text.count("\n") == 1


def test_a_file_has_a_new_line_from_time_to_time_and_one_at_the_end():
    lines = progress_of(False, [9.9, 10.0, 19.9, 19.95]).splitlines()
    assert [line.split("  ")[0] for line in lines] == ["2/4 runs", "4/4 runs"]
    assert progress_of(False, [9.9, 10.0, 19.9], total=5).count("\n") == 1


def test_a_rate_is_of_this_process_and_without_one_the_time_left_is_not_known():
    before = [{"outcome": "failure"}] * 2
    assert progress_of(False, [0.0], 0.0, 4, before) == "3/4 runs  0.0 runs/s  time left unknown  2 failure, 1 success\n"
    assert progress_of(False, [2.0], 0.0, 4, before) == "3/4 runs  0.5 runs/s  2 s left  2 failure, 1 success\n"


def test_progress_is_shown_on_stderr_when_nobody_says_where(setup, tmp_path, capsys):
    rows_done(tmp_path / "here", dict(setup), workers=0)
    assert capsys.readouterr().err.splitlines()[-1].startswith(f"{RUNS}/{RUNS} runs  ")
    assert engine.Progress(1)._stream is sys.stderr and engine.Progress(1)._clock is time.monotonic
