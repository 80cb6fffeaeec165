"""Settings classes as JSON Schema (draft 7, with our own `unit`): what a scenario is checked against, and documented by."""

import copy
from dataclasses import is_dataclass
from math import inf

from .settings import entry_type, is_table, keys_of

_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string"}
_BOUNDS = {">": "exclusiveMinimum", ">=": "minimum", "<": "exclusiveMaximum", "<=": "maximum"}


def schema_of(cls):
    """Schema of a section, dict, the keys in the order in which the settings class describes them."""
    keys = keys_of(cls)
    return {"type": "object", "additionalProperties": False, "required": [key.name for key in keys if key.required],
            "properties": {key.name: _property(key) for key in keys}}


def with_sections(schema, sections):
    """The schema of a section, with further sections in it: name -> settings class."""
    more = {name: {"description": first_line(cls), **schema_of(cls)} for name, cls in sections.items()}
    return {**schema, "properties": {**schema["properties"], **more}}


def first_line(cls):
    """First line of its docstring."""
    return (cls.__doc__ or "").strip().split("\n", 1)[0]


def _property(key):
    schema = {"description": key.help}
    if key.unit:
        schema["unit"] = key.unit
    schema.update(_table(key) if is_table(key) else _type(key, key.type))
    if not key.required and key.default not in (None, inf):
        schema["default"] = _plain(key.default)
    return schema


def _table(key):
    """Of entries by name."""
    return {"type": "object", **({"minProperties": 1} if key.not_empty else {}),
            "additionalProperties": _type(key, entry_type(key.type))}


def _type(key, kind):
    if is_dataclass(kind):
        schema = schema_of(kind)
        return {**schema, "minProperties": 1} if key.not_empty else schema
    entries = entry_type(kind)
    if entries is not None:
        size = {} if key.size is None else {"minItems": key.size, "maxItems": key.size}
        return {"type": "array", "items": {**_type(key, entries), **({"minLength": 1} if entries is str else {})},
                **({"minItems": 1} if key.not_empty else {}), **size}
    if key.choices:
        return {"enum": list(key.choices)}
    bounds = {_BOUNDS[sign]: bound for sign, bound in key.bounds}
    text = {"minLength": 1} if kind is str and key.not_empty else {}
    return {} if kind is object else {"type": _TYPES[kind], **bounds, **text}


def _plain(value):
    """A default as YAML and JSON have it."""
    if is_dataclass(value):
        return {key.name: _plain(getattr(value, key.name)) for key in keys_of(type(value))
                if getattr(value, key.name) not in (None, inf)}
    if isinstance(value, dict):
        return {name: _plain(entry) for name, entry in value.items()}
    return [_plain(entry) for entry in value] if isinstance(value, tuple) else copy.copy(value)
