"""docs/validation.md names tests that exist, and its tables hold what the page is about.

The tests that compare hold each row themselves: fixture `compared` in tests/conftest.py.
"""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "validation.md"


def test_every_test_that_the_page_names_is_there():
    named = re.findall(r"`([\w/]+_test\.cpp|test_\w+\.py|tests/\w+)`", PAGE.read_text())
    there = {str(path.relative_to(ROOT)) for folder in ("src", "tests") for path in (ROOT / folder).rglob("*")}
    missing = [name for name in named if not any(path.endswith(name) for path in there)]
    assert len(named) > 8 and not missing, missing


def test_no_comparison_stands_outside_its_bound(docs):
    rows = docs("validation").read(PAGE.read_text())
    assert {against.split(",")[0].split(" ")[0] for _, against in rows} >= {"ViSP", "Pinocchio", "MuJoCo"}
    assert all(row["worst"] <= row["bound"] and row["cases"] > 0 for row in rows.values())


def test_a_table_is_read_as_it_was_written(docs):
    entry = {"group": "peers", "what": "mass", "against": "b", "cases": 3, "worst": 2e-3, "bound": 1e-2,
             "unit": "of it"}
    page = "<!-- compared: peers -->\nold\n<!-- end compared -->\n"
    found = docs("validation").read(docs("validation").write(page, [entry]))
    assert found == {("mass", "b"): {key: entry[key] for key in ("cases", "worst", "bound", "unit")}}
