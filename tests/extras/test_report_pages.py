"""Pages of a run, a sweep and a comparison by axe-core's rules of accessibility, light and dark; print is light."""
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from aras_visual_servo.cli.main import main

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "src" / "aras_visual_servo_study" / "test" / "support"))
from browser import CHROMIUM, Browser  # noqa: E402

AXE = Path(find_spec("axe_core_python").submodule_search_locations[0]) / "axe.min.js"
RUN = ("axe.run(document, {resultTypes: ['violations']}).then((found) => found.violations.map((one) => "
       "[one.id, one.impact, one.nodes.map((node) => node.target.join(' ')).slice(0, 5)]))")
#: Luminance of the page's paper and of its curves, in [0, 1].
PAPER = "luminance(getComputedStyle(document.body).backgroundColor)"
CURVES = ("[...document.querySelectorAll('.plot > svg:not(.pixels) .curve')]"
          ".map((one) => luminance(getComputedStyle(one).stroke))")
LUMINANCE = """window.luminance = (colour) => {
  const pen = document.createElement('canvas').getContext('2d');
  pen.fillStyle = colour; pen.fillRect(0, 0, 1, 1);
  const [r, g, b] = [...pen.getImageData(0, 0, 1, 1).data].map((c) => c / 255)
    .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}; 1"""
LEAST_CONTRAST = {False: 3.0, True: 4.5}  # of curves; the palette is made for 3:1 on white paper


def contrast(a, b):
    return (max(a, b) + 0.05) / (min(a, b) + 0.05)


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    output = tmp_path_factory.mktemp("output")
    more = ["--output", str(output)]
    assert main(["run", "experiment_1", *more]) == 0
    assert main(["sweep", "experiment_1", "--starts", "6", "--workers", "0", *more]) == 0
    assert main(["compare", "runs", "experiment_1", "experiment_2", *more]) == 0
    return [next(output.rglob(name)) for name in ("report.html", "sweep.html", "runs.html")]


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_axe_finds_nothing_light_or_dark_and_curves_stand_out(pages, tmp_path):
    with Browser(tmp_path) as browser:
        for page in pages:
            browser.open(page.as_uri())
            browser.wait(f"location.href === '{page.as_uri()}' && document.readyState === 'complete'")
            browser.value(AXE.read_text() + ";" + LUMINANCE)
            papers = {}
            for dark in (False, True):
                for width in (1280, 390):
                    browser.look((width, 900), dark)
                    assert browser.value(RUN) == [], (page.name, width, dark)
                papers[dark] = browser.value(PAPER)
                for curve in browser.value(CURVES):
                    assert contrast(curve, papers[dark]) >= LEAST_CONTRAST[dark], (page.name, dark)
            assert papers[False] > 0.9 and papers[True] < 0.1
            browser.call("Emulation.setEmulatedMedia", media="print",
                         features=[{"name": "prefers-color-scheme", "value": "dark"}])
            assert browser.value(PAPER) == papers[False]
            browser.call("Emulation.setEmulatedMedia", media="")
