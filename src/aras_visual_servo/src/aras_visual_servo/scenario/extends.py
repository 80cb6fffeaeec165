"""Scenarios that extend others, and the file and line of each value.

`extends: experiment_1` names a scenario of this package, `extends: PATH.yaml` a file, relative to the one that says so.
In a list, `extends: [ur5e, six_dof_points]`, an earlier entry overrides the later ones, as with the base classes of a
Python class. The rules are those of a JSON Merge Patch (RFC 7396) and two more of our own, see
`merge`. A file that names a URDF does not inherit numbers by joint (goal, start) of joints that this robot lacks.

An arm is a scenario with a `task`: the scenario that it runs where none is named. `robot: ur5e` puts an arm first in
the list.
"""

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple
from xml.etree import ElementTree

import yaml

from ..arm import free_camera
from ..config.files import find_scenario, load_yaml, resolve_uri
from ..config.plugins import placed
from ..config.settings import keys_of
from ..config.tables import flow
from ..config.validate import REMOVED, Fault, shown
from ..features.base import expand
from ..ground.errors import ParameterError
from ..servo.settings import ServoSettings
from .schema import SECTIONS

#: Not inherited: a scenario has a name and a description of its own.
OWN = ("name", "description", "extends")
#: Key of an arm: the scenario beneath it, where the arm is not put over another one.
TASK = "task"
#: Keys that name a file; in a scenario that is extended from another folder they stay relative to their own.
FILE_KEYS = ("urdf", "controllers", "file", "mesh")
_BY_FEATURE = tuple(key.name for key in keys_of(ServoSettings) if key.by == "feature")


def _by_joint(cls, path):
    """Paths of the tables of a settings class that are given by joint."""
    for key in keys_of(cls):
        if key.by.startswith("joint"):
            yield (*path, key.name)
        elif is_dataclass(key.type):
            yield from _by_joint(key.type, (*path, key.name))


_SECTIONS: Dict[str, type] = {"servo": ServoSettings, **SECTIONS}
_BY_JOINT = (("sim", "initial_positions"), *(path for name, section in _SECTIONS.items()
                                             for path in _by_joint(section, (name,))))
_KEY = re.compile(r"[A-Za-z_]\w*(?:\.\w+)*")


def load_resolved(path: Path, robot: Optional[str] = None) -> Tuple[Dict[str, Any], List[Path]]:
    """Reads a scenario file with everything that it extends in place.

    Args:
        robot: name or path of an arm that takes the place of the scenario's. A scenario that extends this arm stays as
            it is, and `real` of one that extends no arm overrides that of the arm.
    Returns:
        (document, files): nested dict without `extends`, `task` and names of arms, with marks as of `merge`; the files
            that it is made of, the first extended one first.
    Raises:
        ParameterError: a file cannot be read, a name is unknown, or scenarios extend each other in a cycle.
    """
    path = Path(path)
    document, files = _load(path, ())
    where = f"--set robot={robot}"
    if robot is not None and _found(robot, where, Path()) not in [file.resolve() for file in files]:
        own = {"name": document.get("name"), "description": document.get("description", "")}
        real = document.get("real")
        if real is not None and any(TASK in load_yaml(file) for file in files):
            real = None
        document, files = _extended([(where, robot)], document, files, Path(), (), arm=True)
        document.update(own, name=f"{document.get('name')}_{own['name']}")
        if real is not None:
            document["real"] = _merged(document.get("real"), real)
    way = tuple(file.resolve() for file in files)
    while TASK in document:
        where, beneath = f"{path}: {TASK}", document.pop(TASK)
        found = _found(beneath, where, path.parent)
        if found in way:
            raise ParameterError(f"{where}: found {shown(beneath)}, allowed a scenario that does not lead back here")
        way = (*way, found)
        base, its = _load(found, way)
        document, files = _over(document, anchored(base, found.parent), path.parent), [*its, *files]
    return document, files


def _load(path, way):
    document = with_places(load_yaml(path), path.parent)
    if isinstance(document.get(TASK), str) and _is_path(document[TASK]):
        document[TASK] = os.path.join(path.parent, os.path.expanduser(document[TASK]))
    arm = document["robot"] if isinstance(document.get("robot"), str) else None
    if "extends" not in document and arm is None:
        return document, [path]
    lines = _lines(path)
    base = document.get("extends", [])
    several = isinstance(base, list) and (base or arm)
    bases = [(f"{path}:{lines[('extends', i) if several else ('extends',)]}: extends", name)
             for i, name in enumerate(base if several else [base])]
    merged: Dict[str, Any] = {}
    files: List[Path] = []
    if bases:
        merged, files = _extended(bases, merged, files, path, way)
    if arm is not None:
        del document["robot"]
        merged, files = _extended([(f"{path}:{lines[('robot',)]}: robot", arm)], merged, files, path, way, arm=True)
    return _over(document, merged, path.parent), [*files, path]


def _extended(bases, merged, files, path, way, arm=False):
    """Returns `merged` over the resolved `bases`, pairs (where, name), and the files with those of the bases."""
    way, whole = (*way, path.resolve()), bool(merged) and TASK not in merged
    for where, name in reversed(bases):
        found = _found(name, where, path.parent)
        if found in way:
            circle = [*way[way.index(found):], found]
            raise ParameterError(f"{where}: leads in a circle, {' -> '.join(file.stem for file in circle)}")
        extended, its = _load(found, way)
        if arm and TASK not in extended:
            raise ParameterError(f"{where}: found {shown(name)}, allowed the name of an arm or the path of its "
                                 f"scenario: this one has no `{TASK}`")
        whole = whole or TASK not in extended
        if found.parent != path.resolve().parent:
            extended = anchored(extended, found.parent)
        merged, files = _over(extended, merged, found.parent), [*files, *its]
    return {key: value for key, value in merged.items() if not (whole and key == TASK)}, files


def _is_path(name):
    return os.sep in name or name.endswith((".yaml", ".yml"))


def _found(base, where, folder):
    """The path of an extended scenario. Raises ParameterError: the value is no name, or there is no such scenario."""
    if not isinstance(base, str) or not base:
        raise ParameterError(f"{where}: found {shown(base)}, allowed the name of a scenario or the path of a file, or "
                             "a list of these")
    if _is_path(base):
        base = os.path.join(folder, os.path.expanduser(base))
    try:
        return find_scenario(base).resolve()
    except ParameterError as error:
        raise ParameterError(f"{where}: {error}") from None


def _over(document, base, folder):
    """`merge`, and numbers of joints that the robot of `document` lacks go."""
    merged = merge(base, document)
    joints = _joints_of(document, folder)
    if joints:
        for table in _BY_JOINT:
            _keep(merged, document, table, joints)
    return merged


def _joints_of(document, folder):
    """Names of all joints of the robot that a scenario file names; () where it names none, or its URDF is unreadable,
    which is reported elsewhere."""
    robot = document.get("robot")
    try:
        joints = list(ElementTree.parse(resolve_uri(robot["urdf"], folder)).iter("joint"))
    except (ParameterError, OSError, ElementTree.ParseError, TypeError, KeyError):
        return ()
    floating = any(joint.get("type") == "floating" for joint in joints)
    return {*(joint.get("name") for joint in joints), *(free_camera.NAMES if floating else ())}


def _keep(node, said, path, names):
    """Keeps of the table at a path the entries of these names and those that are `said`; removes it if none is left."""
    if not isinstance(node, dict):
        return
    said = said if isinstance(said, dict) else {}
    if not path:
        for name in [name for name in node if name not in names and name not in said]:
            del node[name]
    elif node.get(path[0]):
        _keep(node[path[0]], said.get(path[0]), path[1:], names)
        if node[path[0]] == {}:
            del node[path[0]]


def cleared(node: Any) -> Any:
    """Returns a document without the marks of nulls that took nothing away."""
    if isinstance(node, dict):
        return {key: cleared(value) for key, value in node.items() if value is not REMOVED}
    return [cleared(value) for value in node] if isinstance(node, list) else node


def merge(base: Mapping[str, Any], changes: Mapping[str, Any]) -> Dict[str, Any]:
    """Returns a new document: `base` with `changes` applied. Changes neither argument.

    Sections are merged key by key; `null` takes a key away; any other value, a list too, replaces the old one.
    Two rules more: in lists whose entries all have a `name` (cameras, models) the entries are merged by name, and new
    ones come last; and where `servo.features` changes, numbers by feature (gains, thresholds) of features that are
    no longer used go with them. REMOVED stands for each null that took nothing away: at an unknown key it is a fault.
    """
    result = _merged({key: value for key, value in base.items() if key not in OWN},
                     {key: value for key, value in changes.items() if key != "extends"})
    servo, changed = result.get("servo"), changes.get("servo")
    if isinstance(servo, dict) and isinstance(changed, dict) and isinstance(changed.get("features"), list):
        used = set(map(str, expand(changed["features"])))
        for table in _BY_FEATURE:
            given = changed[table] if isinstance(changed.get(table), dict) else {}
            if isinstance(servo.get(table), dict):
                servo[table] = {name: value for name, value in servo[table].items()
                                if name in given or used.issuperset(expand([name]))}
    return {key: result[key] for key in (*(key for key in OWN if key in result), *result)}


def _merged(base, changes):
    if isinstance(base, dict) and isinstance(changes, dict):
        both = {key: _merged(base.get(key), REMOVED if value is None else value) for key, value in changes.items()
                if value is not None or base.get(key, REMOVED) is REMOVED}
        return {**{key: value for key, value in base.items() if key not in changes or key in both}, **both}
    if isinstance(changes, dict):
        return _merged({}, changes)
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


def anchored(node: Any, folder: Path, key: str = "") -> Any:
    """Returns the same with names of files that are relative to `folder` made absolute."""
    if isinstance(node, dict):
        return {name: anchored(value, folder, name) for name, value in node.items()}
    if isinstance(node, list):
        return [anchored(value, folder) for value in node]
    if key in FILE_KEYS and isinstance(node, str) and (folder / node).is_file():
        return str(folder / node)
    return node


def with_places(document: Dict[str, Any], folder: Path) -> Dict[str, Any]:
    """Returns the scenario with the absolute folders of plugins, which are looked for in `folder` first."""
    servo = document.get("servo") if isinstance(document, dict) else None
    if not isinstance(servo, dict) or not isinstance(servo.get("plugins"), list):
        return document
    plugins = [placed(name, folder) if isinstance(name, str) else name for name in servo["plugins"]]
    return {**document, "servo": {**servo, "plugins": plugins}}


def located(faults: Iterable[Fault], document: Any, files: Sequence[Path], overrides: Mapping[str, Any] = {},
            source: str = "scenario") -> List[str]:
    """Returns the faults as texts `FILE:LINE: fault`, or `--set KEY=VALUE: fault`, in the order in which they stand.

    A fault is located at its key, or at the section in which the key is missing. A fault of several keys is located at
    the key set last: a scenario overrides those that it extends, and `--set` overrides both.

    Args:
        document: the resolved one, to which the faults belong.  files: that it is made of, the last one wins.
        overrides: values set by dotted key.  source: stands for a document without file.
    """
    said = {}  # place -> (rank, line, text)
    for rank, file in enumerate(files):
        said.update({place: (rank, line, f"{file}:{line}") for place, line in _lines(file).items()})
    for key, value in overrides.items():
        place = tuple(key.split("."))
        said = {other: what for other, what in said.items() if other[:len(place)] != place}
        said[place] = len(files), 0, f"--set {key}={flow(value)}"
    nowhere = (len(files) - 1, 1, f"{files[-1]}:1") if files else (-1, 0, source)

    def origin(fault):
        place = _by_name(fault.path, document)
        places = [place[:n] for n in range(len(place), 0, -1)]
        found = [next((said[above] for above in places if above in said), nowhere)]
        for word in _KEY.findall(fault.text if fault.cross else ""):
            key = tuple(word.split("."))
            found += [said[above + key] for above in (places[1:] if len(key) == 1 else [()]) if above + key in said]
        return max(found, key=lambda entry: entry[0])

    placed = sorted(((origin(fault), fault) for fault in faults), key=lambda pair: pair[0][:2])
    return [f"{where}: {fault}" for (_, _, where), fault in placed]


def _by_name(path, document):
    """The path, with entries of lists by name where they have one."""
    result, node = [], document
    for part in path:
        entry = isinstance(part, int) and isinstance(node, list) and part < len(node)
        result.append(f"[{node[part]['name']}]" if entry and _named(node) else part)
        node = node[part] if entry else node.get(part) if isinstance(node, dict) else None
    return tuple(result)


def _lines(file):
    """Place -> line of every key and entry of a YAML file; entries that have a name by their name."""
    def walk(node, place):
        if isinstance(node, yaml.MappingNode):
            for key, value in node.value:
                at = (*place, str(key.value))
                yield at, key.start_mark.line + 1
                yield from walk(value, at)
        elif isinstance(node, yaml.SequenceNode):
            names = [next((value.value for key, value in entry.value if key.value == "name"), None)
                     if isinstance(entry, yaml.MappingNode) else None for entry in node.value]
            named = all(names) and len(set(names)) == len(names)
            for i, entry in enumerate(node.value):
                at = (*place, f"[{names[i]}]" if named else i)
                yield at, entry.start_mark.line + 1
                yield from walk(entry, at)
    with open(file, encoding="utf-8") as stream:
        return dict(walk(yaml.compose(stream, Loader=yaml.CSafeLoader), ()))
