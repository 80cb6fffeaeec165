"""README's table beside the paper's figures is the one that script/bench --paper prints."""
import importlib
import pathlib
import re
import sys

WORKSPACE = pathlib.Path(__file__).resolve().parents[2]
# A median, or the worst of 16 runs. Another build or processor rounds otherwise, and a pixel more or less on the edge
# of the object changes one of them by this much.
SHARE, LEAST = 0.2, 0.02


def rows(lines):
    """Row -> its numbers, of the lines of a table about experiments."""
    found = {}
    for line in lines:
        if line.startswith("| experiment"):
            name, _, cells = line.strip("| ").partition(" |")
            found[name] = [float(number) for number in re.findall(r"\d+(?:\.\d+)?", cells)]
    return found


def test_the_table_of_the_readme_is_the_one_measured(monkeypatch):
    monkeypatch.setattr(sys, "path", [str(WORKSPACE / "script/docs"), *sys.path])
    lines, _ = importlib.import_module("paper_table").table()
    measured, written = rows(lines), rows((WORKSPACE / "README.md").read_text(encoding="utf-8").splitlines())
    assert len(measured) == 6 and list(written) == list(measured)
    for name, numbers in measured.items():
        assert len(written[name]) == len(numbers), name
        for here, there in zip(numbers, written[name]):
            assert abs(here - there) <= max(SHARE * here, LEAST), f"{name}: README says {there}, measured {here}"
