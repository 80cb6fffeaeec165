"""A scenario to begin with: it extends another one, and every key that it may change stands there with its meaning."""

import shlex
import textwrap
from math import inf
from pathlib import Path
from typing import Optional

import yaml

from ..config.tables import allowed_of, flow, section_of
from .scenario import load_scenario
from .schema import scenario_schema

HEAD = """\
# {name}: a scenario with the differences from {base}.
# Run it:  {run}
# Lines with ## explain. A line with # holds the value of {base}, or the default. To change it, remove the # from
# the line and from the lines of its sections. `null` removes a value of {base}.
name: {name}
description: As {base}, so far.
extends: {extends}
"""
#: In this order: sections that users change first come first.
SECTIONS = ("servo", "experiment", "vision", "sim", "robot", "time", "sweep", "real")
#: Descriptions of sections whose schema has none.
WHAT = {"servo": "The law, its features and gains, the stop rule, and the limits of the arm.",
        "experiment": "The experiment: the taught goal, the start, and the criteria of the judge.",
        "robot": "The arm.", "sweep": "Variations of a sweep of many runs (docs/sweeps.md).",
        "real": "The commands and limits of a real arm; simulated runs ignore them."}
WIDTH = 120


def starter(name: str, base: str = "experiment_1", path: Optional[Path] = None) -> str:
    """Returns the text of a scenario file equivalent to `base`, with every key commented out, from the schema.

    Args: name: of the new scenario.  base: name or path of the one that it extends.  path: absolute, of the file.
    Raises: ParameterError: there is no such scenario, or it has faults.
    """
    scenario = load_scenario(base)
    said, sections = scenario.as_dict(), scenario_schema()["properties"]
    lines = HEAD.format(name=name, base=scenario.name, extends=flow(str(base)),
                        run=shlex.join(["aras-servo", "run", str(path or f"{name}.yaml")])).splitlines()
    for section in SECTIONS:
        meaning = _first(sections[section]) or WHAT[section]
        lines += ["", *_wrapped(meaning, ""), f"#{section}:", *_keys(sections[section], said.get(section, {}), "  ")]
    return "\n".join(lines) + "\n"


def _keys(schema, said, indent):
    """Yields the lines of the keys of one section. `said` is the base scenario's section."""
    schema = section_of(schema)
    for key, found in schema.get("properties", {}).items():
        yield from _wrapped(_meaning(found), f"#{indent}")
        value, inner = said.get(key, found.get("default")), section_of(found).get("properties")
        if inner and isinstance(value, dict) and not isinstance(found.get("additionalProperties"), dict):
            yield f"#{indent}{key}:"
            yield from _keys(found, value, indent + "  ")
        elif inner and found.get("type") == "array" and value and all("name" in entry for entry in value):
            yield f"#{indent}{key}:"
            for entry in value:
                yield f"#{indent}  - name: {flow(entry['name'])}"
                rest = {name: part for name, part in section_of(found)["properties"].items() if name != "name"}
                yield from _keys({"properties": rest}, entry, indent + "    ")
        else:
            yield f"#{indent}{key}:" + ("" if value in (None, "") else f" {_exact(value)}")


def _meaning(schema):
    """Returns unit, allowed values and description in one line."""
    unit = f"[{schema['unit']}]" if schema.get("unit") else ""
    allowed = allowed_of(schema).replace("`", "").replace("\\|", "|")
    if section_of(schema).get("properties") and schema.get("type") != "array" and not allowed.endswith("a section"):
        allowed = "a section"
    return " ".join(filter(None, (unit, f"{allowed}:" if allowed else "", _first(schema))))


def _wrapped(text, before):
    return textwrap.wrap(text, WIDTH, initial_indent=before + "## ", subsequent_indent=before + "##   ")


def _first(schema):
    return " ".join(str(schema.get("description", "")).split())


def _exact(value):
    """As YAML has it, in one line, numbers with all their digits."""
    return yaml.safe_dump(value, default_flow_style=True, sort_keys=False, width=inf).replace("\n...\n", "").rstrip()
