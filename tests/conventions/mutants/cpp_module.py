"""Runs the unit tests of a C++ core against mutants that are written by hand: tests/conventions/mutants/MODULE.yaml.

    package: aras_visual_servo_sim        # whose core is built
    tests: "Pid*:Joint*"                  # a filter of GoogleTest, the module's own tests
    mutants:
      - {file: src/core/..., old: TEXT, new: TEXT, why: what goes wrong}
    survivors:                            # of the last run, by the mutant's why
      what goes wrong: why no test can notice

`old` stands once in its file. The package's build is used as it stands: of each mutant one file is compiled, with the
flags of that build, and linked with the other objects to a core of its own in a temporary folder. The source is never
changed.
"""
import os
import pathlib
import re
import shlex
import subprocess
import tempfile

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
LIMIT_S = 600.0  # wall time of a compilation or of the tests, without a mutant
TOO_LONG = 5.0   # times the wall time of the tests without a mutant: they do not end any more
LEAST_S = 30.0   # of that
#: After the flags of the build, so that they count: quick to compile, and a name that is no longer used is no fault.
FLAGS = ("-O0", "-w")


def modules():
    """{name of a module: path of its list}."""
    return {path.stem: path for path in sorted(pathlib.Path(__file__).resolve().parent.glob("*.yaml"))}


def load(name):
    """The list of a module, a dict."""
    return yaml.safe_load(modules()[name].read_text())


def run(name, say=print):
    """Test the mutants of a module. Returns (killed, survivors), the survivors as texts."""
    listed = load(name)
    mutants = listed["mutants"]
    with tempfile.TemporaryDirectory(prefix="aras_mutants_") as folder:
        core = Core(listed["package"], pathlib.Path(folder))
        say(f"{name}: {len(mutants)} mutants")
        limits_s = {}
        survivors = []
        for number, mutant in enumerate(mutants, start=1):
            text = (core.source / mutant["file"]).read_text()
            if mutant["file"] not in limits_s:
                limits_s[mutant["file"]] = core.limit(mutant["file"], text, listed["tests"])
            compiles = core.link(mutant["file"], text.replace(mutant["old"], mutant["new"], 1))
            died = compiles and core.test(listed["tests"], limits_s[mutant["file"]])[0] != 0
            line = text[:text.index(mutant["old"])].count("\n") + 1
            told = f"{mutant['file']}:{line}: {mutant['why']}: {mutant['old']}  ->  {mutant['new']}"
            known = (listed.get("survivors") or {}).get(mutant["why"]) if compiles else "it does not compile"
            if not died:
                survivors.append(told + (f"  ({known})" if known else ""))
            say(f"{number:4d} {'killed' if died else 'SURVIVED' if compiles else 'NO MUTANT'}  {told}")
    return len(mutants) - len(survivors), survivors


class Core:
    """The built core of a package, and cores beside it in which one file is another. `folder`: where these stand."""

    def __init__(self, package, folder):
        self.source, self._build = ROOT / "src" / package, ROOT / "build" / package
        self._folder = folder
        self._target = self._build / "CMakeFiles" / f"{package}_core.dir"
        self._tests = self._build / f"{package}_unit_tests"
        flags = (self._target / "flags.make").read_text()
        self._flags = [word for key in ("CXX_DEFINES", "CXX_INCLUDES", "CXX_FLAGS")
                       for word in shlex.split(re.search(rf"^{key} = (.*)$", flags, re.MULTILINE)[1])]
        self._linking = shlex.split((self._target / "link.txt").read_text())

    def link(self, file, text):
        """Make the core in which `file` has this text. Returns whether it compiles and links."""
        mutant, objects = self._folder / "mutant.cpp", self._folder / "mutant.o"
        mutant.write_text(text)
        compiler = self._linking[0]
        if _call([compiler, *self._flags, *FLAGS, "-iquote", str((self.source / file).parent), "-c", str(mutant),
                  "-o", str(objects)], self._build) != 0:
            return False
        original = f"CMakeFiles/{self._target.stem}.dir/{file}.o"
        if original not in self._linking:
            raise ValueError(f"{file}: not a source of {self._target.stem}")
        words = [str(objects) if word == original else word for word in self._linking]
        library = words.index("-o") + 1
        words[library] = str(self._folder / pathlib.Path(words[library]).name)
        return _call(words, self._build) == 0

    def limit(self, file, text, tests):
        """Wall time [s] that tests may take with a mutant of a file, from that with its text compiled alike: slowly."""
        compiles = self.link(file, text)
        code, wall_s = self.test(tests, LIMIT_S) if compiles else (-1, 0.0)
        if code != 0:
            raise RuntimeError(f"{file}: the tests fail without a mutant")
        return max(LEAST_S, TOO_LONG * wall_s)

    def test(self, tests, limit_s):
        """Run these tests with the core made last. Returns (exit code, wall time [s])."""
        begin_s = os.times().elapsed
        code = _call([str(self._tests), f"--gtest_filter={tests}", "--gtest_fail_fast"], self._folder, limit_s,
                     dict(os.environ, LD_LIBRARY_PATH=str(self._folder)))
        return code, os.times().elapsed - begin_s


def _call(command, folder, limit_s=LIMIT_S, environment=None):
    """Exit code of a command; -1 when it did not end in time."""
    try:
        return subprocess.run(command, cwd=folder, env=environment, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, timeout=limit_s).returncode
    except subprocess.TimeoutExpired:
        return -1
