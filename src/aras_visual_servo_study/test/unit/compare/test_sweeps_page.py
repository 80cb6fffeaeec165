"""Pages of `compare`: numbers of the statistics, maps of pairs, commands by a click; runs side by side."""

import json
import re
import shlex
from html import unescape

import pytest
from browser import Browser, CHROMIUM

from aras_visual_servo.cli.main import main
from aras_visual_servo_study.compare.sweeps import compare_pair
from aras_visual_servo_study.compare.sweeps import paired_maps, sweeps_page
from aras_visual_servo_study.report.template import render
from aras_visual_servo_study.sweep.store import SweepStore

LIMITS_S = {"long": "1.5", "short": "0.9"}


@pytest.fixture(scope="module")
def output(tmp_path_factory):
    """Two sweeps of the same starts, one of which is cut off earlier, and their comparison."""
    output = tmp_path_factory.mktemp("output")
    for name, limit_s in LIMITS_S.items():
        assert main(["sweep", "experiment_1", "--seed", "4", "--starts", "10", "--set", f"servo.time_limit_s={limit_s}",
                     "--set", "sweep.perturb={servo.gains_per_s.xn: [1.0, 4.0]}",
                     "--workers", "0", "--output", str(output), "--name", name]) == 0
    words = [str(output / "sweeps" / "experiment_1" / name) for name in LIMITS_S]
    words = [*words, "--fail-if", "success < 0.999"]
    assert main(["compare", "sweeps", *words, "--output", str(output), "--name", "page"]) == 1
    return output


@pytest.fixture(scope="module")
def sweeps(output):
    found = []
    for name in LIMITS_S:
        with SweepStore.open(output / "sweeps" / "experiment_1" / name) as store:
            found.append(store.rows())
    return found


@pytest.fixture(scope="module")
def page(output):
    return output / "comparisons" / "sweeps" / "page" / "compare.html"


def test_the_page_states_the_numbers_of_the_statistics(page, sweeps):
    text, found = unescape(page.read_text()), compare_pair(*sweeps)
    assert found["only_a"] > 0 and found["pairs"] > found["only_a"]  # else this test sees too little
    cells = dict(re.findall(r"<tr><td[^>]*>([^<]+)</td><td>([^<]*)</td></tr>", text))
    assert cells["pairs"] == str(found["pairs"]) and cells["only A succeeds"] == str(found["only_a"])
    assert cells["McNemar p"].replace("−", "-") == f"{found['mcnemar_p']:.3g}"
    assert cells["time change [s]"].replace("−", "-") == f"{found['time_change_s']:+.3f}"
    assert cells["angle change [deg]"].replace("−", "-") == f"{found['angle_change_deg']:+.5f}"
    assert cells["Wilcoxon p, angle"].replace("−", "-") == f"{found['angle_p']:.3g}"
    assert "Gate failed" in text and "success < 0.999" in text
    assert not re.search(r'(?:src|href)="(?!data:)', text)


def test_a_map_has_the_change_of_every_pair(sweeps):
    data = json.loads(paired_maps(*sweeps, "B", ("a", "b")))
    place = {name: i for i, name in enumerate(data["columns"])}
    by_id = [{row["id"]: row for row in rows} for rows in sweeps]
    for row in data["rows"]:
        a, b = (rows[row[place["id"]]] for rows in by_id)
        kind = data["texts"]["pair"][row[place["pair"]]]
        kinds = {(1, 1): "both", (1, 0): "only_a", (0, 1): "only_b", (0, 0): "neither"}
        assert kind == kinds[a["success"], b["success"]]
        change = row[place["error_change_mm"]]
        assert (change is None) == (kind != "both")
        assert change is None or change == pytest.approx(b["error_mm"] - a["error_mm"], rel=1e-6)
        turned = row[place["angle_change_deg"]]
        assert turned is None or turned == pytest.approx(b["angle_deg"] - a["angle_deg"], rel=1e-6)
    assert [one["key"] for one in data["maps"]] == ["pair", "time_change_s", "error_change_mm",
                                                    "angle_change_deg"]


def test_where_all_succeed_there_is_no_map_of_one_colour(sweeps):
    rows = [row for row in sweeps[0] if row["success"]]
    assert [one["key"] for one in json.loads(paired_maps(rows, rows, "B", "ab"))["maps"]] == [
        "time_change_s", "error_change_mm", "angle_change_deg"]


def test_one_sweep_alone_has_a_page_too(sweeps):
    text = sweeps_page(["one"], ["/somewhere"], sweeps[:1], [], "compare one")
    assert "Pairs of the same starts" not in text and '"folder":"/somewhere"' in text


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_a_click_gives_the_commands_of_both_runs_and_print_cuts_nothing(page, output, sweeps, tmp_path):
    with Browser(tmp_path, size=(390, 844)) as browser:
        browser.open(page.as_uri())
        browser.wait("document.querySelector('.maps .dot')")
        number = next(row["id"] for row in sweeps[0] if row["success"])
        browser.click(f".maps figure .dot[data-id='{number}']")
        commands = browser.value("[...document.querySelectorAll('.run code')].map((one) => one.textContent)")
        assert [shlex.split(one)[1:] for one in commands] == [
            ["rerun", str(number), "--sweep", str(output / "sweeps" / "experiment_1" / name)] for name in LIMITS_S]
        assert browser.value("document.documentElement.scrollWidth <= innerWidth")
        pages = browser.printed(tmp_path / "compare.pdf")
        assert all(len(page.split()) > 5 for page in pages)
        assert browser.said == []


#: As of a run that did not converge: the words of the judge.
LONG = "not converged after 20.0 s: xn, yn, an, alpha; for the last 19.7 s the arm could not follow the law, END"
#: A transparent picture of one pixel.
PIXEL = ("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==")


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
@pytest.mark.parametrize("size", [(1200, 900), (390, 844)])
def test_no_cell_is_wider_than_the_page_and_print_is_whole(tmp_path, size):
    page = tmp_path / "runs.html"
    page.write_text(render("runs.html.j2", labels=["naive_inverse", "redundant"], settings=[("servo.gain", "12")],
                           table=[("ended with", [LONG, LONG]), ("error [mm]", ["61.55", "0.26"])],
                           command="compare_runs", picture=PIXEL))
    with Browser(tmp_path, size=size) as browser:
        browser.open(page.as_uri())
        browser.wait("document.querySelector('.results')")
        assert browser.value("[...document.querySelectorAll('.wide')].every((one) => one.scrollWidth <= "
                             "one.clientWidth)")
        assert browser.value("document.documentElement.scrollWidth <= innerWidth")
        pages = browser.printed(tmp_path / "runs.pdf")
        assert all(len(page.split()) > 5 for page in pages)
        assert " ".join(pages).count("END") == 2 and "61.55" in " ".join(pages)
