"""The scenarios that come with this package, by name, and others by path."""

import os
from pathlib import Path

from ..config.files import share_dir
from ..ground.errors import ParameterError


def find_scenario(name_or_path):
    """Path of a scenario given by name or path. Raises ParameterError listing the known names."""
    text = os.path.expanduser(str(name_or_path))
    if os.sep in text or text.endswith((".yaml", ".yml")):
        if not os.path.isfile(text):
            raise ParameterError(f"scenario '{text}': no such file")
        return Path(text).resolve()
    folder = share_dir() / "config" / "scenarios"
    path = folder / f"{text}.yaml"
    if not path.is_file():
        known = ", ".join(scenario_names()) or "none"
        raise ParameterError(f"scenario '{text}': not found, known are {known} (or give a path)")
    return path


def scenario_names():
    """Names of the scenarios that come with the package, sorted."""
    return sorted(path.stem for path in (share_dir() / "config" / "scenarios").glob("*.yaml"))
