"""Tables and lists of the documentation are what the program they describe makes."""

import importlib.machinery
import importlib.util
import pathlib
import re
import subprocess
import sys

import pytest
import yaml

from aras_visual_servo_study.sweep.metrics import known_metrics

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "script" / "key_tables"


def test_the_tables_are_those_of_the_descriptions():
    result = subprocess.run([sys.executable, str(SCRIPT), "--check"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    assert result.returncode == 0, result.stdout.decode()


@pytest.fixture
def key_tables(monkeypatch):
    """The script as a module; what it does to the search paths is undone."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    loader = importlib.machinery.SourceFileLoader("key_tables", str(SCRIPT))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("key_tables", loader))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    loader.exec_module(module)
    return module


def test_a_table_is_made_between_its_marks_and_a_part_with_a_table_of_its_own_is_one_row(key_tables):
    part = {"type": "object", "description": "Part.", "properties": {"b": {"type": "number", "description": "B."}}}
    schemas = {"a": {"properties": {"part": part}}, "a.part": part}
    page = "before\n<!-- keys: a -->\nold\n<!-- end keys -->\nbetween\n"
    more = "<!-- keys: a.part -->\n<!-- end keys -->\nafter\n"
    alone, both = (key_tables.with_tables(text, schemas.__getitem__) for text in (page, page + more))
    assert "old" not in alone and "| `part.b` |" in alone and alone.startswith("before\n") and "between\n" in alone
    assert "| `part.b` |" not in both and "| `b` | none | number | B. |\n<!-- end keys -->\nafter\n" in both
    assert key_tables.with_tables(both, schemas.__getitem__) == both
    with pytest.raises(KeyError):
        key_tables.with_tables("<!-- keys: c -->\n<!-- end keys -->\n", schemas.__getitem__)


ROOT = pathlib.Path(__file__).resolve().parents[2]


def test_every_test_that_the_page_names_is_there():
    page = (ROOT / "docs" / "validation.md").read_text()
    named = re.findall(r"`([\w/]+_test\.cpp|test_\w+\.py|tests/\w+)`", page)
    there = {str(path.relative_to(ROOT)) for folder in ("src", "tests") for path in (ROOT / folder).rglob("*")}
    missing = [name for name in named if not any(path.endswith(name) for path in there)]
    assert len(named) > 8 and not missing, missing


DOCS = pathlib.Path(__file__).resolve().parents[2] / "docs"


def test_docs_list_every_metric_with_its_threshold_and_source():
    rows = re.findall(r"^\| `(\w+)` \| (below .*?) \| (.*?) \|$", (DOCS / "sweeps.md").read_text(), re.MULTILINE)
    found = {name: (threshold, source) for name, threshold, source in rows}
    assert set(found) == {metric.name for metric in known_metrics()}
    for metric in known_metrics():
        threshold, source = found[metric.name]
        assert threshold == metric.threshold and source.startswith(metric.source)


PROGRAM = ROOT / "src/aras_visual_servo_study/bench/law_times.py"


def test_the_table_has_the_rows_that_are_measured():
    spec = importlib.util.spec_from_file_location("law_times", PROGRAM)
    law_times = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(law_times)
    page = (ROOT / "docs" / "features_and_laws.md").read_text()
    rows = page.partition(law_times.BEGIN)[2].partition(law_times.END)[0].splitlines()[3:]
    stated = [re.sub(r" [0-9.]+ \| [0-9.]+ \| [0-9.]+ \|$", "", row) for row in rows]
    assert stated == [law_times.label(*row) for row in law_times.ROWS], f"{PROGRAM.name} --write renews the table"


PAGE = (ROOT / "docs" / "fuzzing.md").read_text()
TARGETS = sorted(ROOT.glob("src/*/fuzz/*.cpp"))
MOST_BYTES = 1024  # of an input that script/fuzz makes up


@pytest.mark.parametrize("target", TARGETS, ids=lambda path: path.stem)
def test_a_target_has_small_seeds_and_stands_in_the_table(target):
    seeds = list((target.parent / "corpus" / target.stem).iterdir())
    assert 2 <= len(seeds) <= 16 and all(seed.stat().st_size <= MOST_BYTES for seed in seeds)
    assert f"| `{target.stem}` |" in PAGE


def test_names_of_targets_are_unique():
    assert len({target.stem for target in TARGETS}) == len(TARGETS) > 10


SECTIONS = sorted((ROOT / "src").glob("*/schema/*.yaml"))


def unbounded(node, where):
    """Names of the values of a schema that have no bound on one side; seeds may be any integer of 64 bits."""
    if not isinstance(node, dict):
        return []
    found = []
    if node.get("type") in ("number", "integer") and not where.endswith("seed"):
        for words in (("minimum", "exclusiveMinimum"), ("maximum", "exclusiveMaximum")):
            found += [] if any(word in node for word in words) else [f"{where}: no {words[0]}"]
    if node.get("type") == "array" and "maxItems" not in node:
        found.append(f"{where}: no maxItems")
    for name, each in (node.get("properties") or {}).items():
        found += unbounded(each, f"{where}/{name}")
    for key in ("items", "additionalProperties"):
        found += unbounded(node.get(key), f"{where}[]")
    for key in ("anyOf", "oneOf"):
        for k, each in enumerate(node.get(key) or []):
            found += unbounded(each, f"{where} ({k})")
    return found


@pytest.mark.parametrize("path", SECTIONS, ids=lambda path: f"{path.parts[-3]}-{path.stem}")
def test_every_number_and_list_has_bounds(path):
    assert not unbounded(yaml.safe_load(path.read_text()), path.stem)


def test_a_value_without_bounds_is_found():
    lists = {"type": "array", "items": {"type": "integer"}}
    schema = {"properties": {"a": {"type": "number", "minimum": 0}, "b": lists}}
    assert unbounded(schema, "s") == ["s/a: no maximum", "s/b: no maxItems", "s/b[]: no minimum", "s/b[]: no maximum"]
