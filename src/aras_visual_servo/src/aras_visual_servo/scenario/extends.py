"""Scenarios that say only in what they differ from another one, and the lines of files that say it.

`extends: experiment_1` names a scenario of this package, `extends: PATH.yaml` a file, relative to the one that says so.
The rules are those of a JSON Merge Patch (RFC 7396) and two more of our own, see `merge`.
"""

import os
import re
from pathlib import Path

import yaml

from ..config.files import load_yaml
from ..config.settings import keys_of
from ..features.base import expand
from ..ground.errors import ParameterError
from ..servo.settings import ServoSettings
from .files import find_scenario

#: Not inherited: a scenario has a name and a description of its own.
OWN = ("name", "description", "extends")
#: Keys that name a file; in a scenario that is extended from another folder they stay relative to their own.
FILE_KEYS = ("urdf", "controllers", "file", "mesh")
_BY_FEATURE = tuple(key.name for key in keys_of(ServoSettings) if key.by == "feature")
_PLACE = re.compile(r"[^\s:]+(?=: )")


def load_resolved(path):
    """A scenario file with everything that it extends in place.

    Returns:
        (document, files): nested dict without `extends`; the files that it is made of, the first extended one first.
    Raises:
        ParameterError: a file cannot be read, nobody knows the name, or the way leads in a circle.
    """
    return _load(Path(path), ())


def _load(path, way):
    document = load_yaml(path)
    if "extends" not in document:
        return document, [path]
    where = f"{path}:{_line_of(path, 'extends')}: extends"
    base = document["extends"]
    if not isinstance(base, str) or not base:
        raise ParameterError(f"{where}: found {base!r}, allowed is the name of a scenario or the path of a file")
    if os.sep in base or base.endswith((".yaml", ".yml")):
        base = os.path.join(path.parent, os.path.expanduser(base))
    try:
        found = find_scenario(base).resolve()
    except ParameterError as error:
        raise ParameterError(f"{where}: {error}") from None
    way = (*way, path.resolve())
    if found in way:
        circle = [*way[way.index(found):], found]
        raise ParameterError(f"{where}: leads in a circle, {' -> '.join(file.stem for file in circle)}")
    extended, files = _load(found, way)
    if found.parent != path.resolve().parent:
        extended = anchored(extended, found.parent)
    return merge(extended, document), [*files, path]


def merge(base, changes):
    """What `base` becomes by `changes`, a new document. Neither is changed.

    Sections are merged key by key; `null` takes a key away; any other value, a list too, replaces the old one.
    Two rules more: in lists whose entries all have a `name` (cameras, models) the entries are merged by name, and new
    ones come last; and where `servo.features` changes, numbers by feature (gains, thresholds) of features that are
    no longer used go with them.
    """
    result = _merged({key: value for key, value in base.items() if key not in OWN},
                     {key: value for key, value in changes.items() if key != "extends"})
    servo, changed = result.get("servo"), changes.get("servo")
    if isinstance(servo, dict) and isinstance(changed, dict) and isinstance(changed.get("features"), list):
        used = set(expand(changed["features"]))
        for table in _BY_FEATURE:
            given = changed.get(table) if isinstance(changed.get(table), dict) else {}
            if isinstance(servo.get(table), dict):
                servo[table] = {name: value for name, value in servo[table].items()
                                if name in given or used.issuperset(expand([name]))}
    return {key: result[key] for key in (*(key for key in OWN if key in result), *result)}


def _merged(base, changes):
    if isinstance(base, dict) and isinstance(changes, dict):
        both = {key: _merged(base.get(key), value) for key, value in changes.items() if value is not None}
        return {**{key: value for key, value in base.items() if key not in changes or key in both}, **both}
    if isinstance(changes, dict):
        return {key: _merged(None, value) for key, value in changes.items() if value is not None}
    if _named(base) and _named(changes):
        known, new = {entry["name"]: entry for entry in base}, {entry["name"]: entry for entry in changes}
        return [_merged(entry, new.get(name, {})) for name, entry in known.items()] + \
            [entry for name, entry in new.items() if name not in known]
    return changes


def _named(entries):
    """Whether these are entries that are told apart by a name."""
    if not isinstance(entries, list) or not entries:
        return False
    names = [entry.get("name") if isinstance(entry, dict) else None for entry in entries]
    return all(isinstance(name, str) for name in names) and len(set(names)) == len(names)


def anchored(node, folder, key=None):
    """The same with names of files that are relative to `folder` made absolute."""
    if isinstance(node, dict):
        return {name: anchored(value, folder, name) for name, value in node.items()}
    if isinstance(node, list):
        return [anchored(value, folder) for value in node]
    if key in FILE_KEYS and isinstance(node, str) and (folder / node).is_file():
        return str(folder / node)
    return node


def with_lines(faults, files, document):
    """The same faults, `FILE:LINE: fault` each: the line that says the key, else that of the section it should be in.

    Args:
        faults: texts `dotted.path: what is wrong`.  files: that the document is made of, the last one wins.
        document: the resolved one, to which the paths belong.
    """
    said = {}  # place -> (file, line), entries of lists by name
    for file in files:
        said.update({place: (file, line) for place, line in _lines(file).items()})
    places = dict(_places(document, "", ""))  # place as faults write it -> as `said` has it
    result = []
    for fault in faults:
        match = _PLACE.match(fault)
        place = match[0] if match else ""
        while place and said.get(places.get(place)) is None:
            place = re.sub(r"(\.[^.\[\]]*|\[\d+\]|^[^.\[\]]+)$", "", place)
        file, line = said.get(places.get(place), (files[-1], 1))
        result.append(f"{file}:{line}: {fault}")
    return result


def _places(node, place, by_name):
    yield place, by_name
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _places(value, f"{place}.{key}".lstrip("."), f"{by_name}.{key}".lstrip("."))
    elif isinstance(node, list):
        named = _named(node)
        for i, value in enumerate(node):
            yield from _places(value, f"{place}[{i}]", f"{by_name}[{value['name'] if named else i}]")


def _lines(file):
    """Place -> line of every key and entry of a YAML file; entries that have a name by their name."""
    def walk(node, place):
        if isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                at = f"{place}.{key.value}".lstrip(".")
                yield at, key.start_mark.line + 1
                yield from walk(value, at)
        elif isinstance(node, yaml.SequenceNode):
            names = [next((value.value for key, value in entry.value if key.value == "name"), None)
                     if isinstance(entry, yaml.MappingNode) else None for entry in node.value]
            named = all(names) and len(set(names)) == len(names)
            for i, entry in enumerate(node.value):
                at = f"{place}[{names[i] if named else i}]"
                yield at, entry.start_mark.line + 1
                yield from walk(entry, at)
    with open(file, encoding="utf-8") as stream:
        return dict(walk(yaml.compose(stream, Loader=yaml.CSafeLoader), ""))


def _line_of(file, place):
    return _lines(file).get(place, 1)
