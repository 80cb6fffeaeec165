"""Tab completion by python3-argcomplete: `eval "$(register-python-argcomplete aras-servo)"` in bash."""

import argparse
import os
import re
from pathlib import Path
from typing import Any, Callable, List

#: Argument name -> function that completes the typed prefix.
_BY_NAME = {"scenario": lambda typed: _scenarios(typed), "overrides": lambda typed: _keys(typed),
            "law": lambda typed: _laws(typed)}


def offer(parser: argparse.ArgumentParser) -> None:
    """Completes the word under the cursor and ends the process, if the shell asks for completions."""
    if "_ARGCOMPLETE" not in os.environ:
        return
    import argcomplete
    for action in parser._actions:
        for one in getattr(action.choices, "values", list)() if isinstance(action.choices, dict) else [parser]:
            for inner in one._actions:
                if inner.dest in _BY_NAME:
                    setattr(inner, "completer", _completer(_BY_NAME[inner.dest]))
    in_key = re.search(r"--set\s+\S*$", os.environ["COMP_LINE"][:int(os.environ["COMP_POINT"])])
    argcomplete.autocomplete(parser, append_space=not in_key)  # a dotted key goes on


def _completer(words: Callable[[str], List[str]]) -> Callable[..., List[str]]:
    return lambda prefix, **_: words(prefix)


def _scenarios(typed: str) -> List[str]:
    """Shipped scenarios, and YAML files in the folder that is typed."""
    from ..config.files import arm_names, scenario_names
    folder = os.path.dirname(typed)
    found = sorted(Path(folder or ".").glob("*.yaml")) + [path for path in Path(folder or ".").iterdir()
                                                          if folder and path.is_dir()]
    files = [os.path.join(folder, path.name) + "/" * path.is_dir() for path in found]
    return [name for name in [*scenario_names(), *arm_names(), *files] if name.startswith(typed)]


def _laws(_: str) -> List[str]:
    from ..laws.base import known_laws
    return list(known_laws())


def _keys(typed: str) -> List[str]:
    """Dotted keys of the scenario's schema, one level at a time, with = where a value comes next."""
    from ..config.tables import section_of
    from ..scenario.schema import scenario_schema
    *above, _ = typed.split(".")
    schema: Any = scenario_schema()
    for key in above:
        schema = section_of(schema).get("properties", {}).get(key, {})
    found = section_of(schema).get("properties", {})
    start = "".join(key + "." for key in above)
    return [f"{start}{key}" + ("." if section_of(value).get("properties") or isinstance(
        value.get("additionalProperties"), dict) else "=") for key, value in found.items()]
