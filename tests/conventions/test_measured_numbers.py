"""A number with a unit in README.md or docs/ is a figure of docs/figures.yaml, stands in a marked table, which a
program writes, or is an exception there with its reason."""
import pathlib
import re

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Pages that a program writes as a whole: tests/conventions/test_growth_page.py.
WRITTEN = {"docs/performance.md"}
PAGES = ("README.md", *sorted({f"docs/{path.name}" for path in (ROOT / "docs").glob("*.md")} - WRITTEN))
UNITS = r"mm|deg|degrees|°|px|mrad|ms|us|s|seconds|minutes|%|times|frames/s|steps/s|MiB|MB|kB|grey levels|runs a second"
NUMBER = r"(?<![\w.`^/-])[-+]*\d+(?:\.\d+)?(?:e[-+]?\d+)?(?: \d{3})*"
WITH_UNIT = re.compile(rf"{NUMBER}[ -]?(?:{UNITS})(?![\w^*])")
HEADED = re.compile(rf"\[(?:{UNITS})\]")
#: Not prose: blocks of code, code in a line, marked tables, comments.
OTHER = re.compile(r"```.*?```|<!-- (?!end)[^>]*-->.*?<!-- end[^>]*-->|<!--.*?-->|`[^`\n]*`", re.DOTALL)


def blanked(match):
    """As many lines, characters and columns."""
    return re.sub(r"[^\n|]", "~", match[0])


def spans(entry, page, pattern):
    """Where the words, the table or the paragraph of an entry are in the page. AssertionError: nowhere."""
    if "text" in entry:
        found = list(pattern(entry["text"]).finditer(page))
    elif "table" in entry:
        found = list(re.finditer(rf"^\| ?{re.escape(entry['table'])}.*\n(?:\|.*\n)*", page, re.MULTILINE))
    else:
        found = list(re.finditer(rf"^{re.escape(entry['paragraph'])}.*\n(?:.+\n?)*", page, re.MULTILINE))
    assert found, f"{entry['file']}: found nothing that is {entry}"
    return [match.span() for match in found]


def numbers_with_units(page):
    """[(line number, what was found)]: numbers with a unit, and those below or right of a unit in brackets."""
    found, columns = [], []
    lines = page.splitlines()
    for n, line in enumerate(lines, 1):
        found += [(n, match[0]) for match in WITH_UNIT.finditer(line)]
        if not line.startswith("|"):
            continue
        cells = line.strip("| ").split("|")
        if n == 1 or not lines[n - 2].startswith("|"):
            columns = [k for k, cell in enumerate(cells) if HEADED.search(cell)]
            continue
        of_row = range(1, len(cells)) if HEADED.search(cells[0]) else columns
        found += [(n, match[0]) for k in of_row if k < len(cells) for match in re.finditer(NUMBER, cells[k])]
    return found


@pytest.mark.parametrize("name", PAGES)
def test_every_number_with_a_unit_is_held_or_an_exception(docs, name):
    figures = docs("figures")
    listed, page = figures.load(), (ROOT / name).read_text()
    held = [{**text, "text": figures.say(text["text"], listed["figures"])} for text in listed["texts"]]
    rest = page
    for entry in [*held, *(entry for entries in listed["exceptions"].values() for entry in entries)]:
        for begin, end in spans(entry, page, figures.pattern) if entry["file"] == name else ():
            rest = rest[:begin] + re.sub(r"[^\n|]", "~", page[begin:end]) + rest[end:]
    found = numbers_with_units(OTHER.sub(blanked, rest))
    assert not found, "\n".join([
        *(f"{name}:{line}: '{number}'" for line, number in found),
        "put the figure and its text into docs/figures.yaml, or under its exceptions with the reason"])


def test_exceptions_are_of_pages_that_are_looked_at(docs):
    entries = [entry for entries in docs("figures").load()["exceptions"].values() for entry in entries]
    assert {entry["file"] for entry in entries} <= set(PAGES)
    assert all(set(entry) < {"file", "text", "table", "paragraph"} and len(entry) == 2 for entry in entries)


@pytest.mark.parametrize("page, found", [
    ("It is 0.02 px off, 3.5 mm\nand 12 %.", [(1, "0.02 px"), (1, "3.5 mm"), (2, "12 %")]),
    ("runs at 113 times real time, 24 600 steps/s, T17, 320 x 240, `5 mm`", [(1, "113 times"), (1, "24 600 steps/s")]),
    ("<!-- keys: a -->\n| 5 mm |\n<!-- end keys -->\n```\n5 mm\n```\n7 us", [(7, "7 us")]),
    ("| law | error [mm] |\n|---|---|\n| a 7 | 0.3 |\n| turn [deg] | 8 |", [(3, "0.3"), (4, "8")]),
    ("| law | error |\n|---|---|\n| speed [frames/s] | 0.3 | 28 000 |", [(3, "0.3"), (3, "28 000")])])
def test_numbers_with_units_are_found(page, found):
    assert numbers_with_units(OTHER.sub(blanked, page)) == found
