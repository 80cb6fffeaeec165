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
_COMPARE = {">": operator.gt, ">=": operator.ge, "<": operator.lt, "<=": operator.le}
_REQUIRED = object()


class ConfigReader:
    """Typed access to a dict; `finish()` raises what was found wrong, unknown keys included."""

    def __init__(self, source, where, faults=None):
        """Args: source: dict. where: name of the section, for the messages. faults: list shared with a parent."""
        self._where = where
        self._faults = [] if faults is None else faults
        self._known = set()
        self._source = source if isinstance(source, Mapping) else {}
        if not isinstance(source, Mapping):
            self._fault("", source, "a table of keys")

    def _fault(self, key, found, allowed):
        self._faults.append(f"{self._where}{'/' if key else ''}{key}: found {found}, allowed {allowed}")

    def _get(self, key, default, allowed):
        self._known.add(key)
        if key in self._source:
            return self._source[key]
        if default is _REQUIRED:
            self._fault(key, "nothing", allowed)
        return default

    def number(self, key, default=_REQUIRED, above=None, at_least=None, at_most=None):
        """Finite number within the bounds; None after a fault."""
        signs = ((">", above), (">=", at_least), ("<=", at_most))
        bounds = [f"{sign} {bound}" for sign, bound in signs if bound is not None]
        allowed = ("a finite number " + " and ".join(bounds)).strip()
        value = self._get(key, default, allowed)
        if value is _REQUIRED or value is default:
            return None if value is _REQUIRED else value
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)
        if (
            not is_number
            or (above is not None and not value > above)
            or (at_least is not None and value < at_least)
            or (at_most is not None and value > at_most)
        ):
            self._fault(key, value, allowed)
            return None
        return float(value)

    def choice(self, key, names, default=_REQUIRED):
        """One of the names."""
        allowed = ", ".join(names)
        value = self._get(key, default, allowed)
        if value is not _REQUIRED and value not in names:
            self._fault(key, value, allowed)
        return value

    def flag(self, key, default):
        """True or false."""
        value = self._get(key, default, "true, false")
        if not isinstance(value, bool):
            self._fault(key, value, "true, false")
            return default
        return value

    def texts(self, key, default, single=False):
        """Tuple of texts, from a list; single: one text."""
        value = self._get(key, default, "text" if single else "a list of names")
        if value is default:
            return default
        if single:
            if not isinstance(value, str):
                self._fault(key, value, "text")
                return default
            return value
        if not isinstance(value, (list, tuple)) or not all(isinstance(entry, str) for entry in value):
            self._fault(key, value, "a list of names")
            return default
        return tuple(value)

    def vector(self, key, size, default):
        """Tuple of `size` finite numbers, from a list."""
        value = self._get(key, default, f"{size} finite numbers")
        if value is default:
            return default
        fits = isinstance(value, (list, tuple)) and len(value) == size and all(
            isinstance(entry, (int, float)) and not isinstance(entry, bool) and isfinite(entry) for entry in value)
        if not fits:
            self._fault(key, value, f"{size} finite numbers")
            return default
        return tuple(float(entry) for entry in value)

    def section(self, key, required=False):
        """Reader of a nested table; an empty one when it is not there."""
        source = self._get(key, _REQUIRED if required else {}, "a table of keys")
        return ConfigReader({} if source is _REQUIRED else source, f"{self._where}/{key}", self._faults)

    def value(self, key):
        """Whatever stands there, for somebody else to check."""
        return self._get(key, None, "a value")

    def numbers(self, names, default=_REQUIRED, **bounds):
        """List of the numbers of these keys; closes the table."""
        values = [self.number(name, default, **bounds) for name in names]
        self.close()
        return values

    def spread(self, expand):
        """Give each key that `expand((key,))` writes out as several the value it has for all. Returns self."""
        source = {}
        for key, value in self._source.items():
            source.update(dict.fromkeys(expand((key,)), value))
        self._source = source
        return self

    def ignore(self, *keys):
        """These keys belong to somebody else."""
        self._known.update(keys)

    def keys(self):
        """Keys found."""
        return list(self._source)

    def close(self):
        """Report unknown keys."""
        for key in self._source:
            if key not in self._known:
                self._faults.append(f"{self._where}/{key}: unknown key, allowed {', '.join(sorted(self._known))}")

    def fault(self, text):
        """Add a fault found by the caller."""
        self._faults.append(f"{self._where}/{text}")

    def finish(self):
        """Report unknown keys, then raise ParameterError when anything is wrong."""
        self.close()
        if self._faults:
            raise ParameterError(self._faults)


class Names(NamedTuple):
    """Names that keys are given by, of the scenario at hand.

    Attributes:
        features, joints: names, in order; joints (): not known, any name will do.
        expand: names in which one stands for several (points4) -> all of them written out.
    """

    features: Tuple[str, ...] = ()
    joints: Tuple[str, ...] = ()
    expand: Callable = tuple


def read(cls, source, where, names=Names(), also=(), faults=None, separator="/"):
    """Settings from a table of keys.

    Args:
        cls: settings class (config/settings.py).  source: mapping of key -> value.  where: its place, for the messages.
        names: `Names`.  also: further keys that the table may have, for somebody else to read.
        faults: list to add faults to, instead of raising them.  separator: between the parts of a place.
    Returns:
        An instance; None after faults that were added to the list. What is missing has its default.
    Raises:
        ParameterError: every fault, a line each: "where/key: found X, allowed Y".
    """
    found = [] if faults is None else faults
    result = _Reader(names, separator, found).section(cls, source, where, also)
    if faults is None and found:
        raise ParameterError(found)
    return result


def number_fault(where, value, key, lower=None, upper=None):
    """Fault of a number, "" without; lower, upper: more bounds that it has to keep, of the robot at hand."""
    more = tuple((sign, bound) for sign, bound in ((">=", lower), ("<=", upper)) if bound is not None)
    bounds = key.bounds + more
    return "" if _number(value) and _within(value, bounds) else f"{where}: found {value}, allowed {_allowed(float, bounds)}"


class _Reader:
    """Reads one table and those in it."""

    def __init__(self, names, separator, faults):
        self._names, self._separator, self._faults = names, separator, faults

    def _fault(self, where, found, allowed):
        self._faults.append(f"{where}: found {found}, allowed {allowed}")

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
            return self.section(key.type, value, where)
        return self._plain(key, key.type, value, where)

    def _table(self, key, source, where):
        """Entries by name: a dict, or a tuple in the order of the features."""
        if not isinstance(source, Mapping) or (key.not_empty and not source):
            return self._fault(where, source, _allowed_for(key))
        kind, by_feature = entry_type(key.type), key.by == "feature"
        if by_feature:
            source = {name: value for given, value in source.items() for name in self._names.expand((given,))}
        known = self._names.features if by_feature else self._names.joints if key.by == "joint" else ()
        result = {}
        for name in known if by_feature else source:
            at = self._join(where, name)
            if name not in source:
                self._fault(at, "nothing", _allowed(kind, key.bounds))
            elif known and name not in known:
                self._faults.append(f"{at}: unknown {key.by}, allowed {', '.join(known)}")
            elif is_dataclass(kind):
                result[name] = self.section(kind, source[name], at)
            else:
                result[name] = self._plain(key, kind, source[name], at)
        if by_feature:
            self._faults += [f"{self._join(where, name)}: unknown key, allowed {', '.join(sorted(known))}"
                             for name in source if name not in known]
            return tuple(result.get(name) for name in known)
        return result

    def _plain(self, key, kind, value, where):
        """A scalar or a list of them."""
        entries, converted = entry_type(kind), None
        if entries is None:
            fits = _fits(key, kind, value) and not (kind is str and key.not_empty and not value)
            converted = kind(value) if fits and kind is not object else value
        else:
            fits = (isinstance(value, (list, tuple)) and len(value) >= int(key.not_empty)
                    and key.size in (None, len(value)) and all(_fits(key, entries, entry) for entry in value))
            converted = tuple(entries(entry) for entry in value) if fits else None
        return converted if fits else self._fault(where, value, _allowed(kind, key.bounds, key.choices, key.size))


def _number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and isfinite(value)


def _within(value, bounds):
    return all(_COMPARE[sign](value, bound) for sign, bound in bounds)


def _fits(key, kind, value):
    """Whether a scalar is one of this type, and in its range."""
    if kind in (float, int):
        return _number(value) and (kind is float or value == int(value)) and _within(value, key.bounds)
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
