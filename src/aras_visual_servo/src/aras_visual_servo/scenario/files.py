"""The scenarios that come with this package, by name, and others by path."""

import os
from pathlib import Path
from typing import List, Union

from ..config.files import share_dir
from ..ground.errors import ParameterError
from ..ground.registry import one_of


def find_scenario(name_or_path: Union[str, Path]) -> Path:
    """Returns the path of a scenario given by name or path. Raises ParameterError: there is none."""
    text = os.path.expanduser(str(name_or_path))
    if os.sep in text or text.endswith((".yaml", ".yml")):
        if not os.path.isfile(text):
            raise ParameterError(f"scenario: found {text}, allowed a file: there is none of this name")
        return Path(text).resolve()
    folder = share_dir() / "config" / "scenarios"
    path = folder / f"{text}.yaml"
    if not path.is_file():
        raise ParameterError(f"scenario: found {text}, allowed the path of a file or {one_of(scenario_names(), text)}")
    return path


def scenario_names() -> List[str]:
    """Returns the names of the scenarios that come with the package, sorted."""
    return sorted(path.stem for path in (share_dir() / "config" / "scenarios").glob("*.yaml"))
