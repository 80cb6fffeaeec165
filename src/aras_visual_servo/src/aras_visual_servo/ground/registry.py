"""Plugins by name: laws, features, sources, overlays, metrics, protocols. Each kind has one `Registry`.

    LAWS = Registry("law", __package__)

    @LAWS.register("mine")
    class Mine(Law): ...

    LAWS.find("mien")                           # ParameterError: law: found mien, allowed ...; did you mean mine?
"""

import difflib
import functools
import importlib
import pkgutil
from collections.abc import Iterable, Iterator, MutableMapping
from typing import Any, Callable, Dict, TypeVar

from .errors import ParameterError

T = TypeVar("T")
C = TypeVar("C")
MOST_LISTED = 12


class Registry(MutableMapping[str, T]):
    """Plugins of one kind, sorted by name. The modules that register them are imported when the first one is read.

    Args: kind: their name in errors.  packages: dotted names of packages whose modules register plugins.
    """

    def __init__(self, kind: str, *packages: str) -> None:
        self.kind, self._packages = kind, packages
        self._plugins: Dict[str, T] = {}

    def register(self, name: str, /, **attributes: Any) -> Callable[[C], C]:
        """Returns a decorator that adds a class or function under this name, after it has set these attributes of it.

        A plugin that has this name already is replaced.
        """
        def add(plugin: C) -> C:
            for attribute, value in attributes.items():
                setattr(plugin, attribute, value)
            self[name] = plugin  # type: ignore[assignment]
            return plugin

        return add

    def find(self, name: str, key: str = "") -> T:
        """Returns the plugin of that name. Raises ParameterError, which starts with `key`, else with the kind."""
        if name not in self:
            raise ParameterError(unknown_name(key or self.kind, name, self))
        return self[name]

    def __getitem__(self, name: str) -> T:
        return self._loaded()[name]

    def __setitem__(self, name: str, plugin: T) -> None:
        self._plugins[name] = plugin

    def __delitem__(self, name: str) -> None:
        del self._plugins[name]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self._loaded()))

    def __len__(self) -> int:
        return len(self._loaded())

    def _loaded(self) -> Dict[str, T]:
        for package in self._packages:
            load_room(package)
        return self._plugins


@functools.lru_cache(maxsize=None)
def load_room(package: str) -> None:
    """Imports every module of a package, so that each registers its plugins. Args: package: dotted name."""
    for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
        importlib.import_module(f"{package}.{module.name}")


def unknown_name(key: str, found: object, known: Iterable[str]) -> str:
    """Returns the text of a fault: a name that is not known."""
    return f"{key}: found {found}, allowed {one_of(known, found)}"


def one_of(names: Iterable[str], found: object = None) -> str:
    """Returns the allowed names, or their number above MOST_LISTED, and the name nearest to the one found."""
    names = list(names)
    near = difflib.get_close_matches(str(found), names, 1) if found is not None else ()
    listed = ", ".join(names) if len(names) <= MOST_LISTED else f"{len(names)} names"
    return ("one of " * (len(names) > 1) + listed or "none") + (f"; did you mean {near[0]}?" if near else "")
