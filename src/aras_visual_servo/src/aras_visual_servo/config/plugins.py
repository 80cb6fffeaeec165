"""Features and laws from outside this package: modules that register_law them on import (docs/extending.md)."""

import functools
import importlib
import pkgutil


def load_plugins(modules):
    """Import them.

    Args: modules: dotted names, found as Python finds modules (PYTHONPATH, installed packages).
    Returns: faults, one line per module that could not be imported.
    """
    faults = []
    for name in modules:
        try:
            importlib.import_module(name)
        except Exception as error:  # somebody else's code may raise anything; it is reported as a fault of that plugin
            faults.append(f"plugins: found '{name}', allowed a module that can be imported: "
                          f"{type(error).__name__}: {error}")
    return faults


@functools.lru_cache(maxsize=None)
def load_room(package):
    """Import every module of a package, so that each registers what it offers. Args: package: dotted name."""
    for module in pkgutil.iter_modules(importlib.import_module(package).__path__):
        importlib.import_module(f"{package}.{module.name}")
