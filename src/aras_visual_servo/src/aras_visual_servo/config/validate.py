"""Checks a value against the schema of a section. Lists every fault with key, value found and allowed values.

The keywords are those that aras_visual_servo_common/README.md lists; the C++ packages word their faults alike.
"""

import re
from collections.abc import Mapping
from math import isfinite
from typing import Any, List, NamedTuple, Tuple, Union

from ..ground.registry import one_of
from .tables import allowed_of, flow

MOST_SHOWN = 60  # characters of the value found, in a fault
#: Stands for a `null` of a scenario that extends another one which has nothing there to take away.
REMOVED = ...
Path = Tuple[Union[str, int], ...]


class Fault(NamedTuple):
    """One fault of a document.

    Attributes:
        path: keys and list indices that lead to the value.  text: "found VALUE, allowed ...".
        cross: the fault is of this key together with others, which the text names.
    """

    path: Path
    text: str
    cross: bool = False

    def __str__(self) -> str:
        return f"{dotted(self.path)}: {self.text}"


def validate(schema: Mapping, value: Any, path: Path, faults: List[Fault]) -> None:
    """Adds the faults of a value to the list. Args: schema: JSON Schema.  path: of the value, for the faults."""
    wrong = _wrong(schema, value)
    if wrong:
        faults.append(Fault(path, f"found {shown(value)}, allowed {wrong}{_number_hint(value)}"))
        return
    if isinstance(value, Mapping):
        _validate_table(schema, value, path, faults)
    elif isinstance(value, (list, tuple)) and "items" in schema:
        for i, entry in enumerate(value):
            validate(schema["items"], entry, (*path, i), faults)
    for word in ("anyOf", "oneOf"):
        if word in schema:
            _validate_kinds(schema[word], value, path, faults, word == "oneOf")


def _wrong(schema, value):
    """Returns the allowed values instead of an invalid one, without checking entries; "" for a valid one."""
    if "type" in schema and not _TYPES[schema["type"]](value):
        return words(schema)
    for choices in (schema.get("enum"), [schema["const"]] if "const" in schema else None):
        if choices is not None and value not in choices:
            return one_of(map(flow, choices), value)
    if isinstance(value, str):
        if len(value) < schema.get("minLength", 0):
            return "a text that is not empty"
        if not re.search(schema.get("pattern", ""), value):
            return f"text like {schema['pattern']}"
    if isinstance(value, (list, tuple)) and not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", 1e9):
        return words(schema)
    if isinstance(value, Mapping) and len(value) < schema.get("minProperties", 0):
        return "a table of keys that is not empty"
    if is_number(value) and not (
            schema.get("minimum", value) <= value <= schema.get("maximum", value)
            and ("exclusiveMinimum" not in schema or value > schema["exclusiveMinimum"])
            and ("exclusiveMaximum" not in schema or value < schema["exclusiveMaximum"])):
        return words(schema)
    return ""


def _validate_table(schema, table, path, faults):
    properties, others = schema.get("properties", {}), schema.get("additionalProperties", True)
    for key in schema.get("required", ()):
        if table.get(key, REMOVED) is REMOVED:
            faults.append(Fault((*path, key), f"found nothing, allowed {words(properties.get(key, {}))} (required)"))
    for key, value in table.items():
        at = (*path, str(key))
        if key in properties:
            if value is not REMOVED:
                validate(properties[key], value, at, faults)
        elif isinstance(key, int) and value in (None, REMOVED):  # YAML reads `{a: 1,5}` as `{a: 1, 5: null}`
            faults.append(Fault(at, "found a key without a value, allowed a name; the decimal mark is a point"))
        elif isinstance(others, Mapping):
            validate(others, None if value is REMOVED else value, at, faults)
        elif not others:
            faults.append(Fault(at, f"found an unknown key, allowed {one_of(properties, key)}"))


def _validate_kinds(kinds, value, path, faults, one_only):
    """A value of which there are several kinds: tables are told apart by keys with a fixed value, others by type."""
    found: List[List[Fault]] = [[] for _ in kinds]
    for kind, list_ in zip(kinds, found):
        validate(kind, value, path, list_)
    fitting = sum(not list_ for list_ in found)
    if fitting == 1 or (fitting and not one_only):
        return
    if all(set(kind) == {"required"} for kind in kinds):
        keys = ", ".join(" with ".join(kind["required"]) for kind in kinds)
        faults.append(Fault(path, f"found {fitting} of these keys, allowed one{' or more' * (not one_only)} of {keys}"))
    elif fitting:
        faults.append(Fault(path, f"found {shown(value)}, which is of {fitting} kinds, allowed one of them"))
    else:
        told = [[fault for fault in list_ if fault.path == path or _fixes(kind, path, fault)]
                for kind, list_ in zip(kinds, found)]
        meant = [list_ for list_, apart in zip(found, told) if not apart]
        if meant:
            faults.extend(meant[0])
        elif isinstance(value, Mapping) and told[0][0].path != path:
            key = told[0][0].path[-1]
            allowed = one_of([flow(kind["properties"][key]["const"]) for kind in kinds], value.get(key))
            faults.append(Fault((*path, key), f"found {shown(value.get(key))}, allowed {allowed}"))
        else:
            allowed = " or ".join(dict.fromkeys(map(words, kinds)))
            choices = [flow(word) for kind in kinds for word in kind.get("enum", ())]
            near = "".join(one_of(choices, value).partition(";")[1:])  # ; did you mean ...
            faults.append(Fault(path, f"found {shown(value)}, allowed {allowed}{near}{_number_hint(value)}"))


def _fixes(kind, path, fault):
    """Whether the fault is in a key that has one value in this kind of table."""
    return len(fault.path) == len(path) + 1 and "const" in kind.get("properties", {}).get(fault.path[-1], {})


def is_number(value: Any) -> bool:
    """Returns whether a value is a finite number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return isfinite(value)
    except OverflowError:  # a whole number of some hundred digits
        return False


_TYPES = {"number": is_number, "integer": lambda value: is_number(value) and value == int(value),
          "string": lambda value: isinstance(value, str), "boolean": lambda value: isinstance(value, bool),
          "array": lambda value: isinstance(value, (list, tuple)), "object": lambda value: isinstance(value, Mapping)}


def _number_hint(value):
    """How a number is written that YAML takes for text: 5e-5 and 1,5."""
    if not isinstance(value, str):
        return ""
    if re.fullmatch(r"[+-]?\d+[eE][+-]?\d+", value):
        mantissa, exponent = re.split("[eE]", value)
        return f"; to YAML this is text, write {mantissa}.0e{int(exponent):+d}"
    return f"; the decimal mark is a point: {value.replace(',', '.')}" if re.fullmatch(r"[+-]?\d*,\d+", value) else ""


def words(schema: Mapping) -> str:
    """Returns the allowed values of a schema as text."""
    text = allowed_of(schema).replace("`", "")
    if "enum" in schema:
        return one_of(map(flow, schema["enum"]))
    if schema.get("type") == "object":
        return "a table of keys"
    if schema.get("type") in ("number", "integer"):
        number = "a finite number" if schema["type"] == "number" else "a whole number"
        return number if text[:1] == "a" else f"{number} {text.replace('whole ', '').replace(', ', ' and ')}"
    return text or "a value"


def shown(value: Any) -> str:
    """Returns a value as YAML has it, cut where it is long."""
    text = str(value) if isinstance(value, float) else "nothing" if value in (None, REMOVED) else flow(value)
    if isinstance(value, str) and re.fullmatch(r"[\d.,+\-eE\s]*|true|false|null|\s.*|.*\s", value):
        text = f"'{value}'"  # unquoted, YAML would read it as another type
    return text if len(text) <= MOST_SHOWN else text[:MOST_SHOWN - 3] + "..."


def dotted(path: Path) -> str:
    """Returns a path as text, e.g. sim.cameras[0].width."""
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return text[1:] or "scenario"
