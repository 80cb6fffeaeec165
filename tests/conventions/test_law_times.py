"""The table of times in docs/features_and_laws.md has the rows that law_times.py measures, and agrees with itself."""
import importlib.util
import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "features_and_laws.md"
#: All three are rounded: the SVD to 0.05 us, the law to 0.5 us and their ratio to 0.05.
SVD_US, LAW_US, RATIO = 0.05, 0.5, 0.05
AGAIN = "python3 src/aras_visual_servo_study/bench/law_times.py --write docs/features_and_laws.md makes it again"


@pytest.fixture(scope="module")
def law_times():
    spec = importlib.util.spec_from_file_location(
        "law_times", ROOT / "src/aras_visual_servo_study/bench/law_times.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def rows_of(law_times, page):
    return page.partition(law_times.BEGIN)[2].partition(law_times.END)[0].splitlines()[3:]


def test_the_table_has_the_rows_that_are_measured(law_times):
    stated = [re.sub(r" [0-9.]+ \| [0-9.]+ \| [0-9.]+ \|$", "", row) for row in rows_of(law_times, PAGE.read_text())]
    assert stated == [law_times.label(*row) for row in law_times.ROWS], AGAIN


def test_the_ratios_are_those_of_the_times(law_times):
    page = PAGE.read_text()
    svd_us = float(re.search(law_times.SVD, page)[0].split()[2])
    for row in rows_of(law_times, page):
        law_us, ratio, step_us = map(float, re.findall(r" ([0-9.]+) \|", row)[-3:])
        rounding_us = LAW_US + RATIO * svd_us + SVD_US * (ratio + RATIO)
        assert ratio * svd_us == pytest.approx(law_us, rel=0.0, abs=rounding_us), f"{row}: {AGAIN}"
        assert step_us > law_us, row


def test_what_is_written_is_read(law_times):
    rows = [f"{law_times.label(*row)} 20 | 2.0 | 90 |" for row in law_times.ROWS]
    page = law_times.write(PAGE.read_text(), rows, 10e-6)
    assert rows_of(law_times, page) == rows and "which is 10.0 us here" in page
    assert law_times.write(page, rows, 10e-6) == page
