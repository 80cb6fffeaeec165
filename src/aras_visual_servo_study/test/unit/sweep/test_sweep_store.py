"""The file of a sweep: who may write it, what it gives back, and which files its runs need."""
import csv
import dataclasses
import io
import shutil

import pytest

from aras_visual_servo.scenario.scenario import load_scenario
from aras_visual_servo_study.sweep.judge import COLUMNS
from aras_visual_servo_study.sweep.plan import Start
from aras_visual_servo_study.sweep.store import FILE, SweepStore, StoreError
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
    with pytest.raises(StoreError, match="there is a sweep already; go on with --resume"):
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
