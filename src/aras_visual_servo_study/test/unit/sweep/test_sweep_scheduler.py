"""Runs on the workers of a Dask scheduler: the rows of this process, and clear words where nobody can do them."""
from types import SimpleNamespace

import pytest

from aras_visual_servo.scenario.scenario import load_scenario
from aras_visual_servo_study.sweep import engine
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.store import SweepStore
from aras_visual_servo_study.sweep.worker import make_setup, run_chunk

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
    with cluster(0) as empty, pytest.raises(engine.EngineError, match="found no workers; start one: dask-worker tcp"):
        rows_done(tmp_path / "there", setup, scheduler=empty.scheduler_address)
