"""The commands `sweep`, `rerun`, `compare` as a user types them: resume, interruption, a killed worker, bad input."""

import contextlib
import html
import os
import pathlib
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import time

import psutil
import pytest

from aras_visual_servo.cli.main import main
from aras_visual_servo.processes import Interrupted
from aras_visual_servo_study.sweep import engine as sweep_engine, worker as sweep_worker
from aras_visual_servo_study.sweep.store import SweepStore

PROGRAM = pathlib.Path(__file__).resolve().parents[4] / "aras_visual_servo" / "scripts" / "aras-servo"
STARTS = 40
#: Wall time for what takes some seconds on a busy machine [s].
PATIENCE_S = 120.0
# Short runs: the servo is cut off, which is all the same to the engine.
QUICK = ["experiment_1", "--seed", "4", "--set", "servo.time_limit_s=0.5"]


def sweep(output, name, *words, starts=STARTS):
    return main(["sweep", *QUICK, "--starts", str(starts), "--output", str(output), "--name", name, *words])


def folder_of(output, name):
    return output / "sweeps" / "experiment_1" / name


def start_process(output, name, *words):
    command = [sys.executable, str(PROGRAM), "sweep", *QUICK, "--starts", str(STARTS), "--output", str(output),
               "--name", name, *words]
    (output / "tmp").mkdir()
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
                            env=dict(os.environ, TMPDIR=str(output / "tmp")))


def wait_for_rows(process, path, count):
    """Number of saved runs, once there are `count`."""
    end_s = time.monotonic() + PATIENCE_S
    while time.monotonic() < end_s:
        assert process.poll() is None, process.communicate()[1]
        try:
            with sqlite3.connect(f"file:{path}?mode=ro", uri=True) as connection:
                found = connection.execute("SELECT count(*) FROM runs").fetchone()[0]
            if found >= count:
                return found
        except sqlite3.OperationalError:
            pass  # not there yet
        time.sleep(0.01)
    raise AssertionError("no runs were saved in time")


def rows_of(folder):
    with SweepStore.open(folder) as store:
        return store.rows()


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    output = tmp_path_factory.mktemp("undisturbed")
    assert sweep(output, "whole", "--workers", "0") == 0
    return folder_of(output, "whole")


def test_a_sweep_leaves_rows_tables_figures_and_a_page(undisturbed):
    assert {"sweep.db", "runs.csv", "sweep.html", "map.png", "map.pdf", "curve.png", "curve.pdf", "reasons.png",
            "reasons.pdf"} <= {path.name for path in undisturbed.iterdir()}
    rows = rows_of(undisturbed)
    assert [row["id"] for row in rows] == list(range(1, STARTS + 1))
    assert (undisturbed / "runs.csv").read_text().count("\n") == STARTS + 1
    page = (undisturbed / "sweep.html").read_text()
    assert "src=\"http" not in page and "data:image/png;base64" in page
    assert {row["outcome"] for row in rows} <= {"success", "failure", "infeasible"}


def test_an_interrupted_sweep_goes_on_and_repeats_nothing(undisturbed, tmp_path, monkeypatch, capsys):
    run_chunk, calls = sweep_worker.run_chunk, []

    def interrupted(setup, starts):
        if len(calls) == 5:
            raise Interrupted(signal.SIGINT)
        calls.extend(start["id"] for start in starts)
        return run_chunk(setup, starts)
    monkeypatch.setattr(sweep_engine, "run_chunk", interrupted)
    assert sweep(tmp_path, "cut", "--workers", "0") == 130
    assert "35 runs are left" in capsys.readouterr().err
    assert len(rows_of(folder_of(tmp_path, "cut"))) == 5

    def counted(setup, starts):
        calls.extend(start["id"] for start in starts)
        return run_chunk(setup, starts)
    monkeypatch.setattr(sweep_engine, "run_chunk", counted)
    assert sweep(tmp_path, "cut", "--workers", "0", "--resume") == 0
    assert sorted(calls) == list(range(1, STARTS + 1))
    assert rows_of(folder_of(tmp_path, "cut")) == rows_of(undisturbed)


def test_control_c_keeps_what_is_done_and_ends_the_workers(undisturbed, tmp_path):
    process = start_process(tmp_path, "cut", "--workers", "2")
    folder = folder_of(tmp_path, "cut")
    saved = wait_for_rows(process, folder / "sweep.db", 1)
    children = psutil.Process(process.pid).children(recursive=True)
    os.killpg(process.pid, signal.SIGINT)  # what a terminal does
    _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, said
    assert "aras-servo sweep --resume" in said and "Traceback" not in said
    assert not psutil.wait_procs(children, timeout=PATIENCE_S)[1]
    kept = rows_of(folder)
    assert saved <= len(kept) < STARTS
    assert main(["sweep", "--resume", str(folder), "--workers", "0"]) == 0
    assert rows_of(folder) == rows_of(undisturbed)


def listening(process):
    """{(address, port)} of every socket that a process and its descendants listen on."""
    found = set()
    for one in [process, *process.children(recursive=True)]:
        try:
            found |= {tuple(link.laddr) for link in one.connections("inet") if link.status == psutil.CONN_LISTEN}
        except psutil.NoSuchProcess:
            pass
    return found


def test_a_sweep_without_a_scheduler_listens_nowhere(tmp_path):
    process = start_process(tmp_path, "listening", "--workers", "2")
    wait_for_rows(process, folder_of(tmp_path, "listening") / "sweep.db", 1)
    sockets = listening(psutil.Process(process.pid))
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=PATIENCE_S)
    assert not sockets


@pytest.mark.usefixtures("hang_up_is_heard")
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGKILL],
                         ids=lambda number: number.name)
def test_a_signal_ends_a_sweep_and_all_it_started(tmp_path, number):
    process = start_process(tmp_path, "signalled", "--workers", "2")
    wait_for_rows(process, folder_of(tmp_path, "signalled") / "sweep.db", 1)
    children = psutil.Process(process.pid).children(recursive=True)
    process.send_signal(number)
    process.communicate(timeout=PATIENCE_S)
    assert not psutil.wait_procs(children, timeout=PATIENCE_S)[1]
    if number != signal.SIGKILL:
        assert process.returncode == 128 + number and not list((tmp_path / "tmp").iterdir())


@pytest.mark.parametrize("which", (0, -1), ids=("who draws", "a worker"))
def test_a_killed_process_loses_nothing(undisturbed, tmp_path, which):
    process = start_process(tmp_path, "killed", "--workers", "2")
    folder = folder_of(tmp_path, "killed")
    assert wait_for_rows(process, folder / "sweep.db", 1) < STARTS
    children = sorted(psutil.Process(process.pid).children(), key=lambda child: (child.create_time(), child.pid))
    assert len(children) == 3
    os.kill(children[which].pid, signal.SIGKILL)
    _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, said
    assert rows_of(folder) == rows_of(undisturbed)
    assert (folder / "runs.csv").read_bytes() == (undisturbed / "runs.csv").read_bytes()


def test_a_rerun_gives_the_same_bytes_and_a_whole_result_folder(undisturbed, tmp_path, capsys):
    feasible = next(row for row in rows_of(undisturbed) if row["run_hash"])
    assert main(["rerun", str(feasible["id"]), "--sweep", str(undisturbed), "--output", str(tmp_path)]) == 0
    assert f"same bytes as in the sweep, trace {feasible['trace_hash']}" in capsys.readouterr().out
    assert (tmp_path / "report.html").is_file() and (tmp_path / "trace.csv").is_file()


def test_a_rerun_that_differs_says_so(undisturbed, tmp_path, capsys):
    feasible = next(row for row in rows_of(undisturbed) if row["run_hash"])
    copy = tmp_path / "copy"
    copy.mkdir()
    with sqlite3.connect(str(undisturbed / "sweep.db")) as source, sqlite3.connect(str(copy / "sweep.db")) as target:
        source.backup(target)
        target.execute("UPDATE runs SET run_hash = 'other' WHERE id = ?", (feasible["id"],))
    assert main(["rerun", str(feasible["id"]), "--sweep", str(copy)]) == 1
    assert "other values than in the sweep: run_hash" in capsys.readouterr().out


def test_a_gate_decides_the_exit_code(undisturbed, tmp_path, capsys):
    words = ["--output", str(tmp_path)]
    assert main(["compare", "sweeps", str(undisturbed), str(undisturbed), "--fail-if", "mcnemar_p < 0.05", *words]) == 0
    said = capsys.readouterr().out
    assert "gate ok: mcnemar_p < 0.05 does not hold (mcnemar_p = 1)" in said
    assert "A alone succeeds on 0 and B alone on 0: no clear difference (McNemar, p = 1)." in said
    assert main(["compare", "sweeps", str(undisturbed), "--fail-if", "success < 0.98", *words]) == 1
    assert re.search(r"^gate FAILED: success < 0.98 holds \(success = 0", capsys.readouterr().out, re.MULTILINE)
    assert main(["compare", "sweeps", str(undisturbed), "--fail-if", "sucess < 0.98"]) == 2
    assert "found sucess, allowed runs" in capsys.readouterr().err


def test_a_gate_on_a_sweep_that_is_not_complete_fails(undisturbed, tmp_path, capsys):
    cut = tmp_path / "cut"
    shutil.copytree(undisturbed, cut)
    with contextlib.closing(sqlite3.connect(str(cut / "sweep.db"))) as connection, connection:
        connection.execute("DELETE FROM runs WHERE id > 38")
    words = ["compare", "sweeps", str(undisturbed), str(cut), "--output", str(tmp_path), "--name"]
    assert main([*words, "gated", "--fail-if", "mcnemar_p < 0.05"]) == 1
    told = f"{cut}: 2 of {STARTS} runs are missing; aras-servo sweep --resume {cut} completes them"
    said = capsys.readouterr().out
    assert f"gate FAILED: {told}" in said and "gate ok: mcnemar_p" in said and f"{undisturbed}: " not in said
    assert f"Gate failed: {told}" in (tmp_path / "comparisons" / "sweeps" / "gated" / "compare.html").read_text()
    assert main([*words, "free"]) == 0
    assert f"note: {told}" in capsys.readouterr().err


@pytest.mark.parametrize("words, code, message", [
    (["nosuch"], 2, "scenario: found nosuch, "),
    (["experiment_1", "--starts", "0"], 2, "sweep.starts: found 0, allowed a whole number >= 1"),
    (["experiment_1", "--method", "sobol"], 2, "sweep.method: found sobol"),
    (["experiment_1", "--space", "image"], 2, "sweep.space: found image, "),
    (["experiment_1", "--workers", "-1"], 2, "--workers: found -1"),
    (["experiment_1", "--set", "servo.law=none"], 2, "law"),
    (["experiment_1", "--axes", "x0_mm", "colour"], 2, "--axes: found colour, allowed x0_mm"),
    (["experiment_1", "--resume"], 3, "found no sweep in this folder"),
    (["--resume", "nowhere"], 3, "nowhere: found no sweep in this folder"),
    (["experiment_1", "--scheduler", "tcp://127.0.0.1:9"], 3, "cannot be reached"),
])
def test_bad_input_is_told_clearly(words, code, message, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(sweep_engine, "CONNECT_S", 0.5)
    few = [] if "--starts" in words or words[0] == "--resume" or "--resume" in words else ["--starts", "2"]
    local = [] if "--workers" in words or "--scheduler" in words else ["--workers", "0"]
    assert main(["sweep", *words, *few, *local, "--output", str(tmp_path)]) == code
    assert message in capsys.readouterr().err


def test_axes_are_checked_before_the_folder_is_made(undisturbed, tmp_path, capsys):
    assert sweep(tmp_path, "mine", "--workers", "0", "--axes", "x0_mm", "strat_J2", starts=2) == 2
    said = capsys.readouterr().err
    assert "start_J6" in said and "did you mean start_J2?" in said and not list(tmp_path.iterdir())
    # A perturbation whose values are texts cannot be an axis, which only the planned starts tell.
    assert sweep(tmp_path, "mine", "--workers", "0", "--axes", "x0_mm", "p_servo.law", "--set",
                 "sweep.perturb={servo.law: {values: [ibvs, paper]}}", starts=2) == 2
    assert "--axes: found p_servo.law, allowed" in capsys.readouterr().err and not list(tmp_path.iterdir())
    assert main(["sweep", "--resume", str(undisturbed), "--workers", "0", "--axes", "colour", "x0_mm"]) == 2
    assert "--axes: found colour, allowed x0_mm" in capsys.readouterr().err


def test_the_page_repeats_the_axes_that_its_maps_had_last(tmp_path):
    assert sweep(tmp_path, "mine", "--workers", "0", "--axes", "x0_mm", "z0_mm", starts=2) == 0
    folder = folder_of(tmp_path, "mine")

    def axes():
        page = html.unescape((folder / "sweep.html").read_text())
        data = re.search(r'"x":"(\w+)","y":"(\w+)"', page)
        command = re.search(r"<pre><code>(aras-servo sweep .*?)</code>", page)[1]
        return data[1], data[2], command.partition("--axes ")[2].split()[:2], command.count("--axes")

    assert axes() == ("x0_mm", "z0_mm", ["x0_mm", "z0_mm"], 1)
    for words in (["--axes", "start_J1", "angle0_deg"], []):
        assert main(["sweep", "--resume", str(folder), "--workers", "0", *words]) == 0
        assert axes() == ("start_J1", "angle0_deg", ["start_J1", "angle0_deg"], 1)


def test_a_resume_must_ask_for_the_same_sweep(undisturbed, capsys):
    words = ["--output", str(undisturbed.parents[2]), "--name", "whole", "--resume", "--workers", "0"]
    assert main(["sweep", *QUICK, "--starts", "41", *words]) == 2
    assert f"starts: found 41, the sweep was started with {STARTS}" in capsys.readouterr().err
    assert main(["sweep", "experiment_1", "--seed", "4", "--starts", str(STARTS), *words]) == 2
    assert "have changed since the sweep started" in capsys.readouterr().err


def test_a_resume_without_options_takes_those_it_was_begun_with(undisturbed, capsys):
    words = ["--output", str(undisturbed.parents[2]), "--name", "whole", "--resume", "--workers", "0"]
    assert main(["sweep", *QUICK, *words]) == 0
    assert f"{STARTS} runs" in capsys.readouterr().out


@pytest.mark.parametrize("statement", [
    "UPDATE meta SET value = '{' WHERE key = 'setup'", "UPDATE meta SET value = '[1]' WHERE key = 'setup'",
    "DELETE FROM meta WHERE key = 'columns'", "UPDATE starts SET joints = 'nonsense' WHERE id = 3",
    "UPDATE starts SET goal = NULL WHERE id = 3",
])
def test_a_file_with_broken_values_is_told_in_one_sentence(undisturbed, tmp_path, statement, capsys):
    shutil.copytree(undisturbed, tmp_path / "broken")
    with contextlib.closing(sqlite3.connect(str(tmp_path / "broken" / "sweep.db"))) as connection, connection:
        connection.execute(statement)
    assert main(["sweep", "--resume", str(tmp_path / "broken"), "--workers", "0"]) == 3
    said = capsys.readouterr().err
    assert "broken" in said and "Traceback" not in said


def test_a_name_that_leaves_the_folder_of_sweeps_is_refused(tmp_path, capsys):
    assert sweep(tmp_path, "..", "--workers", "0") == 2
    assert "--name: found '..', allowed" in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_second_writer_is_refused(undisturbed, capsys):
    with SweepStore.open(undisturbed, writing=True):
        assert main(["sweep", "--resume", str(undisturbed), "--workers", "0"]) == 3
    assert "another sweep is writing there" in capsys.readouterr().err


def test_a_name_that_is_taken_is_refused(undisturbed, capsys):
    assert sweep(undisturbed.parents[2], "whole", "--workers", "0") == 3
    assert "found a sweep of this name" in capsys.readouterr().err


def test_runs_outside_the_sweep_are_refused(undisturbed, capsys):
    assert main(["rerun", "99", "--sweep", str(undisturbed)]) == 3
    assert "no run 99, there are 1 to 40" in capsys.readouterr().err


def deadly_chunk(setup, starts):
    """run_chunk on a machine where run 3 takes its process down."""
    if any(start["id"] == 3 for start in starts):
        os.kill(os.getpid(), signal.SIGKILL)
    return sweep_worker.run_chunk(setup, starts)


def test_a_run_that_always_kills_its_worker_is_a_row_that_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr(sweep_engine, "run_chunk", deadly_chunk)
    monkeypatch.setattr(sweep_engine, "DEATHS", 1)
    assert sweep(tmp_path, "deadly", "--workers", "1", starts=4) == 0
    rows = rows_of(folder_of(tmp_path, "deadly"))
    assert [row["outcome"] == "error" for row in rows] == [False, False, True, False]
    assert rows[2]["reason"] == "error: worker died"
