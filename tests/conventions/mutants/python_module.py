"""Runs the unit tests of a room of the controller's package against mutants of its Python source.

The mutants stand, one at a time, in a throw-away copy of the package. Each is tested in a process of its own, forked
from one that has loaded the libraries already; a mutant that makes the tests run too long counts as killed. Of the
room's tests those are run that run the mutant's function (lines.py). A mutant outside functions, which may be the
default of a key, is also held against the tables of keys in READMEs and docs.
"""
import importlib
import importlib.machinery
import importlib.util
import json
import os
import pathlib
import random
import resource
import shutil
import signal
import sys
import tempfile
import time

import lines
import operators

ROOT = pathlib.Path(__file__).resolve().parents[3]
PACKAGE = ROOT / "src" / "aras_visual_servo_controller" / "src" / "aras_visual_servo_controller"
TESTS = ROOT / "src" / "aras_visual_servo_controller" / "test" / "unit"
TOO_LONG = 10.0        # times the processor time of the tests without a mutant
LEAST_S = 20           # of processor time


def sources(module):
    """Files of a module: `laws`, `laws/base` or `arm/real`. Raises ValueError, which names the rooms."""
    path = PACKAGE / module
    if path.is_dir():
        return sorted(file for file in path.rglob("*.py") if file.name != "__init__.py")
    if path.with_suffix(".py").is_file():
        return [path.with_suffix(".py")]
    rooms = sorted(room.name for room in PACKAGE.iterdir() if (room / "__init__.py").is_file())
    raise ValueError(f"module: found '{module}', allowed {', '.join(rooms)}, or a file or folder in one of them")


def tests_of(file):
    """Test files of the room of a source file."""
    return sorted((TESTS / file.relative_to(PACKAGE).parts[0]).rglob("test_*.py"))


def chosen(module, count, seed):
    """`count` mutants of the module at most, drawn from the seed: sorted list of (file, index, operator, line)."""
    every = [(file, index, operator, line) for file in sources(module)
             for index, (operator, line) in enumerate(operators.mutants(file.read_text()))]
    drawn = random.Random(seed).sample(every, min(count, len(every)))
    return sorted(drawn, key=lambda mutant: (mutant[0], mutant[1])), len(every)


def run(module, count, seed, say=print):
    """Test the mutants of a module. Returns (killed, survivors), the survivors as texts."""
    drawn, total = chosen(module, count, seed)
    say(f"{module}: {len(drawn)} of {total} mutants, seed {seed}")
    survivors = []
    with tempfile.TemporaryDirectory(prefix="aras_mutants_") as folder:
        copy = Copy(pathlib.Path(folder))
        everything = sorted({test for file, *_ in drawn for test in tests_of(file)})
        recorded = copy.record(everything)
        if recorded is None:
            raise RuntimeError(f"{module}: its tests fail without a mutant")
        for number, (file, index, operator, line) in enumerate(drawn, start=1):
            source, before, after = operators.mutated(file.read_text(), index)
            tests = lines.tests_that_run(recorded, copy.place(file), file.read_text(), line)
            used_s = sum(recorded["seconds"][test] for test in tests)
            names = tuple({test.split("::")[0] for test in tests})
            files = [path for path in tests_of(file) if str(path).endswith(names)]
            with copy.holding(file, source):
                code, _ = copy.test(files, max(LEAST_S, round(TOO_LONG * used_s)), lines.Order(tests),
                                    tables=not lines.in_function(file.read_text(), line))
            text = f"{file.relative_to(PACKAGE)}:{line}: {operator}: {before}  ->  {after}"
            if code == 0:
                survivors.append(text)
            say(f"{number:4d} {'SURVIVED' if code == 0 else 'killed'}  {text}")
    return len(drawn) - len(survivors), survivors


class Copy:
    """A throw-away copy of the package, with the modules in C++ of the installed one."""

    def __init__(self, folder):
        import aras_visual_servo_controller as installed
        self._folder = folder
        self._root = folder / PACKAGE.name
        shutil.copytree(PACKAGE, self._root, ignore=shutil.ignore_patterns("__pycache__"))
        # Scenarios and templates are found beside a package.xml.
        for beside in ("package.xml", "config", "web"):
            (folder / beside).symlink_to(PACKAGE.parents[1] / beside)
        for path in pathlib.Path(installed.__file__).parent.glob("_*.so"):
            (self._root / path.name).symlink_to(path)
        self._stamp = time.time() - 1e6

    def holding(self, file, source):
        """Context manager: the copy of this file holds this source."""
        return _Held(self, self.place(file), source, file.read_text())

    def place(self, file):
        """Where the copy has a source file."""
        return self._root / file.relative_to(PACKAGE)

    def write(self, path, source):
        """Write a file with a time that no compiled file of an earlier text has."""
        self._stamp += 10.0
        path.write_text(source)
        os.utime(path, (self._stamp, self._stamp))

    def record(self, tests):
        """What `lines.Recorder` keeps of these test files; None if one fails."""
        path = self._folder / "lines.json"
        code, _ = self.test(tests, 3600, lines.Recorder(self._root, path))
        return json.loads(path.read_text()) if code == 0 else None

    def test(self, tests, limit_s, plugin, tables=False):
        """(exit code, processor time [s]) of pytest on these files; it may use limit_s of processor time."""
        sys.stdout.flush()
        process = os.fork()
        if process == 0:
            self._work(tests, limit_s, plugin, tables)
        _, status, used = os.wait4(process, 0)
        for_sure = os.waitstatus_to_exitcode(status)
        return for_sure, used.ru_utime + used.ru_stime

    def _work(self, tests, limit_s, plugin, tables):
        code = 1
        try:
            os.setsid()
            resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s + 5))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            signal.alarm(60 * limit_s)  # one that waits for ever uses no processor time
            quiet = os.open(os.devnull, os.O_WRONLY)
            os.dup2(quiet, 1)
            os.dup2(quiet, 2)
            sys.path.insert(0, str(self._folder))
            os.environ["PYTHONPATH"] = f"{self._folder}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
            for name in [name for name in sys.modules if name.split(".")[0] == PACKAGE.name]:
                del sys.modules[name]
            import pytest
            if tests:
                code = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *map(str, tests)], plugins=[plugin]))
            else:
                code = 0
            if code == 0 and tables:
                code = _differing_tables()
        finally:
            os._exit(code)


class _Held:
    def __init__(self, copy, path, source, before):
        self._copy, self._path, self._source, self._before = copy, path, source, before

    def __enter__(self):
        self._copy.write(self._path, self._source)

    def __exit__(self, *_):
        self._copy.write(self._path, self._before)


def _differing_tables():
    """1 if the tables of keys are not those that the package in sys.modules makes."""
    loader = importlib.machinery.SourceFileLoader("key_tables", str(ROOT / "script" / "key_tables"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("key_tables", loader))
    sys.dont_write_bytecode = True
    path = list(sys.path)
    loader.exec_module(module)
    sys.path[:] = path  # the copy first
    sys.argv = ["key_tables", "--check"]
    return module.main()


def preload():
    """Load what every test loads, so that a forked process has it."""
    for name in ("cv2", "numpy", "pytest", "scipy", "yaml"):
        importlib.import_module(name)
