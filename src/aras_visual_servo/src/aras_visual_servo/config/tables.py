"""Tables of keys for people, in Markdown, made from the schema of a section (config/schema.py)."""

import re
from types import MappingProxyType
from typing import Any, List, Mapping

#: Words of allowed_of -> those of the tables.
TYPES = {"true, false": "boolean", "a text": "string", "texts": "strings", "a whole number": "integer",
         "whole numbers": "integers", "whole": "integer", "a number": "number"}
HEAD = ("| key | default | allowed | meaning |", "|---|---|---|---|")


def table_of(schema: Mapping[str, Any], others: Mapping[str, Mapping[str, Any]] = MappingProxyType({})) -> List[str]:
    """Returns the lines of the table of a section.

    Args: schema: of the section.  others: name -> schema of the other tables. A part with the keys of one of them is
        one row, which names that table.
    """
    parts = [(name, section_of(other).get("properties")) for name, other in others.items() if other is not schema]
    return [*HEAD, *(f"| {' | '.join(row)} |" for row in _rows(section_of(schema), "", parts))]


def part_of(sections: Mapping[str, Any], name: str) -> Any:
    """Schema of "section", "section.key" ..., of a list that of its entries; None if there is no such thing."""
    first, *keys = name.split(".")
    schema = sections.get(first)
    for key in keys:
        schema = section_of(schema or {}).get("properties", {}).get(key)
    return schema


def section_of(schema: Mapping[str, Any]) -> Any:
    """The schema that has the keys: the given one, that of a list's or table's entries, or all kinds put together."""
    schema = schema.get("items", {}) if schema.get("type") == "array" else schema
    if isinstance(schema.get("additionalProperties"), dict):
        schema = section_of(schema["additionalProperties"])
    kinds = [kind for kind in schema.get("oneOf", schema.get("anyOf", ())) if "properties" in kind]
    if not kinds:
        return schema
    properties = {}
    for key in dict.fromkeys(key for kind in kinds for key in kind["properties"]):
        with_key = [kind for kind in kinds if key in kind["properties"]]
        found = dict(with_key[0]["properties"][key])
        if "const" in found:
            found["enum"] = list(dict.fromkeys(kind["properties"][key].get("const") for kind in with_key))
            del found["const"]
        without = [kind for kind in kinds if key not in kind["properties"]]
        few, word = (without, "Except with") if len(without) < len(with_key) else (with_key, "With")
        only = [_told_by(kind) for kind in few] if without else []
        if only and all(only):
            found["description"] = f"{word} {' or '.join(only)}: {found.get('description', '')}"
        needed = sum(key in kind.get("required", ()) for kind in with_key)
        properties[key] = {**found, "needed": needed == len(with_key)}
    return {"properties": properties, "required": [key for key, found in properties.items() if found.pop("needed")]}


def _told_by(kind):
    """`key: value` of the key that tells this kind from the others, "" without."""
    fixed = [(key, value["const"]) for key, value in kind["properties"].items() if "const" in value]
    return f"`{fixed[0][0]}: {fixed[0][1]}`" if fixed else ""


def _escaped(text):
    """Words of a cell: a bar does not end it, and <name> is no tag, which a browser would hide."""
    return re.sub(r"(`[^`]*`)|<", lambda match: match[1] or "\\<", text.replace("|", "\\|"))


def _rows(schema, before, parts):
    """Cells of a row for each key, the required ones first, those of a section after the section's own."""
    required = schema.get("required", ())
    properties = schema.get("properties", {})
    for key in sorted(properties, key=lambda key: key not in required):
        found, name = properties[key], before + key
        inner = section_of(found)
        table = next((other for other, keys in parts if keys and keys == inner.get("properties")), "")
        meaning = " ".join(filter(None, (found.get("description", ""), table and f"Keys: table `{table}`.")))
        yield f"`{name}`", _default(found, inner, key in required), _range(found), _escaped(meaning)
        if "properties" in inner and not table:
            by_name = isinstance(found.get("additionalProperties"), dict)
            entry = "[]" if found.get("type") == "array" else ".NAME" if by_name else ""
            yield from _rows(inner, f"{name}{entry}.", parts)


def _range(found):
    """What is allowed: a type, or bounds as intervals with the unit behind them."""
    text = allowed_of(found)
    for word, name in TYPES.items():
        text = re.sub(rf"(?<!`)\b{word}\b(?!`)", name, text)
    for least, left in ((">=", "["), (">", "(")):
        for most, right in (("<=", "]"), ("<", ")")):
            text = re.sub(rf"{least} (\S+), {most} (\S+)", rf"{left}\1, \2{right}", text)
    text, unit = re.sub(r"(numbers|integer) ([\[(])", r"\1 in \2", text), found.get("unit", "").replace(", ", " or ")
    return (" " if re.search(r"[])\d]$", text) else ", ").join(filter(None, (text, unit)))


def _default(found, inner, required):
    if required:
        return "required"
    if "properties" in inner and isinstance(found.get("default", {}), dict):
        own = {key: value["default"] for key, value in inner["properties"].items() if "default" in value}
        given = {**own, **found.get("default", {})}
        return f"`{flow(given)}`" if given != own else "as below" if "default" in found else "off"
    if found.get("default") in (None, {}, [], ""):
        return "none"
    text = flow(found["default"])
    return f"`{text}`" if isinstance(found["default"], (str, list, dict)) else text


def flow(value: Any) -> str:
    """As YAML has it, in one line."""
    if isinstance(value, bool) or value is None:
        return "null" if value is None else str(value).lower()
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(entry)}" for key, entry in value.items()) + "}"
    return f"[{', '.join(map(flow, value))}]" if isinstance(value, list) else str(value)


def allowed_of(schema: Mapping[str, Any]) -> str:
    """In a few words."""
    if "enum" in schema:
        return ", ".join(f"`{flow(value)}`" for value in schema["enum"])
    if "const" in schema:
        return f"`{flow(schema['const'])}`"
    kinds = schema.get("oneOf", schema.get("anyOf"))
    if kinds:
        texts = [*dict.fromkeys(filter(None, map(allowed_of, kinds)))]
        sections = ["a section"] * any("properties" in each for each in kinds)
        return " or ".join([*texts, *sections] if texts else [])
    kind = schema.get("type", "")
    if kind == "array":
        return _list(schema)
    if kind == "object":
        entries = schema.get("additionalProperties")
        return f"{allowed_of(entries)} by name" if isinstance(entries, dict) and allowed_of(entries) else ""
    words = {"number": "a number", "integer": "a whole number", "boolean": "true, false", "string": "a text"}
    bounds = _bounds(schema)
    return f"{'whole ' * (kind == 'integer')}{bounds}" if bounds else words.get(kind, "")


def _list(schema):
    entries, least, most = schema.get("items", {}), schema.get("minItems"), schema.get("maxItems")
    size = str(least) if least is not None and least == most else f"at most {most}" if most is not None else "a list of"
    names = {"number": "numbers", "integer": "whole numbers", "string": "texts", "array": "lists", "object": "sections"}
    of = names.get(entries.get("type"), "")
    if entries.get("type") == "array":
        of = f"lists, each {_list(entries)}"
    return " ".join(filter(None, (size, of, _bounds(entries)))) if of else ""


def _bounds(schema):
    signs = (("exclusiveMinimum", ">"), ("minimum", ">="), ("exclusiveMaximum", "<"), ("maximum", "<="))
    return ", ".join(f"{sign} {flow(schema[word])}" for word, sign in signs if word in schema)
