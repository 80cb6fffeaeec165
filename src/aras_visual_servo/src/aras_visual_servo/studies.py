"""The package of studies, which stands above this one: loaded by name, when something of it is asked for."""

import importlib
from types import ModuleType
from typing import Any

from .ground.errors import ArasError

PACKAGE = "aras_visual_servo_study"


def study(room: str = "") -> ModuleType:
    """Returns the package of sweeps, comparisons and reports, or one room of it.

    Args:
        room: dotted name within the package, e.g. "report"; "" is the package itself.
    Raises:
        ArasError: the package is not installed.
    """
    try:
        return importlib.import_module(f"{PACKAGE}.{room}" if room else PACKAGE)
    except ModuleNotFoundError as error:
        if error.name is None or not error.name.startswith(PACKAGE):
            raise
        raise ArasError(f"{error.name}: not installed; reports, sweeps and comparisons need {PACKAGE}") from error


def sweep(*arguments: Any, **settings: Any) -> Any:
    """Runs a scenario from many starts: `aras_visual_servo_study.api.sweep`."""
    return study("api").sweep(*arguments, **settings)


def compare(*arguments: Any, **settings: Any) -> Any:
    """Compares sweeps on the same starts: `aras_visual_servo_study.api.compare`."""
    return study("api").compare(*arguments, **settings)


def save_results(*arguments: Any, **settings: Any) -> Any:
    """Writes the result folder of a run: `aras_visual_servo_study.report.save_results`."""
    return study("report").save_results(*arguments, **settings)
