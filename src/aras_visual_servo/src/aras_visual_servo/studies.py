"""The packages that build on this one. They are loaded by name on first use."""

import importlib
from types import ModuleType
from typing import Any

from .ground.errors import ArasError

PACKAGE = "aras_visual_servo_study"


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


def sweep(*arguments: Any, **settings: Any) -> Any:
    """Runs a scenario from many starts: `aras_visual_servo_study.api.sweep`."""
    return study("api").sweep(*arguments, **settings)


def compare(*arguments: Any, **settings: Any) -> Any:
    """Compares sweeps on the same starts: `aras_visual_servo_study.api.compare`."""
    return study("api").compare(*arguments, **settings)


def benchmark(*arguments: Any, **settings: Any) -> Any:
    """Runs a published protocol: `aras_visual_servo_study.api.benchmark`."""
    return study("api").benchmark(*arguments, **settings)


def save_results(*arguments: Any, **settings: Any) -> Any:
    """Writes the result folder of a run: `aras_visual_servo_study.report.save_results`."""
    return study("report").save_results(*arguments, **settings)
