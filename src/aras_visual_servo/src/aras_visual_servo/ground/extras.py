"""Modules that only PyPI has, of the virtual environment that `script/bootstrap --extras` makes."""

import importlib
import os
import sys
from pathlib import Path
from types import ModuleType

from .errors import ArasError

FOLDER = Path("build") / "extras"
#: module -> the package of Debian that has it, of those that the package aras-visual-servo only suggests
DEBIAN_PACKAGES = {"cv2": "python3-opencv", "dask": "python3-distributed", "distributed": "python3-distributed"}


class MissingExtra(ArasError):
    """A module is not installed that not everybody needs."""


def extra(name: str, purpose: str) -> ModuleType:
    """The module `name`, imported, also from the workspace's virtual environment.

    Args: purpose: use of the module, for the message.
    Raises: MissingExtra: it is not there; in one sentence, with the command that installs it.
    """
    packages = FOLDER / "lib" / f"python3.{sys.version_info.minor}" / "site-packages"
    for folder in [str(parent / packages) for parent in Path(__file__).resolve().parents]:
        if os.path.isdir(folder) and folder not in sys.path:
            sys.path.append(folder)  # last: ROS keeps Debian's numpy
            importlib.invalidate_caches()
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingExtra(f"{purpose} needs {name}, which `script/bootstrap --extras` installs: {error}") from None
