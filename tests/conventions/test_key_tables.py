"""The tables of keys in READMEs and docs are those that script/key_tables makes from the descriptions."""
import importlib.machinery
import importlib.util
import pathlib
import subprocess
import sys

import pytest

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
    assert "| `part.b` |" not in both and "| `b` |  | none | a number | B. |\n<!-- end keys -->\nafter\n" in both
    assert key_tables.with_tables(both, schemas.__getitem__) == both
    with pytest.raises(KeyError):
        key_tables.with_tables("<!-- keys: c -->\n<!-- end keys -->\n", schemas.__getitem__)
