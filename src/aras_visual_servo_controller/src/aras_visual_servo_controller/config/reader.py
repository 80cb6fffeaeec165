"""Reads a section of a scenario: every fault is collected and raised in one ParameterError."""

from collections.abc import Mapping
from math import isfinite

from ..ground.errors import ParameterError

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
