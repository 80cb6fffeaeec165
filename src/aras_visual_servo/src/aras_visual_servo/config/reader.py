"""Reads a section of a scenario into its settings class; all faults are collected and raised in one ParameterError."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import is_dataclass
from typing import Any, Callable, List, NamedTuple, Optional, Set, Tuple, Type, TypeVar

from ..ground.errors import ParameterError
from ..ground.registry import one_of
from .schema import instance_value, property_of, schema_of
from .settings import entry_type, is_table, keys_of
from .validate import REMOVED, Fault, Path, shown, validate

T = TypeVar("T")
_KEYED = re.compile(r"([^\s:]+): (.*)", re.DOTALL)


class Names(NamedTuple):
    """Names of features and joints of one scenario, which keys such as gains are given by.

    Attributes:
        features, joints: names, in order; (): they are not known, so that any name is accepted.
        limits: (lower, upper) by joint [m, rad].
        expand: function that replaces a name that stands for several features (points4) by all of them.
    """

    features: Tuple[str, ...] = ()
    joints: Tuple[str, ...] = ()
    limits: Mapping[str, Tuple[float, float]] = {}
    expand: Callable[[Iterable[str]], Iterable[str]] = tuple


def read(cls: Type[T], source: Any, where: str, names: Names = Names(),
         faults: Optional[List[Fault]] = None) -> T:
    """Returns the settings that a table of keys holds; missing keys have their defaults.

    Args:
        cls: settings class (config/settings.py).  source: mapping of key -> value.  where: its place, for the faults.
        faults: list to add faults to, instead of raising them; then None is returned after a fault.
    Raises:
        ParameterError: every fault, a line each: "where.key: found X, allowed Y".
    """
    found: List[Fault] = []
    validate(schema_of(cls), source, (where,), found)  # type: ignore[arg-type]
    result = build(cls, source, (where,), found, names)
    if found and faults is None:
        raise ParameterError(found)
    if faults is not None:
        faults.extend(found)
    return result  # type: ignore[return-value]


def build(cls: Type[T], source: Any, path: Path, faults: List[Fault], names: Names = Names()) -> Optional[T]:
    """Returns the settings that a table holds which has been validated; None after a fault in it.

    Adds the faults that a schema does not tell: of conditions, of names, and of keys that do not fit each other.

    Args: faults: those of the validation.  path: of the table, as in the faults.
    """
    bad = {fault.path[:n] for fault in faults for n in range(len(path), len(fault.path) + 1)}
    return _Builder(names, faults, bad).section(cls, source, path)


def faults_of(settings: Any) -> List[Fault]:
    """Returns the faults of an instance of a settings class that was not read but made in Python."""
    faults: List[Fault] = []
    for key in keys_of(type(settings)):  # type: ignore[arg-type]
        value = getattr(settings, key.name)
        if key.by != "feature" and not (value is None and key.optional or value == key.default):
            count = len(faults)
            validate(property_of(key), instance_value(value), (key.name,), faults)
            if len(faults) == count and key.condition is not None and not key.condition[1](value):
                faults.append(Fault((key.name,), f"found {shown(value)}, allowed {key.condition[0]}"))
    return faults or cross_faults(settings, ())


def cross_faults(settings: Any, path: Path) -> List[Fault]:
    """Returns the faults that an instance's own `check` yields."""
    return keyed(settings.check(), path) if hasattr(settings, "check") else []


def keyed(texts: Iterable[str], path: Path) -> List[Fault]:
    """Returns faults of several keys from texts "key: found X, allowed Y". Args: path: of the section of the keys."""
    matches = [(_KEYED.fullmatch(text), text) for text in texts]
    return [Fault((*path, *match[1].split(".")), match[2], True) if match else Fault(path, text, True)
            for match, text in matches]


class _Builder:
    """Makes instances of settings classes; leaves out the keys that have a fault already."""

    def __init__(self, names: Names, faults: List[Fault], bad: Set[Path]):
        self._names, self._faults, self._bad = names, faults, bad

    def section(self, cls, source, path):
        """An instance of a settings class, None after a fault."""
        if not isinstance(source, Mapping):
            return None
        values, before, keys = {}, len(self._faults), keys_of(cls)
        for key in keys:
            if source.get(key.name, REMOVED) not in (None, REMOVED):
                values[key.name] = self._value(key, source[key.name], (*path, key.name))
        wrong = {name for name, value in values.items() if value is None}
        right = {name: value for name, value in values.items() if name not in wrong}
        if all(key.name in right for key in keys if key.required):  # else there is nothing to call `check` of
            result = cls(**right)
            self._faults += [fault for fault in cross_faults(result, path)
                             if not wrong.intersection(fault.path, re.findall(r"\w+", fault.text))]
            if path not in self._bad and len(self._faults) == before:
                return result
        return None

    def _value(self, key, value, path):
        if is_dataclass(key.type):
            return self.section(key.type, value, path)
        if is_table(key) and isinstance(value, Mapping):
            return self._by_feature(value, path) if key.by == "feature" else self._table(key, value, path)
        return None if path in self._bad else self._plain(key, key.type, value, path)

    def _table(self, key, source, path):
        kind, known = entry_type(key.type), self._names.joints if key.by else ()
        result = {}
        for name, value in source.items():
            at = (*path, str(name))
            if at in self._bad:
                continue
            low, high = self._names.limits.get(name, (None, None)) if key.by == "joint_position" else (None, None)
            if known and name not in known:
                self._faults.append(Fault(at, f"found an unknown joint, allowed {one_of(known, name)}"))
            elif low is not None and not low <= value <= high:
                self._faults.append(Fault(at, f"found {shown(value)}, allowed a finite number >= {low} and <= {high}"))
            else:
                result[name] = self.section(kind, value, at) if is_dataclass(kind) else self._plain(
                    key, kind, value, at)
        return result

    def _by_feature(self, source, path):
        """The numbers in the order of the features."""
        given = {name: value for group, value in source.items() for name in self._names.expand((group,))}
        known, before = self._names.features, len(self._faults)
        for group in source if known else ():
            if (*path, str(group)) not in self._bad and not set(self._names.expand((group,))) <= set(known):
                text = f"found an unknown key, allowed {one_of(known, group)}, which features names"
                self._faults.append(Fault((*path, str(group)), text.replace("?, which features names", "?"), True))
        for name in known:
            if name not in given:
                self._faults.append(Fault((*path, name), "found nothing, allowed a number for each of features", True))
        wrong = path in self._bad or len(self._faults) > before
        return None if wrong else tuple(float(given[name]) for name in known)

    def _plain(self, key, kind, value, path):
        """A scalar or a list of them, None after a fault."""
        entries = entry_type(kind)
        if entries is not None:
            value = tuple(entries(entry) for entry in value)
        elif kind is not object:
            value = kind(value)
        if key.condition is not None and not key.condition[1](value):
            self._faults.append(Fault(path, f"found {shown(list(value) if entries else value)}, "
                                            f"allowed {key.condition[0]}"))
            return None
        return value
