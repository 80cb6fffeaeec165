"""Every numbered equation of docs/theory.md has a test of that very formula, which fails when a coefficient changes."""
import ast
import importlib
import pathlib

import pytest
from equations import (FORMULAS, TESTS, THEORY, Formula, code_of, numbers_in, paragraphs, same, squeezed)
from mutants import mutants, survivors

for _path in sorted(pathlib.Path(__file__).parent.glob("test_*_equations.py")):
    importlib.import_module(_path.stem)

PARAGRAPHS = paragraphs(THEORY.read_text())
#: {equation: {what is changed: why no test can see it}}
SEEN_BY_NO_TEST = {}
#: {equation: pieces of code in it that state no formula of it}
NO_FORMULA = {}


def faults(numbers, tested):
    """What is wrong between the equations there are and those that tests name."""
    return sorted([f"{number} has no test" for number in numbers if number not in tested]
                  + [f"a test names {number}, which docs/theory.md does not have" for number in tested
                     if number not in numbers])


def test_every_equation_has_a_test_and_every_test_an_equation():
    assert faults(PARAGRAPHS, TESTS) == []
    assert faults(PARAGRAPHS, FORMULAS) == []


def test_an_equation_without_a_test_is_seen_and_one_that_is_none():
    page = "## A\n\n**(T1)** `a = b`.\n\n**(T2)** Text.\n\n## B\n\nNo equation.\n\n**(T7)** `c = d`.\n"
    assert list(paragraphs(page)) == ["T1", "T2", "T7"]
    assert "No equation" not in "".join(paragraphs(page).values())
    assert faults(paragraphs(page), {"T1": [], "T7": [], "T9": []}) == [
        "T2 has no test", "a test names T9, which docs/theory.md does not have"]


def test_every_equation_is_numbered_once():
    page = THEORY.read_text()
    assert len(PARAGRAPHS) == page.count("\n**(T")


@pytest.mark.parametrize("number", PARAGRAPHS)
def test_formulas_are_written_after_the_text(number):
    text = squeezed(PARAGRAPHS[number])
    for one in FORMULAS.get(number, []):
        assert one.lines, f"{one.original.__name__} quotes nothing of {number}"
        missing = [line for line in one.lines if squeezed(line) not in text]
        assert missing == [], f"{one.original.__name__}: not in {number} of docs/theory.md"
        written = {float(node.value) for node in ast.walk(one.tree())
                   if isinstance(node, ast.Constant) and type(node.value) in (int, float)}
        lost = set().union(*map(numbers_in, one.lines)) - written
        assert lost == set(), f"{one.original.__name__}: numbers of the text that are not in the function"


@pytest.mark.parametrize("number", PARAGRAPHS)
def test_every_formula_of_the_text_is_evaluated(number):
    quoted = [squeezed("".join(one.lines)) for one in FORMULAS.get(number, [])]
    left = [code for code in code_of(PARAGRAPHS[number]) if not any(squeezed(code) in text for text in quoted)]
    assert left == NO_FORMULA.get(number, [])


@pytest.mark.parametrize("number", PARAGRAPHS)
def test_a_changed_coefficient_makes_a_test_fail(number):
    assert survivors(FORMULAS[number], TESTS[number]) == list(SEEN_BY_NO_TEST.get(number, []))


def _example(x, y):
    """2 x - y / 3 + sqrt(y)"""
    return 2 * x - y / 3 + (y**0.5)


def test_the_change_of_coefficients_sees_a_test_that_cannot_fail():
    one = Formula("an example", _example)
    assert one(1.0, 9.0) == 2.0
    changed = [text for text, _ in mutants(one)]
    assert len(changed) == 8 and changed[0].startswith("_example: 2 becomes 2.02")

    def blind():
        assert one(1.0, 9.0) > 1.0

    def sharp():
        same([one(1.0, 9.0), one(2.0, 1.0)], [2.0, 14.0 / 3.0])

    assert survivors([one], [blind]) == changed
    assert survivors([one], [blind, sharp]) == []
