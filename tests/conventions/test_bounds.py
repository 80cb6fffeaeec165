"""Every number and every list that schema/*.yaml of the C++ packages describe has bounds: none is read without."""
import pathlib

import pytest
import yaml

ROOT = pathlib.Path(__file__).resolve().parents[2]
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
