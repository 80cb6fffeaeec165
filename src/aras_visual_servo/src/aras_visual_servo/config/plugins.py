"""Features and laws from outside this package: modules that register_law them on import (docs/extending.md)."""

import importlib

from ..ground.registry import load_room  # noqa: F401


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
