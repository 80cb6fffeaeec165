"""Laws side by side on the canonical tasks, and runs side by side on one page."""

import csv
import json
import pathlib
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import psutil
import pytest
import yaml

from aras_visual_servo import ParameterError
from aras_visual_servo.cli import EXIT_PARAMETERS, EXIT_PASSED
from aras_visual_servo.cli.main import main
from aras_visual_servo.spatial import rotation_vector
from aras_visual_servo_study.compare.laws import load_comparison, run_comparison
from aras_visual_servo_study.compare.laws_report import make_figure, part_of
from aras_visual_servo_study.compare.laws_report import arrived, ARRIVED_DEG, ARRIVED_MM, csv_text, verdict
from aras_visual_servo_study.compare.side_by_side import differing, read_run, rows_of
from aras_visual_servo_study.files import share_dir

#: A law that turns on the spot leaves it by what the arm lags behind in the first images [mm].
ON_THE_SPOT_MM = 10.0


def write(folder, **changes):
    document = yaml.safe_load((share_dir() / "config" / "comparisons" / "canonical.yaml").read_text())
    document.update(changes)
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(document, sort_keys=False))
    return path


def test_the_canonical_tasks_are_the_published_ones():
    comparison = load_comparison("canonical")
    moved = {}
    for task in comparison.tasks:
        angle = np.degrees(np.linalg.norm(rotation_vector(task.X_CgC[:3, :3])))
        moved[task.name] = (np.linalg.norm(task.X_CgC[:3, 3]), angle)
    for degrees in (45, 90, 135, 180):
        assert moved[f"turn_{degrees}"] == pytest.approx((0.0, degrees), abs=1e-3)
    assert moved["retreat"] == pytest.approx((0.15, 0.0))
    assert moved["plane"][1] == pytest.approx(20.0, abs=0.1) and moved["plane"][0] > 0.1
    assert all(value > 0.0 for value in moved["general"])


def test_a_law_brings_its_own_features_and_vision():
    comparison = load_comparison("canonical", ["pbvs", "moments", "moments:mean"])
    assert list(comparison.scenarios) == ["pbvs", "moments", "moments:mean"]
    assert comparison.scenarios["pbvs"].servo["features"] == ["tx", "ty", "tz", "rx", "ry", "rz"]
    assert comparison.scenarios["pbvs"].vision["order"] == 3 and comparison.scenarios["moments"].vision["order"] == 4
    assert comparison.scenarios["moments:mean"].servo["interaction"] == "mean"


@pytest.mark.parametrize("changes, words, expected", [
    ({}, {"laws": ["pbsv"]}, "--laws: found pbsv, allowed "),
    ({}, {"tasks": ["turn"]}, "--tasks: found turn, allowed turn_45, turn_90"),
    ({}, {"laws": ["moments:here"]}, "servo.interaction: found here, "),
    ({"tasks": {"a": {"offset": {"x_m": "far"}}}}, {}, "tasks.a.offset.x_m: found far, "),
    ({"tasks": {"a": {"title": "nowhere"}}}, {}, "tasks.a: "),
    ({"tasks": {"a": {"tilt": {"tilt_rad": 0.1}}}}, {}, "tilt with tilt_rad and about_rad"),
    ({"laws": {"a": {"robot": {"urdf": "x"}}}}, {}, "robot: found an unknown key"),
    ({"laws": {"a": {"servo": {"law": "ibvs", "gain": 2}}}}, {}, "law a: "),
    ({"scenery": 1}, {}, "scenery: found an unknown key"),
])
def test_faults_are_named(tmp_path, changes, words, expected):
    with pytest.raises(ParameterError) as caught:
        load_comparison(write(tmp_path, **changes), **words)
    assert expected in str(caught.value)


def test_an_unknown_comparison_lists_the_known_ones():
    with pytest.raises(ParameterError, match="comparison: found .*allowed .*canonical"):
        load_comparison("canonicle")


def test_what_is_published_of_half_a_turn():
    """Pose and 2 1/2-D turn on the spot; image moments with the matrix at each view retreat and do not arrive."""
    comparison = load_comparison("canonical", ["pbvs", "hybrid", "moments"], ["turn_180"])
    rows = {law: (row, track) for _, law, row, track in run_comparison(comparison, 0)}
    for law in ("pbvs", "hybrid"):
        row, track = rows[law]
        assert arrived(row) and verdict(row) == "arrived" and row["farthest_mm"] < ON_THE_SPOT_MM
        assert track.angle_deg[0] > 170.0 and track.angle_deg[-1] < ARRIVED_DEG
    assert not arrived(rows["moments"][0]) and rows["moments"][0]["farthest_mm"] > 10.0 * ON_THE_SPOT_MM


def test_a_joint_the_goal_does_not_name_stays_where_it_starts():
    """The goal of the canonical scenario has the gantry at zero, where it starts: left out, it is the same goal."""
    comparison = load_comparison("canonical", ["pbvs"], ["retreat"], {"servo.time_limit_s": 0.5})
    named = comparison.scenarios["pbvs"]
    joints = {name: q for name, q in named.experiment["goal"]["joints"].items() if name != "gantry"}
    assert named.experiment["goal"]["joints"]["gantry"] == named.sim.get("initial_positions", {}).get("gantry", 0.0)
    unnamed = replace(named, experiment={**named.experiment, "goal": {"joints": joints}})
    rows = [run_comparison(replace(comparison, scenarios={"pbvs": scenario}), 0) for scenario in (named, unnamed)]
    assert csv_text(rows[0]) == csv_text(rows[1])


def test_the_same_bytes_in_another_process_and_order(tmp_path):
    words = dict(tasks=["retreat"], overrides={"servo.time_limit_s": 0.5})
    here = run_comparison(load_comparison("canonical", ["pbvs", "moments"], **words), 0)
    there = run_comparison(load_comparison("canonical", ["moments", "pbvs"], **words), 1)
    assert csv_text(here) == csv_text(there[::-1])
    assert [law for _, law, _, _ in here] == ["pbvs", "moments"]


def test_a_task_that_cannot_be_done_is_refused_not_failed(tmp_path):
    path = write(tmp_path, tasks={"away": {"offset": {"z_m": -2.0}}, "turned": {"offset": {"rx_rad": 1.2}}})
    results = run_comparison(load_comparison(path, ["pbvs"]), 0)
    assert [verdict(row) for _, _, row, _ in results] == ["refused: camera pose out of reach",
                                                          "refused: target not in view at the start"]
    assert all(track is None for *_, track in results)


def test_the_command_writes_table_and_figure(tmp_path, capsys):
    words = ["canonical", "--laws", "pbvs,points", "--tasks", "retreat,general", "--workers", "0"]
    words += ["--output", str(tmp_path)]
    assert main(["compare", "laws", *words, "--name", "one"]) == EXIT_PASSED
    text = capsys.readouterr().out
    assert "retreat, 0.15 m" in text and text.count("arrived") == 4
    folder = tmp_path / "comparisons" / "canonical" / "one"
    with open(folder / "comparison.csv", encoding="utf-8") as stream:
        rows = list(csv.DictReader(stream))
    assert [(row["task"], row["law"]) for row in rows] == [("retreat", "pbvs"), ("retreat", "points"),
                                                           ("general", "pbvs"), ("general", "points")]
    assert all(float(row["error_mm"]) < ARRIVED_MM and float(row["border_px"]) > 0.0 for row in rows)
    page = (folder / "comparison.html").read_text(encoding="utf-8")
    assert "data:image/png;base64," in page and "2 of 2" in page and "http" not in page.replace("http-equiv", "")
    assert (folder / "comparison.pdf").read_bytes().startswith(b"%PDF")


def test_the_same_tasks_on_another_robot(tmp_path, capsys):
    words = ["canonical", "--laws", "pbvs,photometric", "--tasks", "turn_45", "--workers", "0", "--set",
             "servo.time_limit_s=6"]
    words += ["--output", str(tmp_path), "--name", "one", "--scenario"]
    assert main(["compare", "laws", *words, "free_camera"]) == EXIT_PASSED
    assert capsys.readouterr().out.count("arrived") == 2
    folder = tmp_path / "comparisons" / "canonical_free_camera" / "one"
    with open(folder / "comparison.csv", encoding="utf-8") as stream:
        row = next(csv.DictReader(stream))
    assert float(row["farthest_mm"]) < 1.0 and row["joint_room"] == ""  # no lag, and no limits
    assert "--scenario free_camera" in (folder / "comparison.html").read_text(encoding="utf-8")
    assert main(["compare", "laws", *words, "free_kamera"]) == EXIT_PARAMETERS
    assert "free_kamera" in capsys.readouterr().err


def test_bad_words_are_bad_input(tmp_path, capsys):
    assert main(["compare", "laws", "canonical", "--laws", "nobody", "--output", str(tmp_path)]) == EXIT_PARAMETERS
    assert main(["compare", "laws", "canonical", "--workers", "-1", "--output", str(tmp_path)]) == EXIT_PARAMETERS
    assert main(["compare", "runs", "experiment_1", "--output", str(tmp_path)]) == EXIT_PARAMETERS
    assert "found 1 run, allowed two or more" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_runs_side_by_side(tmp_path, capsys):
    runs = ["experiment_1", "experiment_1_paper"]
    assert main(["compare", "runs", *runs, "--output", str(tmp_path), "--name", "a"]) == 0
    page = (tmp_path / "comparisons" / "runs" / "a" / "runs.html").read_text(encoding="utf-8")
    assert "experiment_1_paper" in page and "servo.law" in page and "data:image/png;base64," in page
    assert "joint room" in capsys.readouterr().out


def test_what_two_runs_differ_in():
    runs = [read_run("experiment_1"), read_run("experiment_1_paper")]
    found = dict(differing(runs))
    assert found["servo.law"] == ["decoupled", "paper"] and "robot.urdf" not in found
    rows = [rows_of(run) for run in runs]
    assert all(row["success"] == 1 and 0.0 < row["joint_room"] < 1.0 and row["border_px"] > 0.0 for row in rows)


def test_a_figure_that_is_read_at_a_glance_has_only_the_laws_and_tasks_asked_for():
    comparison = load_comparison("canonical", ("pbvs", "hybrid", "points"), ("turn_45", "retreat"))
    results = [(task.name, law, {}, None) for task in comparison.tasks for law in comparison.scenarios]
    chosen, found = part_of(comparison, results, ("hybrid", "pbvs"), ("retreat",))
    assert [(task, law) for task, law, _, _ in found] == [("retreat", "pbvs"), ("retreat", "hybrid")]
    figure = make_figure(chosen, found, width_in=8.8, row_in=2.0)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["hybrid", "pbvs"] and len(figure.axes) == 4
    assert figure.get_figwidth() == 8.8


PROGRAM = pathlib.Path(__file__).resolve().parents[4] / "aras_visual_servo" / "scripts" / "aras-servo"
PATIENCE_S = 120.0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL], ids=lambda number: number.name)
def test_a_signal_ends_a_comparison_and_its_workers(number, tmp_path):
    process = subprocess.Popen([sys.executable, str(PROGRAM), "compare", "laws", "--workers", "2", "--output",
                                str(tmp_path)], stderr=subprocess.PIPE, text=True)
    end_s, workers = time.monotonic() + PATIENCE_S, []
    while sum(worker.cpu_times().user > 1.0 for worker in workers) < 2:  # at work
        assert time.monotonic() < end_s and process.poll() is None
        time.sleep(0.1)
        workers = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == (-number if number == signal.SIGKILL else 128 + number) and "Traceback" not in said
    assert not psutil.wait_procs(workers, timeout=PATIENCE_S)[1]


def test_result_folders_of_runs_in_this_process_are_compared_as_they_were(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "experiment_1", "--set", "servo.gains_per_s.xn=2.0"]) == 0
    [folder] = (tmp_path / "results" / "experiment_1").iterdir()
    run = read_run(str(folder))
    summary = json.loads((folder / "summary.json").read_text())
    assert run.record.run_hash == summary["run_hash"] and folder.name in run.label
    assert main(["compare", "runs", str(folder), "experiment_1", "--name", "b"]) == 0
    said = capsys.readouterr().out
    assert "decay xn [1/s]" in said and "differs: servo.gains_per_s" in said
    assert main(["compare", "runs", str(folder), "experiment_1", "--set", "sim.seed=3"]) == EXIT_PARAMETERS
