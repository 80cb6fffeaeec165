"""The file of a sweep: who may write it, what it gives back, what is refused."""

import csv
import dataclasses
import io
import pathlib
import shutil
import sqlite3
from types import SimpleNamespace

import pytest
from hypothesis import given, settings, strategies as st

from aras_visual_servo import ArasError, load_scenario
from aras_visual_servo_study.sweep import engine
from aras_visual_servo_study.sweep.judge import COLUMNS
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.store import FILE, StoreError, SweepStore
from aras_visual_servo_study.sweep.worker import files_hash

META = {"setup": {"name": "a"}, "settings": {"seed": 4}, "command": "sweep a"}
STARTS = [Start(1, None, {"x_m": 0.1}, {"noise": 2.0}, "far", {"tilt_rad": 0.1}),
          Start(2, {"J1": 0.5}, {"x_m": 0.2}, {"noise": 3.0}, "", {"tilt_rad": 0.2, "joints": {"J1": 0.0}}),
          Start(3, {"J1": 0.7}, {"x_m": 0.3}, {"noise": 4.0}, "", {"tilt_rad": 0.3, "joints": {"J1": 0.1}})]


def made(folder):
    return SweepStore.create(folder, META, STARTS)


def row(number, **more):
    return {**dict.fromkeys(COLUMNS), "id": number, "outcome": "success", **more}


def test_what_was_planned_is_read_again_by_another_process(tmp_path):
    made(tmp_path).close()
    for place in (tmp_path, tmp_path / FILE):
        with SweepStore.open(place) as store:
            assert store.starts() == STARTS and store.start(2) == STARTS[1]
            assert {key: store.meta[key] for key in META} == META and store.folder == tmp_path
            assert store.extra == ["start_J1", "offset_x_m", "goal_tilt_rad", "p_noise"]


def test_a_run_that_is_done_is_no_longer_pending_and_is_kept_with_its_start(tmp_path):
    by_id = {start.id: start for start in STARTS}
    with made(tmp_path) as store:
        store.add([(row(3, error_mm=0.5), 1.5), (row(1), 0.0)], by_id)
        assert [start.id for start in store.pending()] == [2]
    with SweepStore.open(tmp_path) as store:
        first, third = store.rows()
    assert (first["id"], first["start_J1"], first["offset_x_m"], first["goal_tilt_rad"], first["p_noise"]) == \
        (1, None, 0.1, 0.1, 2.0)
    assert (third["id"], third["start_J1"], third["error_mm"], third["p_noise"]) == (3, 0.7, 0.5, 4.0)


def test_runs_that_come_together_are_saved_all_or_none(tmp_path):
    by_id = {start.id: start for start in STARTS}
    with made(tmp_path) as store:
        store.add([(row(1), 0.0)], by_id)
        with pytest.raises(StoreError, match="cannot be read or written"):
            store.add([(row(2), 0.0), (row(1), 0.0)], by_id)
        assert [one["id"] for one in store.rows()] == [1]


def test_a_number_of_the_table_is_the_one_that_was_saved_to_its_last_digit(tmp_path):
    with made(tmp_path) as store:
        store.add([(row(2, error_mm=0.1 + 0.2, images=7, reason="a, b"), 0.0)], {2: STARTS[1]})
        [found] = csv.DictReader(io.StringIO(store.csv()))
    assert float(found["error_mm"]) == 0.1 + 0.2 and found["error_mm"] == "0.30000000000000004"
    assert (found["images"], found["reason"], found["angle_deg"]) == ("7", "a, b", "")


def test_whoever_leaves_the_file_lets_others_write_it(tmp_path):
    with made(tmp_path):
        with pytest.raises(StoreError, match="another sweep is writing there"):
            SweepStore.open(tmp_path, writing=True)
        SweepStore.open(tmp_path).close()  # reading is allowed
    with SweepStore.open(tmp_path, writing=True) as store:
        assert len(store.pending()) == 3
    SweepStore.open(tmp_path, writing=True).close()


def test_a_folder_holds_one_sweep(tmp_path):
    made(tmp_path).close()
    with pytest.raises(StoreError, match="found a sweep; continue it with --resume"):
        made(tmp_path)


def test_other_files_of_robot_controllers_or_target_have_another_hash(tmp_path):
    scenario = load_scenario("experiment_1")
    for name in ("urdf", "controllers"):
        path = tmp_path / name
        shutil.copy(getattr(scenario, f"{name}_path"), path)
        same, other = (_with_robot(scenario, name, path) for _ in range(2))
        assert files_hash(same) == files_hash(scenario)
        path.write_bytes(path.read_bytes() + b"\n")
        assert files_hash(other) != files_hash(scenario)
    models = [dict(model, file="package://aras_description/targets/l_shape.yaml")
              for model in scenario.sim["scene"]["models"]]
    assert files_hash(scenario.with_overrides({"sim.scene.models": models})) != files_hash(scenario)


def _with_robot(scenario, name, path):
    return dataclasses.replace(scenario, robot=dict(scenario.robot, **{name: str(path)}))


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
