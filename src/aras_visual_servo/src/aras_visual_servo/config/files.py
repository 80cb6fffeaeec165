"""Finds and reads files: scenarios, those of this package and of `package://` addresses. YAML is read strictly."""

import functools
import os
import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any, Dict, List, Optional, Union
from xml.etree import ElementTree

import yaml

from ..ground.errors import ParameterError
from ..ground.registry import one_of

PACKAGE = "aras_visual_servo"
MOST_BYTES = 4 * 2**20  # of a YAML file: a hundred times the largest of ours, read in a second or two
MOST_VALUES = 500_000   # in it
MOST_NESTED = 64        # sections within sections: ours go to 8


def load_yaml(path: Union[str, Path]) -> Dict[Any, Any]:
    """Reads a YAML file.

    Raises:
        ParameterError: the file cannot be read, is too big, is no YAML (with the line), or no mapping.
    """
    text = _text(path)
    try:
        _check_nesting(path, text)
        document = yaml.load(text, Loader=_UniqueKeyLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = mark.line if mark else 0
        indent = re.sub(r"\S.*", "", [*text.split("\n"), ""][line])
        tab = "found a tab in the indentation, allowed spaces" if "\t" in indent else ""
        raise ParameterError(f"{path}:{line + 1}: {tab or f'not YAML: {error.problem or error.context}'}") from error
    except yaml.YAMLError as error:
        raise ParameterError(f"{path}: not YAML: {error}") from error
    if not isinstance(document, dict):
        raise ParameterError(f"{path}: found {type(document).__name__}, allowed is a mapping of sections")
    return document


def _text(path):
    try:
        if not os.path.isfile(path):
            raise ParameterError(f"{path}: not a regular file")
        found = os.path.getsize(path)
        if found > MOST_BYTES:
            raise ParameterError(f"{path}: found {found} bytes, allowed <= {MOST_BYTES}")
        return Path(path).read_text(encoding="utf-8")
    except OSError as error:
        raise ParameterError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise ParameterError(f"{path}: not UTF-8: found the byte {error.object[error.start]:#04x} at position "
                             f"{error.start}") from error


def _check_nesting(path, text):
    """Raises ParameterError for a text with too many values or too deep nesting; values behind aliases count too.

    The functions that parse and check nested values are recursive, and without a limit the stack would overflow.
    """
    anchored, within = {}, []  # anchor -> (values, depth); the same of each section that is open, with its anchor
    for event in yaml.parse(text, Loader=yaml.CSafeLoader):
        anchor, values, depth = getattr(event, "anchor", None), 1, 1
        if isinstance(event, yaml.CollectionStartEvent):
            within.append([anchor, 1, 1])
        elif isinstance(event, yaml.CollectionEndEvent):
            anchor, values, depth = within.pop()
        elif isinstance(event, yaml.AliasEvent):
            if anchor not in anchored:
                raise ParameterError(f"{path}:{event.start_mark.line + 1}: *{anchor} stands for nothing that is before "
                                     "it")
            values, depth = anchored[anchor]
        elif not isinstance(event, yaml.ScalarEvent):
            continue
        if not isinstance(event, yaml.CollectionStartEvent):
            if anchor is not None:
                anchored[anchor] = values, depth
            if within:
                within[-1][1:] = within[-1][1] + values, max(within[-1][2], 1 + depth)
        for what, found, most in (("sections within sections", len(within) + depth - 1, MOST_NESTED),
                                  ("values", max(values, within[0][1] if within else 0), MOST_VALUES)):
            if found > most:
                raise ParameterError(f"{path}:{event.start_mark.line + 1}: found {found} {what}, allowed <= {most}")


def resolve_uri(uri: Union[str, Path], base: Optional[Path] = None, key: str = "file") -> Path:
    """Returns the path of `package://PACKAGE/REST`, `file://PATH`, an absolute path, or a path relative to `base`.

    Raises:
        ParameterError: no such package or file; the text starts with `key: ` unless that is "".
    """
    text, key = str(uri), f"{key}: " if key else ""
    if text.startswith("package://"):
        name, _, rest = text[len("package://"):].partition("/")
        folder = package_path(name)
        if folder is None:
            raise ParameterError(f"{key}found {text}, allowed a package beside this one or in ROS_PACKAGE_PATH: "
                                 f"{name} is neither")
        path = folder / rest
    else:
        path = Path(text[len("file://"):] if text.startswith("file://") else os.path.expanduser(text))
        if not path.is_absolute():
            path = Path(base or ".") / path
    if not path.is_file():
        raise ParameterError(f"{key}found {text}, allowed a file; no such file: {path}")
    return path


@functools.lru_cache(maxsize=None)
def _package_path(name, ros_package_path):
    folders = [Path(entry) for entry in ros_package_path.split(os.pathsep) if entry]
    for folder in folders + [share_dir().parent]:
        if (folder / name / "package.xml").is_file():
            return folder / name
    try:
        import rospkg  # the crawl through nested folders is slow: last
        return Path(rospkg.RosPack().get_path(name))
    except Exception:  # rospkg not installed, or ResourceNotFound: either way the package is not known
        return None


def package_path(name: str) -> Optional[Path]:
    """Returns the folder of a ROS package: in ROS_PACKAGE_PATH, else beside this package; None if unknown."""
    return _package_path(name, os.environ.get("ROS_PACKAGE_PATH", ""))


def package_paths(*names: str) -> Dict[str, str]:
    """Returns package name -> folder of the known ones, for `Simulation(package_paths=...)`."""
    names = names or ("aras_description", PACKAGE)
    return {name: str(package_path(name)) for name in names if package_path(name) is not None}


@functools.lru_cache(maxsize=None)
def share_dir() -> Path:
    """Returns the folder of this package's config: in the source tree, else PREFIX/share of the installed package."""
    for parent in Path(__file__).resolve().parents:
        if (parent / "package.xml").is_file() and (parent / "config").is_dir():
            return parent
        if (parent / "share" / PACKAGE / "config").is_dir():
            return parent / "share" / PACKAGE
    raise ParameterError(f"the config folder of {PACKAGE} is missing: the package is not installed whole")


@functools.lru_cache(maxsize=None)
def package_version(path: Optional[Path] = None) -> str:
    """Returns the `<version>` of a package.xml, by default of this package's; "unknown" if it names none."""
    try:
        version = ElementTree.parse(path or share_dir() / "package.xml").findtext("version")
    except (OSError, ElementTree.ParseError):
        version = None
    return version.strip() if version else "unknown"


def find_scenario(name_or_path: Union[str, Path]) -> Path:
    """Returns the path of a scenario given by name or path. Raises ParameterError: there is none."""
    text = os.path.expanduser(str(name_or_path))
    if os.sep in text or text.endswith((".yaml", ".yml")):
        if not os.path.isfile(text):
            raise ParameterError(f"scenario: found {text}, allowed a file: there is none of this name")
        return Path(text).resolve()
    if text in arm_names():
        return _arms() / text / "scenario.yaml"
    if text not in scenario_names():
        known = [*scenario_names(), *arm_names()]
        raise ParameterError(f"scenario: found {text}, allowed the path of a file or {one_of(known, text)}")
    return share_dir() / "config" / "scenarios" / f"{text}.yaml"


def scenario_names() -> List[str]:
    """Returns the names of the scenarios that come with the package, sorted; arms have names of their own."""
    return sorted(path.stem for path in (share_dir() / "config" / "scenarios").glob("*.yaml"))


def arm_names() -> List[str]:
    """Returns the names of the arms of aras_description, sorted. Each runs as a scenario of its name."""
    return sorted(path.parent.name for path in _arms().glob("*/scenario.yaml"))


def _arms():
    return (package_path("aras_description") or Path()) / "arms"


class _UniqueKeyLoader(yaml.CSafeLoader):
    """CSafeLoader, ten times as fast as SafeLoader, that refuses a key given twice: YAML would silently take the
    last. It rejects values without a Python counterpart (the 99th day of a month), with the line."""

    def construct_object(self, node, deep=False):
        try:
            return super().construct_object(node, deep=deep)
        except (ValueError, TypeError, ArithmeticError, AttributeError, LookupError) as error:
            raise yaml.constructor.ConstructorError(None, None, f"a value that does not exist: {error}",
                                                    node.start_mark) from error

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key_node, _ in node.value if isinstance(node, yaml.MappingNode) else ():  # super rejects another node
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                raise yaml.constructor.ConstructorError(None, None, "a key must be a text, found a section or a list",
                                                        key_node.start_mark)
            if key in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key '{key}' is given twice", key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep=deep)
