"""Reads a section of a scenario: every fault is collected and raised in one ParameterError."""

import operator
from collections.abc import Mapping
from dataclasses import is_dataclass
from math import isfinite
from typing import Callable, NamedTuple, Tuple

from ..ground.errors import ParameterError
from .settings import entry_type, is_table, keys_of

_TABLE = "a table of keys"
_WORDS = {float: "a finite number", int: "a whole number", bool: "true, false", str: "text", object: "a value"}
MOST_SHOWN = 200  # characters of what was found, in a fault
_COMPARE = {">": operator.gt, ">=": operator.ge, "<": operator.lt, "<=": operator.le}


class Names(NamedTuple):
    """Names of features and joints of one scenario, which keys such as gains are given by.

    Attributes:
        features, joints: names, in order; joints (): the joints are not known, so that any name is accepted.
        limits: (lower, upper) by joint.
        expand: function that replaces a name that stands for several features (points4) by all of them.
    """

    features: Tuple[str, ...] = ()
    joints: Tuple[str, ...] = ()
    limits: Mapping = {}
    expand: Callable = tuple


def read(cls, source, where, names=Names(), also=(), faults=None, separator="/"):
    """Settings from a table of keys.

    Args:
        cls: settings class (config/settings.py).  source: mapping of key -> value.  where: its place, for the messages.
        names: `Names`.  also: further keys that the table may have, which other code reads.
        faults: list to add faults to, instead of raising them.  separator: between the parts of a place.
    Returns:
        An instance, in which missing keys have their defaults; None when faults were added to the list.
    Raises:
        ParameterError: every fault, a line each: "where/key: found X, allowed Y".
    """
    found = [] if faults is None else faults
    result = _Reader(names, separator, found).section(cls, source, where, also)
    if faults is None and found:
        raise ParameterError(found)
    return result


class _Reader:
    """Reads one table and those in it."""

    def __init__(self, names, separator, faults):
        self._names, self._separator, self._faults = names, separator, faults

    def _fault(self, where, found, allowed):
        shown = str(found)
        shown = shown if len(shown) <= MOST_SHOWN else shown[:MOST_SHOWN] + "..."
        self._faults.append(f"{where}: found {shown}, allowed {allowed}")

    def section(self, cls, source, where, also=()):
        """An instance of a settings class, None after a fault."""
        if not isinstance(source, Mapping):
            return self._fault(where, source, _TABLE)
        values, before, known = {}, len(self._faults), {key.name for key in keys_of(cls)} | set(also)
        for key in keys_of(cls):
            if key.name in source:
                values[key.name] = self._value(key, source[key.name], self._join(where, key.name))
            elif key.required:
                self._fault(self._join(where, key.name), "nothing", _allowed_for(key))
        for name in source:
            if name not in known:
                self._faults.append(f"{self._join(where, name)}: unknown key, allowed {', '.join(sorted(known))}")
        if len(self._faults) > before:
            return None
        result = cls(**values)
        if hasattr(result, "check"):
            self._faults += [self._join(where, fault) for fault in result.check()]
        return result if len(self._faults) == before else None

    def _join(self, where, name):
        return f"{where}{self._separator}{name}"

    def _value(self, key, value, where):
        if is_table(key):
            return self._table(key, value, where)
        if is_dataclass(key.type):
            if key.not_empty and value == {}:
                return self._fault(where, value, _TABLE)
            return self.section(key.type, value, where)
        return self._plain(key, key.type, value, where, key.bounds)

    def _table(self, key, source, where):
        """Entries by name: a dict, or a tuple in the order of the features."""
        if not isinstance(source, Mapping) or (key.not_empty and not source):
            return self._fault(where, source, _TABLE)
        kind = entry_type(key.type)
        if key.by == "feature":
            return self._by_feature(key, source, where)
        known, result = self._names.joints if key.by else (), {}
        for name in source:
            at, bounds = self._join(where, name), key.bounds
            if key.by == "joint_position" and name in self._names.limits:
                bounds += tuple(zip((">=", "<="), self._names.limits[name]))
            if known and name not in known:
                self._faults.append(f"{at}: unknown joint, allowed {', '.join(known)}")
            elif is_dataclass(kind):
                result[name] = self.section(kind, source[name], at)
            else:
                result[name] = self._plain(key, kind, source[name], at, bounds)
        return result

    def _by_feature(self, key, source, where):
        given = {name: value for group, value in source.items() for name in self._names.expand((group,))}
        known = self._names.features
        for name in given:
            if name not in known:
                self._faults.append(f"{self._join(where, name)}: unknown key, allowed {', '.join(sorted(known))}")
        for name in known:
            if name not in given:
                self._fault(self._join(where, name), "nothing", _allowed(float, key.bounds))
        return tuple(self._plain(key, float, given[name], self._join(where, name), key.bounds)
                     for name in known if name in given)

    def _plain(self, key, kind, value, where, bounds):
        """A scalar or a list of them."""
        entries = entry_type(kind)
        if entries is None:
            fits = _fits(key, kind, value, bounds) and not (kind is str and key.not_empty and not value)
            converted = kind(value) if fits and kind is not object else value
        else:
            fits = (isinstance(value, (list, tuple)) and len(value) >= int(key.not_empty)
                    and key.size in (None, len(value)) and all(_fits(key, entries, entry, bounds) for entry in value))
            converted = tuple(entries(entry) for entry in value) if fits else None
        if not fits:
            return self._fault(where, value, _allowed(kind, bounds, key.choices, key.size))
        if key.condition is not None and not key.condition[1](converted):
            return self._fault(where, value, key.condition[0])
        return converted


def is_number(value):
    """Whether a value is a finite number that a float can hold."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return False
    try:
        return isfinite(value)
    except OverflowError:  # a whole number of some hundred digits
        return False


def _within(value, bounds):
    return all(_COMPARE[sign](value, bound) for sign, bound in bounds)


def _fits(key, kind, value, bounds):
    """Whether a scalar is one of this type, and in its range."""
    if kind in (float, int):
        return is_number(value) and (kind is float or value == int(value)) and _within(value, bounds)
    if kind is str and key.choices:
        return value in key.choices
    return isinstance(value, kind)


def _allowed_for(key):
    if is_table(key) or is_dataclass(key.type):
        return _TABLE
    return _allowed(key.type, key.bounds, key.choices, key.size)


def _allowed(kind, bounds=(), choices=(), size=None):
    """What is allowed, in words."""
    entries = entry_type(kind)
    if entries is str:
        return "a list of names"
    if entries is not None:
        kind, name = entries, "finite numbers" if entries is float else "whole numbers"
        text = f"{size} {name}" if size else f"a list of {name}"
    else:
        text = ", ".join(choices) or _WORDS[kind]
    return f"{text} {' and '.join(f'{sign} {bound}' for sign, bound in bounds)}".strip()
