"""Programs in Python: syntax and names of Python 2, modules that are not there."""
import ast
import importlib.util
import os
import re
import shutil
import typing

from .findings import Finding, advice_for

#: Names that Python 3 does not have.
OLD_NAMES = {"xrange", "raw_input", "unicode", "unichr", "basestring", "execfile", "reduce", "long", "cmp"}
#: Modules of Python 2's library -> their names in Python 3.
OLD_MODULES = {"Queue": "queue", "Tkinter": "tkinter", "ConfigParser": "configparser", "urllib2": "urllib.request",
               "cPickle": "pickle", "StringIO": "io", "commands": "subprocess", "thread": "_thread",
               "tkMessageBox": "tkinter.messagebox", "__builtin__": "builtins", "HTMLParser": "html.parser"}
#: The Python that Debian's modules belong to.
DEBIANS = "/usr/bin/python3"
CONFLICT = re.compile(r"[<=>]{7}(\s|$)")  #: lines that git writes into files
TO_3 = "written for Python 2; `2to3 -w FILE` mends most of it"


def is_python(path: str) -> bool:
    """Whether a file is a program or module in Python."""
    if path.endswith(".py"):
        return True
    try:
        with open(path, "rb") as file:
            first = file.readline(200)
    except OSError:
        return False
    return first.startswith(b"#!") and b"python" in first


def files_of(folder: str) -> typing.Iterator[str]:
    """Yields the files in Python of a package."""
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(each for each in folders if not each.startswith(".") and each not in ("build", "devel"))
        for name in sorted(files):
            path = os.path.join(place, name)
            if os.path.isfile(path) and is_python(path):
                yield path


def modules_in(files: typing.List[str]) -> typing.Set[str]:
    """Returns names of the modules that files are, and of the folders that they stand in: programs add these to
    sys.path."""
    return {os.path.splitext(os.path.basename(path))[0] for path in files} | {
        os.path.basename(os.path.dirname(path)) for path in files}


def findings_of(path: str, own: typing.Collection[str] = ()) -> typing.List[Finding]:
    """Returns list of Finding of a file. Args: own: names of modules that its workspace brings."""
    try:
        with open(path, "rb") as file:
            tree = ast.parse(file.read(), path)
    except SyntaxError as error:
        where = "%s:%d" % (path, error.lineno or 0)
        if CONFLICT.match(error.text or ""):
            return [Finding("syntax", os.path.basename(path), where, "a merge conflict was committed")]
        return [Finding("python 2", os.path.basename(path), where, TO_3)]
    except (OSError, ValueError):
        return []
    found, defined = [], {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and
                          isinstance(node.ctx, ast.Store)}
    defined |= {name.asname or name.name for node in ast.walk(tree) if isinstance(node, (ast.Import, ast.ImportFrom))
                for name in node.names}
    defined |= {node.name for node in ast.walk(tree) if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    beside = {os.path.splitext(name)[0] for name in os.listdir(os.path.dirname(path) or ".")}
    for node in ast.walk(tree):
        where = "%s:%d" % (path, getattr(node, "lineno", 0))
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in OLD_NAMES - defined:
            found.append(Finding("python 2", os.path.basename(path), where, "`%s`: %s" % (node.id, TO_3)))
        for name in modules_of(node):
            if name in OLD_MODULES:
                found.append(Finding("python 2", os.path.basename(path), where,
                                     "module %s is %s now: %s" % (name, OLD_MODULES[name], TO_3)))
            elif name not in beside and name not in own and not is_there(name):
                found.append(Finding("module", name, where, advice_for(name)))
    old = [each for each in found if each.kind != "module"]
    return old[:1] + [each for each in found if each.kind == "module"]


def modules_of(node: ast.AST) -> typing.List[str]:
    """Returns the top-level names of the modules that a statement imports."""
    if isinstance(node, ast.Import):
        return [name.name.partition(".")[0] for name in node.names]
    if isinstance(node, ast.ImportFrom) and not node.level and node.module:
        return [node.module.partition(".")[0]]
    return []


def is_there(name: str) -> bool:
    """Whether a module can be imported."""
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return False


def wrong_interpreter(files: typing.Iterable[str]) -> typing.List[Finding]:
    """Returns a Finding of the first program that env gives to a Python other than Debian's, for which ROS is built."""
    first = shutil.which("python3")
    if first is None or os.path.realpath(first) == os.path.realpath(DEBIANS):
        return []
    for file in files:
        with open(file, "rb") as stream:
            if re.match(rb"#!\s*/usr/bin/env\s+python", stream.readline(200)):
                return [Finding("program", "python3", file + ":1", "env finds %s, which lacks Debian's modules: export "
                                "PATH=/usr/bin:$PATH" % first)]
    return []
