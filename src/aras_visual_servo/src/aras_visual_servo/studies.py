"""The package of studies, which stands above this one: loaded by name, when something of it is asked for."""

import importlib
from types import ModuleType

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
