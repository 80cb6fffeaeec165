"""Sections as JSON Schema (draft 7, with our own `unit`). Scenarios are checked and documented with it.

The schemas of this package are made from settings classes. Other packages ship theirs as YAML, schema/NAME.yaml, with
the keywords that aras_visual_servo_common/README.md lists; `$ref: other` stands for another file of the folder.
"""

import copy
import functools
from collections.abc import Mapping
from dataclasses import is_dataclass
from math import inf
from typing import Any, Dict

import yaml

from ..ground.errors import ParameterError
from .files import package_path
from .settings import Key, entry_type, is_table, keys_of, required_keys

_TYPES = {float: "number", int: "integer", bool: "boolean", str: "string"}


@functools.lru_cache(maxsize=None)
def schema_of(cls: type) -> Dict[str, Any]:
    """Returns the schema of a section, the keys in the order in which the settings class describes them."""
    keys = keys_of(cls)
    return {"type": "object", "additionalProperties": False, "required": [key.name for key in keys if key.required],
            "properties": {key.name: property_of(key) for key in keys}}


def with_sections(schema: Mapping, sections: Mapping[str, type]) -> Dict[str, Any]:
    """Returns the schema of a section, with further sections in it by name."""
    more: Dict[str, Any] = {
        name: {"description": (cls.__doc__ or "").strip().split("\n", 1)[0], **schema_of(cls),
               **({} if required_keys(cls) else {"default": {}})} for name, cls in sections.items()}
    return {**schema, "properties": {**schema["properties"], **more}}


def yaml_section(package: str, name: str) -> Dict[str, Any]:
    """Returns the schema of a section that another package describes. Raises ParameterError: there is no such file."""
    folder = package_path(package)
    if folder is None:
        raise ParameterError(f"schema {package}/{name}: the package is neither beside this one nor in ROS_PACKAGE_PATH")
    return _section(folder / "schema", name, ())


@functools.lru_cache(maxsize=None)
def _section(folder, name, way):
    path = folder / f"{name}.yaml"
    if name in way or not path.is_file():
        fault = "leads in a circle" if name in way else "there is no such file"
        raise ParameterError(f"schema {' -> '.join((*way, name))}: {fault}: {path}")
    with open(path, encoding="utf-8") as stream:
        content = yaml.load(stream, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))
    return _in_place(content, folder, (*way, name))


def _in_place(node, folder, way):
    """The same with each $ref replaced by the file it names; keys beside a $ref take precedence over those of the
    file."""
    if isinstance(node, list):
        return [_in_place(entry, folder, way) for entry in node]
    if not isinstance(node, dict):
        return node
    rest = {key: _in_place(value, folder, way) for key, value in node.items() if key != "$ref"}
    return {**_section(folder, node["$ref"], way), **rest} if isinstance(node.get("$ref"), str) else rest


def property_of(key: Key) -> Dict[str, Any]:
    """Returns the schema of one key."""
    schema: Dict[str, Any] = {"description": key.help}
    if key.unit:
        schema["unit"] = key.unit
    if is_table(key):
        schema.update({"type": "object", **({"minProperties": 1} if key.not_empty else {}),
                       "additionalProperties": _type(key, entry_type(key.type))})
    else:
        schema.update(_type(key, key.type))
    if not key.required and key.default not in (None, inf):
        schema["default"] = instance_value(key.default)
    return schema


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
    found = {"type": _TYPES.get(kind), "exclusiveMinimum": key.above, "minimum": key.at_least,
             "exclusiveMaximum": key.below, "maximum": key.at_most,
             "minLength": 1 if kind is str and key.not_empty else None}
    return {word: value for word, value in found.items() if value is not None}


def instance_value(value: Any) -> Any:
    """Returns a default or another value of a settings class as YAML and JSON have it."""
    if is_dataclass(value):
        return {key.name: instance_value(getattr(value, key.name))
                for key in keys_of(type(value))  # type: ignore[arg-type]
                if getattr(value, key.name) not in (None, inf)}
    if isinstance(value, dict):
        return {name: instance_value(entry) for name, entry in value.items()}
    return [instance_value(entry) for entry in value] if isinstance(value, tuple) else copy.copy(value)
