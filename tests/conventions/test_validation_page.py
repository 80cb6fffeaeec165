"""docs/validation.md names tests that exist. The tests that compare check its rows: fixture `compared`."""
import pathlib
import re

ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_every_test_that_the_page_names_is_there():
    page = (ROOT / "docs" / "validation.md").read_text()
    named = re.findall(r"`([\w/]+_test\.cpp|test_\w+\.py|tests/\w+)`", page)
    there = {str(path.relative_to(ROOT)) for folder in ("src", "tests") for path in (ROOT / folder).rglob("*")}
    missing = [name for name in named if not any(path.endswith(name) for path in there)]
    assert len(named) > 8 and not missing, missing
