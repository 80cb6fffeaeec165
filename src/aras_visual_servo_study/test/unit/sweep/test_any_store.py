"""Whatever somebody wrote into the file of a sweep, it is read or refused with the name of the file."""
import pathlib
import shutil
import sqlite3
from types import SimpleNamespace

import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo.ground.errors import ArasError
from aras_visual_servo_study.sweep import engine
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.store import FILE, SweepStore

CELLS = [(table, column) for table, columns in {"meta": ("key", "value"), "timing": ("wall_s", "done_at"),
                                                "starts": ("joints", "offset", "parameters", "refusal", "goal")}.items()
         for column in columns]
VALUES = (st.none() | st.integers(-2**63, 2**63 - 1) | st.floats() | st.text(max_size=9) | st.binary(max_size=9)
          | st.sampled_from(["[", "{}", "[]", "null", "1e999", "NaN", "9" * 5000, '"a"', '{"a": []}']))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Of a sweep with two planned runs."""
    folder = tmp_path_factory.mktemp("sweep")
    starts = [Start(k, {"a": 0.5}, {"x": 0.1}, {"noise": 2.0}, "", {"tilt_rad": 0.1}) for k in (1, 2)]
    SweepStore.create(folder, {"setup": {}, "settings": {}}, starts).close()
    return folder


def read(path):
    try:
        with SweepStore.open(path) as store:
            assert isinstance(store.starts(), list) and isinstance(store.rows(), list)
            assert store.csv() and isinstance(store.pending(), list)
    except ArasError as error:
        assert pathlib.Path(path).name in str(error)


def damaged(folder):
    copy = folder / "damaged"
    shutil.rmtree(copy, ignore_errors=True)
    copy.mkdir()
    shutil.copy(folder / FILE, copy)
    return copy


def test_lists_within_lists_in_a_cell_are_refused(folder):
    for table, column in CELLS:
        copy = damaged(folder)
        with sqlite3.connect(copy / FILE) as connection:
            connection.execute(f"UPDATE OR IGNORE {table} SET {column} = ?", ("[" * 9000,))
        connection.close()
        read(copy)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.sampled_from(CELLS), VALUES)
def test_any_value_in_any_cell_is_read_or_refused(folder, cell, value):
    copy = damaged(folder)
    with sqlite3.connect(copy / FILE) as connection:
        connection.execute(f"UPDATE OR IGNORE {cell[0]} SET {cell[1]} = ?", (value,))
    connection.close()
    read(copy)


@settings(deadline=None, max_examples=200, derandomize=True)
@given(st.lists(st.tuples(st.integers(0, 40000), st.binary(min_size=1, max_size=8)), min_size=1, max_size=5))
def test_any_bytes_in_the_file_are_read_or_refused(folder, edits):
    copy = damaged(folder)
    data = bytearray((copy / FILE).read_bytes())
    for at, new in edits:
        at %= len(data)
        data[at:at + len(new)] = new
    (copy / FILE).write_bytes(data)
    read(copy)


@pytest.mark.parametrize("workers, runs, started", [(4, 2, 2), (2, 5, 2), (1, 5, 1)])
def test_no_more_workers_are_started_than_there_are_runs(tmp_path, monkeypatch, workers, runs, started):
    counts = []
    monkeypatch.setattr(engine, "run_local", lambda work, setup, chunks, count, *_: counts.append((count, chunks)))
    starts = [Start(k, {"a": 0.5}) for k in range(1, runs + 1)]
    with SweepStore.create(tmp_path, {"setup": {}, "settings": {}}, starts) as store:
        engine.run_pending(store, {}, workers, progress=SimpleNamespace(add=None, end=lambda: None))
    [(count, chunks)] = counts
    assert count == started and [start["id"] for chunk in chunks for start in chunk] == list(range(1, runs + 1))
