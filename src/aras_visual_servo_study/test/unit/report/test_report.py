"""Result folder: summary, trace, figure, report, and the table of the terminal."""

import base64
import csv
import dataclasses
import hashlib
import html
import io
import json
import math
import os
import re
import subprocess
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
import yaml
from synthetic import SETTINGS, make_record

from aras_visual_servo_study.report import report, template
from aras_visual_servo_study.report.drawing import Drawing
from aras_visual_servo_study.report.pictures import PANELS, image_of
from aras_visual_servo_study.report.plots import plots_of
from aras_visual_servo_study.report.report import (NOT_COMPARABLE, ResultFolderError, create_result_folder,
                                                   format_summary, save_results, summarise, trace_csv)

FILES = {"summary.json", "trace.csv", "figure.png", "figure.pdf", "report.html"}
# trace.csv keeps nine significant digits.
CSV_RELATIVE = 1e-8


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    folder = create_result_folder(tmp_path_factory.mktemp("results"), "experiment_1", stamp="a")
    record = make_record()
    return record, folder, save_results(record, folder)


def test_the_folder_holds_every_file_and_nothing_half_written(saved):
    assert {path.name for path in saved[1].iterdir()} == FILES


def test_the_summary_has_the_documented_keys(saved):
    summary = json.loads((saved[1] / "summary.json").read_text())
    assert {"scenario", "converged", "reason", "duration_s", "final_error", "final_feature_error", "real_time_factor",
            "run_hash", "seed", "versions"} <= set(summary)
    assert set(summary["final_error"]) == {"x_mm", "y_mm", "z_mm", "angle_deg"}
    assert {"aras_visual_servo", "numpy", "python"} <= set(summary["versions"])


def test_the_summary_carries_the_hash_of_the_trace(saved):
    digest = hashlib.sha256((saved[1] / "trace.csv").read_bytes()).hexdigest()
    assert json.loads((saved[1] / "summary.json").read_text())["trace_sha256"] == digest


def test_what_is_not_a_number_is_null_in_the_summary(tmp_path):
    record = dataclasses.replace(make_record(), real_time_factor=math.nan)
    save_results(record, tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["real_time_factor"] is None


def test_the_same_record_gives_the_same_bytes(saved, tmp_path):
    save_results(make_record(), tmp_path)
    for name in FILES:
        assert (tmp_path / name).read_bytes() == (saved[1] / name).read_bytes(), name


def test_the_trace_has_one_row_per_image_and_the_values_of_the_record(saved):
    record = saved[0]
    rows = list(csv.DictReader(io.StringIO((saved[1] / "trace.csv").read_text())))
    assert len(rows) == len(record)
    i = record.servo_rows[10]
    assert rows[i]["phase"] == "servo" and rows[i]["t_s"] == f"{record.stamp_ns[i] / 1e9:.9f}"
    for name, value in (("e_yn_m", record.e[i, 1]), ("e_alpha_rad", record.e[i, 3]), ("V_vz_m_s", record.twist[i, 2]),
                        ("V_wz_rad_s", record.twist[i, 5]), ("q_gantry", record.q[i, 2]),
                        ("p_WC_z_m", record.X_WC[i, 2, 3])):
        assert float(rows[i][name]) == pytest.approx(value, rel=CSV_RELATIVE), name


def test_a_missing_value_is_an_empty_cell(saved):
    first = next(csv.DictReader(io.StringIO(trace_csv(saved[0]))))
    assert first["e_xn_m"] == "" and first["q_gantry"] == "0.05"


class _Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.sources, self.tags = [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.sources += [value for name, value in attributes if name in ("src", "href", "poster")]


def test_the_report_is_one_self_contained_page_with_all_pictures_and_plots(saved):
    text = (saved[1] / "report.html").read_text()
    page = _Page(text)
    assert page.tags.count("img") == 4  # desired, initial, the differences at the end and at the start
    assert page.tags.count("figure") == 4 + 4 and page.tags.count("script") == 4 + 2
    assert all(re.match("data:(image/png|text/yaml);base64,", source) for source in page.sources)
    assert 'name="viewport"' in text and "@media print" in text
    assert not re.search(r"https?://", text)


def test_text_of_a_run_cannot_break_the_page(tmp_path):
    record = make_record()
    text = record.status_text.astype(object)
    text[record.servo_rows[-1]] = "<script>alert(1)</script>"
    save_results(dataclasses.replace(record, status_text=text), tmp_path)
    assert "<script>alert" not in (tmp_path / "report.html").read_text()


def test_a_failed_run_says_why():
    table = format_summary(summarise(make_record(final_p_m=(5e-3, 0, 0))))
    assert "FAILED" in table and "x_mm: found 5, allowed +-0.2" in table


def test_a_variant_is_compared_with_the_experiment_it_varies():
    assert summarise(make_record(scenario="experiment_2_slow"))["published"]["y_mm"] == 8.9
    assert summarise(make_record(scenario="mine"))["published"] is None


@pytest.mark.parametrize("scenario, said", [("experiment_1", True), ("experiment_2_slow", True), ("mine", False)])
def test_console_and_page_say_that_published_results_cannot_be_compared(tmp_path, scenario, said):
    record = make_record(scenario=scenario)
    table = format_summary(summarise(record))
    assert (NOT_COMPARABLE in " ".join(table.split())) == said
    save_results(record, tmp_path)
    assert (NOT_COMPARABLE in html.unescape((tmp_path / "report.html").read_text())) == said


def test_a_record_without_images_and_settings_still_gives_a_report(tmp_path):
    record = dataclasses.replace(make_record(), desired_image=None, initial_image=None, final_image=None, settings={},
                                 real_time_factor=math.nan, run_hash="")
    summary = save_results(record, tmp_path)
    assert summary["passed"] and "unknown" not in format_summary(summary)
    page = _Page((tmp_path / "report.html").read_text())
    assert page.tags.count("img") == 0 and page.tags.count("svg") >= len(plots_of(record))


def test_the_scenario_can_be_taken_out_of_the_page(saved):
    [address] = [source for source in _Page((saved[1] / "report.html").read_text()).sources if "text/yaml" in source]
    assert yaml.safe_load(base64.b64decode(address.partition("base64,")[2])) == SETTINGS


def test_every_panel_is_a_pdf_of_its_own_when_asked_for(tmp_path):
    save_results(make_record(), tmp_path, panels=True)
    for panel in PANELS:
        assert (tmp_path / f"panel_{panel}.pdf").read_bytes().startswith(b"%PDF-"), panel


def test_panel_c_is_final_minus_desired_and_mid_grey_where_nothing_changed():
    record = make_record()  # ends with the desired image
    assert np.all(image_of(record, "difference") == 128)
    assert image_of(dataclasses.replace(record, final_image=None), "difference") is None
    start = image_of(record, "start")
    assert start.dtype == np.uint8
    assert set(np.unique(start)) == {128 - 95, 128, 128 + 95}  # half of 230 - (20 + 40 + 60) / 3
    not_moved = dataclasses.replace(record, final_image=record.initial_image)
    assert np.array_equal(image_of(not_moved, "difference"), start)


def test_a_folder_that_cannot_be_written_is_an_error_with_the_reason(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultFolderError, match="cannot be written: Not a directory.*--output"):
        create_result_folder(tmp_path / "file", "experiment_1")


def test_a_full_disk_is_noticed_before_the_run(tmp_path):
    code = ("import resource, signal, sys; signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
            "resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)); "  # files of a full disk grow no more
            "from aras_visual_servo_study.report.report import create_result_folder; "
            "create_result_folder(sys.argv[1], 'experiment_1')")
    # coverage.py would write its counts, cut off like all files here, into a file that other processes use too.
    uncounted = {name: value for name, value in os.environ.items() if not name.startswith("COV_CORE")}
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path)], env=uncounted, stderr=subprocess.PIPE, text=True,
                          check=False)
    assert done.returncode == 1 and "experiment_1': cannot be written: File too large" in done.stderr
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == []


def test_two_runs_in_one_second_get_two_folders(tmp_path, monkeypatch):
    monkeypatch.setattr(report.time, "strftime", lambda _: "20260101-000000")
    names = [create_result_folder(tmp_path, "x").name for _ in range(3)]
    assert names == ["20260101-000000", "20260101-000000-2", "20260101-000000-3"]


def test_numbers_survive_when_there_is_nothing_to_judge(tmp_path):
    record = make_record()
    with pytest.raises(RuntimeError):
        save_results(dataclasses.replace(record, phase=np.full(len(record), "to_goal")), tmp_path)
    assert (tmp_path / "trace.csv").exists()


def test_a_process_beside_draws_the_same_figure_and_tells_of_a_file_that_it_cannot_write(saved, tmp_path):
    with Drawing() as drawing:
        summary = save_results(saved[0], tmp_path, drawing=drawing)
        with pytest.raises(FileNotFoundError):
            drawing.save(saved[0], tmp_path / "figure.png", tmp_path / "missing" / "figure.pdf")()
    assert summary["passed"] == saved[2]["passed"]
    for name in ("figure.png", "figure.pdf"):
        assert (tmp_path / name).read_bytes() == (saved[1] / name).read_bytes()


def test_a_run_without_a_lens_does_not_wait_for_opencv(tmp_path):
    program = ("import sys; from aras_visual_servo.cli.main import main; "
               "code = main(['run', 'experiment_1', '--output', sys.argv[1]]); "
               "sys.exit('imported' if 'cv2' in sys.modules else code)")
    run = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True,
                         env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert run.returncode == 0, run.stderr
    assert "<svg" in next(tmp_path.rglob("report.html")).read_text()


def test_the_page_is_the_same_where_templates_cannot_be_kept_compiled(saved, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    template._environment.cache_clear()
    try:
        save_results(saved[0], tmp_path)
    finally:
        template._environment.cache_clear()
    assert (tmp_path / "report.html").read_bytes() == (saved[1] / "report.html").read_bytes()
