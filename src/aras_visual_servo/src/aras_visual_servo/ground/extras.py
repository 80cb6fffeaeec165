"""Modules that only PyPI has, of the virtual environment that `script/bootstrap --extras` makes."""

import importlib
import sys
from pathlib import Path

from .errors import ArasError

FOLDER = Path("build") / "extras"


class MissingExtra(ArasError):
    """A module is not installed that not everybody needs."""


def extra(name, purpose):
    """The module `name`, imported, also from the workspace's virtual environment.

    Args: purpose: what cannot be done without it, for the message.
    Raises: MissingExtra: it is not there; in one sentence, with the command that installs it.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        version = f"python3.{sys.version_info.minor}"
        for parent in Path(__file__).resolve().parents:
            folder = str(parent / FOLDER / "lib" / version / "site-packages")
            if Path(folder).is_dir() and folder not in sys.path:
                sys.path.append(folder)  # last: ROS keeps Debian's numpy
                importlib.invalidate_caches()
        try:
            return importlib.import_module(name)
        except ImportError as error:
            raise MissingExtra(f"{purpose} needs {name}, which `script/bootstrap --extras` installs: {error}") from None
