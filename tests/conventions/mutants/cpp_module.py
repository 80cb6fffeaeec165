"""Runs the unit tests of a C++ core against mutants that are written by hand: tests/conventions/mutants/MODULE.yaml.

    package: aras_visual_servo_sim        # whose sources are copied and built
    tests: "Pid*:Joint*"                  # a filter of GoogleTest, the module's own tests
    mutants:
      - {file: src/core/..., old: TEXT, new: TEXT, why: what goes wrong}

`old` stands once in its file. The copy and its build are in build/mutants, so that the next run has less to compile.
"""
import os
import pathlib
import shutil
import subprocess

import yaml

ROOT = pathlib.Path(__file__).resolve().parents[3]
BUILD = ROOT / "build" / "mutants"
LIMIT_S = 3600.0  # wall time of a build or a test
FLAGS = "-O1 -DNDEBUG"


def modules():
    """{name of a module: path of its list}."""
    return {path.stem: path for path in sorted(pathlib.Path(__file__).resolve().parent.glob("*.yaml"))}


def load(name):
    """The list of a module, a dict."""
    return yaml.safe_load(modules()[name].read_text())


def run(name, say=print):
    """Test the mutants of a module. Returns (killed, survivors), the survivors as texts."""
    listed = load(name)
    package, mutants = listed["package"], listed["mutants"]
    source, build = BUILD / package / "src", BUILD / package / "build"
    original = ROOT / "src" / package
    _mirror(original, source)
    _call("cmake", "-S", str(source), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release",
          f"-DCMAKE_CXX_FLAGS_RELEASE={FLAGS}", "-DPYTHON_EXECUTABLE=/usr/bin/python3", "-DCATKIN_ENABLE_TESTING=ON")
    _make(build, package)
    if _tests(build, package, listed["tests"]) != 0:
        raise RuntimeError(f"{name}: its tests fail without a mutant")
    say(f"{name}: {len(mutants)} mutants")
    survivors = []
    for number, mutant in enumerate(mutants, start=1):
        file, text = source / mutant["file"], (original / mutant["file"]).read_text()
        try:
            file.write_text(text.replace(mutant["old"], mutant["new"], 1))
            died = _make(build, package, may_fail=True) != 0 or _tests(build, package, listed["tests"]) != 0
        finally:
            file.write_text(text)
        line = text[:text.index(mutant["old"])].count("\n") + 1
        told = f"{mutant['file']}:{line}: {mutant['why']}: {mutant['old']}  ->  {mutant['new']}"
        if not died:
            survivors.append(told)
        say(f"{number:4d} {'killed' if died else 'SURVIVED'}  {told}")
    return len(mutants) - len(survivors), survivors


def _mirror(original, copy):
    """Make `copy` the same as `original`; files that are the same already keep their time."""
    wanted = {path.relative_to(original): path for path in original.rglob("*")
              if path.is_file() and "__pycache__" not in path.parts}
    for path in [path for path in copy.rglob("*") if path.is_file() and path.relative_to(copy) not in wanted]:
        path.unlink()
    for name, path in wanted.items():
        target = copy / name
        if not target.is_file() or target.read_bytes() != path.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)


def _make(build, package, may_fail=False):
    return _call("cmake", "--build", str(build), "-j", str(os.cpu_count()), "--target", f"{package}_unit_tests",
                 may_fail=may_fail)


def _tests(build, package, tests):
    environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    return _call(str(build / f"{package}_unit_tests"), f"--gtest_filter={tests}", "--gtest_fail_fast", may_fail=True,
                 env=environment)


def _call(*command, may_fail=False, env=None):
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=LIMIT_S, env=env)
    except subprocess.TimeoutExpired:
        return 1
    if done.returncode and not may_fail:
        raise RuntimeError(f"{' '.join(command)}:\n{done.stdout.decode(errors='replace')[-4000:]}")
    return done.returncode
