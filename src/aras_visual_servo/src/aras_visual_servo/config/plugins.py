"""Features and laws from outside this package: modules that register_law them on import (docs/extending.md)."""

import importlib
import traceback

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
            faults.append(f"plugins: found {name}, allowed a module that can be imported: {_place_of(error)}"
                          f"{type(error).__name__}: {getattr(error, 'msg', error)}")
    return faults


def _place_of(error):
    """"FILE:LINE: " of the code that raised the error on import; "" where no file is to blame."""
    if isinstance(error, SyntaxError):
        return f"{error.filename}:{error.lineno}: "
    frames = [frame for frame in traceback.extract_tb(error.__traceback__)[1:] if "importlib" not in frame.filename]
    return f"{frames[-1].filename}:{frames[-1].lineno}: " if frames else ""
