"""The page of runs side by side: a long reason wraps, nothing is cut off, on a screen, a phone and on paper."""

import pytest
from browser import CHROMIUM, Browser

from aras_visual_servo_study.report.template import render

#: As of a run that did not converge: the words of the judge.
LONG = "not converged after 20.0 s: xn, yn, an, alpha; for the last 19.7 s the arm could not do what was asked, END"
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
