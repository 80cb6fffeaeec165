"""Features and laws from outside this package: modules that register them on import (docs/extending.md).

A plugin is the dotted name of a module, `my_laws`, or with the folder that it is in, `FOLDER/my_laws`.
"""

import importlib
import importlib.util
import os
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Iterable, List, Set, Union

from ..ground.errors import ParameterError

_CODE: Set[str] = set()  # real paths of the files, and of the folders of packages, that are plugins


def placed(plugin: str, folder: Union[str, Path]) -> str:
    """Returns the plugin with its absolute folder, for processes that work in another folder.

    The module is looked for in `folder` (that of the scenario file), then in the relative entries of PYTHONPATH. A
    plugin that is in none of them is returned as it is.
    """
    name = plugin[:-len(".py")] if plugin.endswith(".py") else plugin
    above, _, module = os.path.expanduser(name).rpartition(os.sep)
    top = module.partition(".")[0]
    search = os.environ.get("PYTHONPATH")
    relative = [entry for entry in search.split(os.pathsep) if not os.path.isabs(entry)] if search else []
    for entry in (folder, *relative):
        home = os.path.abspath(os.path.join(entry, above))
        if os.path.isfile(os.path.join(home, f"{top}.py")) or os.path.isfile(os.path.join(home, top, "__init__.py")):
            return os.path.join(home, module)
    return name


def load_plugins(plugins: Iterable[str]) -> List[str]:
    """Imports plugins. A plugin whose folder is gone is looked for as Python finds modules.

    Returns:
        faults, one line per module that could not be imported.
    """
    faults = []
    for plugin in plugins:
        try:
            _load(plugin)
        except Exception as error:  # a plugin may raise anything; report it as its fault
            faults.append(f"plugins: found {plugin}, allowed a module that can be imported: {described(error)}")
    return faults


def run_text(text: str, name: str) -> ModuleType:
    """Runs a text as the code of a plugin, so that `code_place` gives "NAME.py:LINE: " of an error in it.

    Args: name: of the module.
    Returns: the module `__NAME__`.
    Raises: ParameterError: the text cannot be compiled, or raises an error when it runs; with the line.
    """
    module, file = ModuleType(f"__{name}__"), f"{name}.py"
    _CODE.add(os.path.realpath(file))
    sys.modules[module.__name__] = module  # dataclasses and typing look a class's module up there
    try:
        exec(compile(text, file, "exec"), module.__dict__)
    except (Exception, SystemExit) as error:
        raise ParameterError(described(error)) from error
    return module


def described(error: BaseException) -> str:
    """Returns the kind of an error and its text, after its place in the code of a plugin."""
    return f"{code_place(error)}{type(error).__name__}: {getattr(error, 'msg', error)}"


def code_place(error: BaseException) -> str:
    """Returns "FILE:LINE: " of an error that was raised in the code of a plugin, else ""."""
    if isinstance(error, SyntaxError) and error.filename:
        return f"{error.filename}:{error.lineno}: "
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        if os.path.realpath(frame.filename).startswith(tuple(_CODE)):
            return f"{frame.filename}:{frame.lineno}: "
    return ""


def _load(plugin: str) -> None:
    folder, _, name = plugin.rpartition(os.sep)
    if not os.path.isdir(folder):
        _import(name)
        return
    sys.path.insert(0, folder)
    try:
        module = _import(name)
    finally:
        sys.path.remove(folder)
        if folder not in sys.path:
            sys.path.append(folder)  # for what it imports later
    found = os.path.realpath(getattr(module, "__file__", None) or "")
    if not found.startswith(os.path.realpath(folder) + os.sep):
        raise ImportError(f"a module of this name was imported before, {found}: rename one of them")


def _import(name: str) -> ModuleType:
    top = name.partition(".")[0]
    spec = None if top in sys.modules else importlib.util.find_spec(top)
    if spec is not None and spec.origin is not None:
        file = Path(os.path.realpath(spec.origin))
        _CODE.add(f"{file.parent}{os.sep}" if file.name == "__init__.py" else str(file))
    return importlib.import_module(name)
