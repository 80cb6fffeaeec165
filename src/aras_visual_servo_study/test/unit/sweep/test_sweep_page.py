"""The page of a sweep in a real browser: a dot tells its start, result and reason; a click gives a command that, run,
gives that row's result."""

import json
import math
import shlex

import pytest
from browser import CHROMIUM, Browser

from aras_visual_servo.cli.main import main
from aras_visual_servo_study.sweep.figure import DEFAULT_AXES, make_figure
from aras_visual_servo_study.sweep.map import sweep_maps
from aras_visual_servo_study.sweep.statistics import every_run_succeeds
from aras_visual_servo_study.sweep.store import SweepStore

needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
STARTS = 12
TEXT = "(one) => one.textContent"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A sweep whose servo is cut off, with different gains and wide ranges: runs succeed, fail and are refused."""
    output = tmp_path_factory.mktemp("a folder")  # a command must quote it
    assert main(["sweep", "experiment_1", "--seed", "4", "--starts", str(STARTS), "--set", "servo.time_limit_s=0.9",
                 "--set", "sweep.perturb={servo.gains_per_s.xn: [1.0, 4.0]}",
                 "--set", "sweep.camera={x_m: [-0.2, 0.2], y_m: [-0.06, 0.06]}",
                 "--workers", "0", "--output", str(output), "--name", "page"]) == 0
    return output / "sweeps" / "experiment_1" / "page"


@pytest.fixture(scope="module")
def rows(folder):
    with SweepStore.open(folder) as store:
        return store.rows()


@pytest.fixture(scope="module")
def browser(folder, tmp_path_factory):
    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    with Browser(tmp_path_factory.mktemp("browser")) as browser:
        browser.open((folder / "sweep.html").as_uri())
        browser.wait("document.querySelector('.maps .dot')")
        yield browser


def succeeding(rows):
    return [dict(row, outcome="success", success=1, reason="converged") if row["outcome"] == "failure" else dict(row)
            for row in rows]


def test_every_start_is_a_dot_of_its_outcome(browser, rows):
    assert {row["outcome"] for row in rows} == {"success", "failure", "infeasible"}  # else this test sees too little
    found = browser.value("[...document.querySelector('.maps figure').querySelectorAll('.dot')].map((dot) => [Number("
                          "dot.dataset.id), dot.tagName, dot.getAttribute('fill') || dot.getAttribute('stroke')])")
    placed = [row for row in rows if row["x0_mm"] is not None]
    assert sorted(one[0] for one in found) == [row["id"] for row in placed]
    looks = {row["outcome"]: {(tag, colour) for number, tag, colour in found if number == row["id"]} for row in placed}
    assert len(set.union(*looks.values())) == len(looks) and all(len(look) == 1 for look in looks.values())
    assert {tag for tag, _ in looks["infeasible"]} == {"path"}  # a cross


@pytest.mark.parametrize("outcome", ["success", "failure", "infeasible"])
def test_the_command_of_a_clicked_dot_gives_the_result_of_its_row(browser, folder, rows, outcome, capsys, tmp_path):
    row = next(row for row in rows if row["outcome"] == outcome)
    browser.click(f".maps figure .dot[data-id='{row['id']}']")
    told = dict(browser.value("[...document.querySelectorAll('.run dl div')].map((one) => [one.querySelector('dt')"
                              ".textContent, one.querySelector('dd').textContent])"))
    assert told["result"] == outcome and told["reason"] == row["reason"]
    for joint in ("J2", "gantry"):
        if row[f"start_{joint}"] is not None:
            number, unit = told[f"start, {joint}"].replace("−", "-").split()
            assert unit == ("mm" if joint == "gantry" else "deg")
            read = 1e3 * row[f"start_{joint}"] if unit == "mm" else math.degrees(row[f"start_{joint}"])
            assert float(number) == pytest.approx(read, abs=0.0051)
    if row["error_mm"] is not None:
        assert float(told["final error"].split()[0]) == pytest.approx(row["error_mm"], abs=1e-3)
    [command] = browser.value(f"[...document.querySelectorAll('.run code')].map({TEXT})")
    words = shlex.split(command)
    assert words[:2] == ["aras-servo", "rerun"] and words[3:] == ["--sweep", str(folder)]
    capsys.readouterr()
    assert main([*words[1:], "--output", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "same bytes as in the sweep" + (f", trace {row['trace_hash']}" if row['trace_hash'] else "") in said
    if outcome == "infeasible":
        assert row["detail"] in said
    else:
        summary = json.loads((tmp_path / "summary.json").read_text())
        assert summary["run_hash"] == row["run_hash"] and summary["duration_s"] == row["duration_s"]


@needs_browser
def test_a_dot_under_the_pointer_tells_its_start_and_result(browser, rows):
    row = next(row for row in rows if row["outcome"] == "failure")
    box = browser.value(f"(() => {{ const b = document.querySelector(\".maps .dot[data-id='{row['id']}']\")"
                        ".getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; })()")
    browser.mouse("mouseMoved", box, buttons=0)
    told = browser.value(f"[...document.querySelectorAll('.tip:not([hidden]) > *')].map({TEXT})")
    assert told[0] == f"run {row['id']}" and "result: failure" in told and f"reason: {row['reason']}" in told
    assert any(text.startswith("initial distance: ") for text in told)


@needs_browser
def test_other_axes_move_the_dots_and_a_number_finds_a_run(browser, rows):
    row = next(row for row in rows if row["outcome"] == "success")
    places = "[...document.querySelectorAll('.maps .dot')].map((dot) => dot.getAttribute('cx'))"
    before = browser.value(places)
    browser.value("(() => { const axis = document.querySelector('select[data-axis=x]'); axis.value = 'start_J6'; "
                  "axis.onchange(); })()")
    assert browser.value(places) != before
    assert "start, J6 [deg]" in browser.value(f"[...document.querySelectorAll('.maps text')].map({TEXT})")
    browser.value(f"(() => {{ const number = document.querySelector('.domain input'); number.value = '{row['id']}'; "
                  "number.oninput(); })()")
    assert browser.value("document.querySelector('.run h3').textContent") == f"Run {row['id']}"
    assert browser.said == []


@needs_browser
def test_nothing_is_wider_than_a_phone_and_print_has_no_empty_page(folder, tmp_path):
    with Browser(tmp_path, size=(390, 844)) as browser:
        browser.open((folder / "sweep.html").as_uri())
        browser.wait("document.querySelector('.maps .dot')")
        assert browser.value("document.documentElement.scrollWidth <= innerWidth")
        pages = browser.printed(tmp_path / "sweep.pdf")
        assert len(pages) > 1 and all(len(page.split()) > 5 for page in pages)
        assert "servo.gains_per_s.xn: [1.0, 4.0]" in " ".join(" ".join(pages).split())  # of the command, which is long


def test_where_every_run_succeeds_the_maps_show_time_and_error(rows):
    def titles(rows):
        return [one["title"].split()[0] for one in json.loads(sweep_maps(rows, DEFAULT_AXES))["maps"]]

    def panels(rows):
        axes = make_figure("map", rows).axes
        return [one.get_title(loc="left").split()[0] for one in axes if one.get_title(loc="left")]

    assert titles(rows) == ["result", "time", "final"] and panels(rows) == ["success", "time", "final"]
    assert titles(succeeding(rows)) == panels(succeeding(rows)) == ["time", "final"]


def test_where_every_start_was_refused_no_run_has_succeeded(rows):
    refused = [dict(row, outcome="infeasible", success=0) for row in rows]
    maps = [one["title"] for one in json.loads(sweep_maps(refused, DEFAULT_AXES))["maps"]]
    assert maps[0] == "result" and not every_run_succeeds(refused)
    assert every_run_succeeds(succeeding(rows)) and not every_run_succeeds(rows) and not every_run_succeeds([])


def test_no_text_of_a_run_ends_the_script(rows):
    rows = [dict(row, detail="</script><b>") for row in rows]
    assert "<" not in sweep_maps(rows, DEFAULT_AXES)
