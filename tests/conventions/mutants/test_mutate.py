"""script/mutate: faults are where the operators say, and tests that look kill what others let live."""
import ast
import pathlib
import sys

import pytest

sys.path.append(str(pathlib.Path(__file__).resolve().parent))

import cpp_module  # noqa: E402
import lines  # noqa: E402
import operators  # noqa: E402
import python_module  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]

EXAMPLES = {
    "compare": ("x = a < b\n", "x = a <= b\n"),
    "negate": ("if a:\n    f()\n", "if not a:\n    f()\n"),
    "logic": ("x = a and b\n", "x = a or b\n"),
    "arithmetic": ("x = a @ b\n", "x = b @ a\n"),
    "sign": ("x = -a\n", "x = a\n"),
    "number": ("x = 0.1\n", "x = 0.2\n"),
    "function": ("x = np.minimum(a, b)\n", "x = np.maximum(a, b)\n"),
    "delete": ("self.x = a\n", "pass\n"),
    "return": ("def f():\n    return a\n", "def f():\n    return\n"),
}


@pytest.mark.parametrize("operator", EXAMPLES)
def test_every_operator_makes_the_fault_that_its_line_says(operator):
    source, wanted = EXAMPLES[operator]
    [index] = [k for k, (name, _) in enumerate(operators.mutants(source)) if name == operator]
    found, before, after = operators.mutated(source, index)
    assert found == wanted and before != after
    assert f"\n    {operator} " in operators.__doc__


def test_the_operators_that_are_listed_are_those_there_are():
    listed = {line.split()[0] for line in operators.__doc__.splitlines() if line.startswith("    ")}
    assert listed == set(EXAMPLES)


def test_what_a_reader_sees_is_left_alone():
    source = '"""Two words."""\nx: int = setting(help="at 1", unit="m")\nraise E(f"found {1 + 1}, allowed {-2}")\n'
    assert [operator for operator, _ in operators.mutants(source)] == ["delete"]
    assert [line for _, line in operators.mutants("plot(x, linewidth=2.0)\nplot(2.0, y)\n")] == [1, 2, 2]


def test_mutants_of_every_room_compile_and_differ():
    for module in ("laws", "servo"):
        drawn, total = python_module.chosen(module, 40, 0)
        assert len(drawn) == 40 < total and drawn == python_module.chosen(module, 40, 0)[0]
        assert drawn != python_module.chosen(module, 40, 1)[0]
        for file, index, _, line in drawn:
            source, before, after = operators.mutated(file.read_text(), index)
            assert ast.dump(ast.parse(source)) != ast.dump(ast.parse(file.read_text())) and before != after and line > 0


def test_tests_of_a_module_are_those_of_its_room():
    [file] = python_module.sources("servo/stop_rule")
    tests = python_module.tests_of(file)
    assert "test_stop_rule.py" in {test.name for test in tests} and {test.parent.name for test in tests} == {"servo"}
    with pytest.raises(ValueError, match="found 'lows', allowed .*laws"):
        python_module.sources("lows")


def test_tests_that_run_a_line_come_first_then_those_of_its_function():
    source = "A = 1\n\n\ndef f():\n    if A:\n        return 1\n    return 2\n\n\ndef g():\n    return 3\n"
    recorded = {"seconds": {"a::slow": 9.0, "b::quick": 0.1, "b::other": 0.2, "c::g": 0.3},
                "lines": {"file": {"5": ["a::slow", "b::quick", "b::other"], "6": ["a::slow", "b::other"],
                                   "7": ["b::quick"], "11": ["c::g"]}}}
    assert lines.tests_that_run(recorded, "file", source, 6) == ["b::other", "a::slow", "b::quick"]
    assert lines.tests_that_run(recorded, "file", source, 11) == ["c::g"]
    assert set(lines.tests_that_run(recorded, "file", source, 1)) == set(recorded["seconds"])
    assert lines.tests_that_run(recorded, "elsewhere", source, 6) == []
    assert lines.in_function(source, 6) and not lines.in_function(source, 1)


def test_a_default_that_no_test_looks_at_is_held_against_the_tables(tmp_path):
    [file] = python_module.sources("servo/lost_target")
    source = file.read_text()
    assert source.count("5, at_least=1, help=\"Recoveries") == 1
    changed = source.replace("5, at_least=1, help=\"Recoveries", "6, at_least=1, help=\"Recoveries")
    copy = python_module.Copy(tmp_path)
    for text, code in ((source, 0), (changed, 1)):
        with copy.holding(file, text):
            assert copy.test([], 60, lines.Order([]), tables=True)[0] == code


def test_a_test_that_looks_kills_what_one_that_does_not_lets_live(tmp_path, monkeypatch):
    package, tests = tmp_path / "src" / "aras_visual_servo_controller", tmp_path / "test"
    (package / "room").mkdir(parents=True)
    (tests / "room").mkdir(parents=True)
    for folder in (package, package / "room"):
        (folder / "__init__.py").write_text("")
    (package / "room" / "sums.py").write_text("def total(a, b):\n    return a + b\n\n\n"
                                              "def gap(a, b):\n    return a - b\n")
    (tests / "room" / "test_sums.py").write_text(
        "from aras_visual_servo_controller.room.sums import gap, total\n\n\n"
        "def test_total():\n    assert total(1, 2) == 3\n\n\ndef test_gap():\n    gap(1, 2)\n")
    monkeypatch.setattr(python_module, "PACKAGE", package)
    monkeypatch.setattr(python_module, "TESTS", tests)
    said = []
    killed, survivors = python_module.run("room", 100, 0, said.append)
    assert killed == 2 and len(survivors) == 2 and all("sums.py:6" in text for text in survivors), said
    assert (package / "room" / "sums.py").read_text().count("+") == 1, "the source is as it was"


@pytest.mark.parametrize("name", cpp_module.modules())
def test_every_mutant_of_a_list_has_one_place(name):
    listed = cpp_module.load(name)
    assert set(listed) - {"survivors"} == {"package", "tests", "mutants"} and len(listed["mutants"]) >= 40
    assert set(listed.get("survivors") or ()) <= {mutant["why"] for mutant in listed["mutants"]}
    for mutant in listed["mutants"]:
        assert set(mutant) == {"file", "old", "new", "why"}, mutant
        text = (ROOT / "src" / listed["package"] / mutant["file"]).read_text()
        assert text.count(mutant["old"]) == 1 and mutant["new"] != mutant["old"], mutant


class FakeCore(cpp_module.Core):
    """A core whose tests take ten seconds, and fail where its text has a fault."""
    fault, limits_s = "nowhere", []

    def __init__(self, package, folder):
        self.source = ROOT / "src" / package

    def link(self, file, text):
        self._text = text
        return True

    def test(self, tests, limit_s):
        self.limits_s.append(limit_s)
        return int(self.fault in self._text), 10.0


def test_a_mutant_has_a_multiple_of_the_time_that_its_file_as_it_is_takes_when_compiled_alike(monkeypatch):
    monkeypatch.setattr(cpp_module, "Core", FakeCore)
    monkeypatch.setattr(FakeCore, "limits_s", [])
    cpp_module.run("pid", lambda text: None)
    files = {mutant["file"] for mutant in cpp_module.load("pid")["mutants"]}
    assert sorted(set(FakeCore.limits_s)) == [10.0 * cpp_module.TOO_LONG, cpp_module.LIMIT_S]
    assert FakeCore.limits_s.count(cpp_module.LIMIT_S) == len(files)


def test_tests_that_fail_without_a_mutant_are_refused_by_the_name_of_the_file(monkeypatch):
    monkeypatch.setattr(cpp_module, "Core", FakeCore)
    monkeypatch.setattr(FakeCore, "fault", "")
    with pytest.raises(RuntimeError, match="pid.cpp: the tests fail without a mutant"):
        cpp_module.run("pid", lambda text: None)
