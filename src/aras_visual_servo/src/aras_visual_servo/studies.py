"""The packages that build on this one. They are loaded by name on first use."""

import importlib
from types import ModuleType
from typing import Any

from .ground.errors import ArasError

PACKAGE = "aras_visual_servo_study"
#: Functions of that package that are public names of this one, and their rooms.
_ROOMS = {"sweep": "api", "compare": "api", "benchmark": "api", "save_results": "report"}


def sister(package: str, module: str, needed_by: str) -> ModuleType:
    """Returns a module of a package that is built on this one.

    Args:
        module: dotted name within the package; "" is the package itself.  needed_by: the request, for messages.
    Raises:
        ArasError: the package is not installed.
    """
    try:
        return importlib.import_module(f"{package}.{module}" if module else package)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] != package:
            raise
        raise ArasError(f"{needed_by} needs the package {package}, which is not installed") from error


def study(room: str = "") -> ModuleType:
    """Returns the package of sweeps, comparisons and reports, or a room of it, e.g. "report". Errors as `sister`."""
    return sister(PACKAGE, room, f"`{room or 'study'}`")


def __getattr__(name: str) -> Any:
    """`sweep`, `compare`, `benchmark` and `save_results`, with their own signatures. Errors as `sister`."""
    if name not in _ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(study(_ROOMS[name]), name)
