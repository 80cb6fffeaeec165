"""The report in a real browser: the script runs without an error, zooms, reads off, turns; print shows everything."""

import re
import shutil
import subprocess

import pytest
from synthetic import make_record

from aras_visual_servo_study.report.report import save_results

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--virtual-time-budget=3000"]
LIMIT_S = 60.0
# Acts as a reader would, and leaves what the reader sees in the title.
PROBE = """<script>
window.addEventListener("load", () => {
  const said = [], svg = document.querySelector("#errors svg"), box = svg.getBoundingClientRect();
  const texts = (id) => [...document.querySelectorAll(`#${id} > svg > text`)].map((one) => one.textContent).join(" ");
  const pointer = (name, x, more) => svg.dispatchEvent(new PointerEvent(name, {
    bubbles: true, pointerId: 7, pointerType: "mouse", clientX: box.left + x * box.width,
    clientY: box.top + 0.5 * box.height, ...more }));
  const before = texts("velocity");
  pointer("pointermove", 0.5);
  said.push("readout:" + document.querySelector("#errors .readout").textContent);
  said.push("value:" + document.querySelector("#errors .legend output").textContent);
  pointer("pointerdown", 0.5); pointer("pointermove", 0.6); pointer("pointerup", 0.6);
  said.push("zoomed:" + (texts("velocity") !== before));
  document.querySelector("#errors button[data-do=all]").click();
  said.push("whole:" + (texts("velocity") === before));
  document.querySelector("#errors .legend button").click();
  const strokes = [...document.querySelectorAll("#convergence .level")].map((one) => one.getAttribute("stroke"));
  said.push("levels:" + new Set(strokes).size);
  said.push("hidden:" + document.querySelectorAll("#errors > svg .curve").length);
  const path = () => document.querySelector("#path .curve").getAttribute("points");
  const seen = path();
  document.querySelector("#path button[data-do=right]").click();
  said.push("turned:" + (path() !== seen));
  window.dispatchEvent(new Event("beforeprint"));
  said.push("open:" + [...document.querySelectorAll("details")].every((one) => one.open));
  said.push("wide:" + (document.documentElement.scrollWidth <= window.innerWidth));
  document.title = said.join("|");
});
</script></body>"""


def browse(page, tmp_path, *more):
    """What chromium writes to stdout."""
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={tmp_path / 'profile'}", *more, page.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=True).stdout


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    save_results(make_record(), folder)
    return folder / "report.html"


@pytest.mark.parametrize("size", ["1200,900", "500,900"])
def test_a_reader_can_zoom_read_off_hide_and_turn(page, tmp_path, size):
    probed = tmp_path / "probed.html"
    probed.write_text(page.read_text().replace("</body>", PROBE))
    dom = browse(probed, tmp_path, "--dump-dom", f"--window-size={size}")
    said = dict(part.split(":", 1) for part in re.search(r"<title>(.*?)</title>", dom).group(1).split("|"))
    assert re.fullmatch(r"t = \d\.\d{3} s", said["readout"]) and said["value"].endswith(" mm")
    assert [said[key] for key in ("zoomed", "whole", "turned", "open", "wide")] == ["true"] * 5
    assert said["hidden"] == "3"  # curves left of four
    assert said["levels"] == "4"  # thresholds, each in the colour of its feature


def test_it_prints(page, tmp_path):
    browse(page, tmp_path, f"--print-to-pdf={tmp_path / 'report.pdf'}")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")
