"""The live page by axe-core's rules of accessibility: labels, roles, contrast, at every width, light and dark."""
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "src" / "aras_visual_servo_study" / "test" / "support"))
from browser import CHROMIUM, Browser, end  # noqa: E402

PROGRAM = ROOT / "src" / "aras_visual_servo" / "scripts" / "aras-servo"
AXE = Path(find_spec("axe_core_python").submodule_search_locations[0]) / "axe.min.js"
RUN = ("axe.run(document, {resultTypes: ['violations']}).then((found) => found.violations.map((one) => "
       "[one.id, one.impact, one.nodes.map((node) => node.target.join(' ')).slice(0, 5)]))")


@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_axe_finds_nothing_at_any_width(tmp_path):
    command = [sys.executable, str(PROGRAM), "live", "experiment_1", "--port", "0", "--speed", "4", "--edit"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        with Browser(tmp_path) as browser:
            browser.open(process.stdout.readline().split()[-1])
            browser.wait("document.body.classList.contains('ready') && aras.shared.run?.ended")
            browser.value("document.querySelectorAll('details').forEach((one) => { one.open = true; }); 1")
            browser.value("document.querySelector('#law-text').value = 'x = ('; 1")
            browser.click("#law-apply")  # with a fault and its line
            browser.wait("document.querySelector('[data-line]')")
            browser.value(AXE.read_text() + "; 1")
            for width in (1440, 1280, 1024, 390):
                for dark in (False, True):
                    browser.look((width, 900), dark)
                    assert browser.value(RUN) == [], (width, dark)
    finally:
        end(process)
