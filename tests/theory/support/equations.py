"""The numbered equations of docs/theory.md, the formulas that the tests write out, and which test holds which equation.

    @formula("T4")
    def an(z_star, a_star, a):
        \"\"\"an = Z* sqrt(a* / a)\"\"\"          # each line of this stands in T4 of docs/theory.md
        return z_star * np.sqrt(a_star / a)

    @equation("T4")
    def test_an_is_the_depth_of_a_parallel_plane(): ...

A test takes no arguments, so that test_every_equation.py can run it again with one coefficient of a formula changed.
What does not depend on a formula (differences of exact pictures, the product's answers) is kept: `functools.lru_cache`.
"""
import ast
import inspect
import pathlib
import re
import textwrap

import numpy as np

THEORY = pathlib.Path(__file__).resolve().parents[3] / "docs" / "theory.md"
#: Of the largest entry that is compared: some hundred operations in double precision.
ROUNDING = 1e-10
#: Formulas and tests by the number of their equation.
FORMULAS, TESTS = {}, {}


class Formula:
    """An equation's formula; calls go to `function`, which may be exchanged for a while.

    Attributes: number: of the equation, "T4".  original, function: of Python.  lines: of the text it is written after.
    """

    def __init__(self, number, function):
        self.number, self.original, self.function = number, function, function
        self.lines = [line.strip() for line in (function.__doc__ or "").splitlines() if line.strip()]

    def __call__(self, *arguments):
        return self.function(*arguments)

    def tree(self):
        """Its syntax tree without decorator and docstring."""
        tree = ast.parse(textwrap.dedent(inspect.getsource(self.original)))
        tree.body[0].decorator_list, tree.body[0].body = [], tree.body[0].body[1:]
        return tree


def formula(number):
    """Decorator: this function is a formula of that equation."""

    def add(function):
        made = Formula(number, function)
        FORMULAS.setdefault(number, []).append(made)
        return made

    return add


def equation(*numbers):
    """Decorator: this test, a function without arguments, holds these equations."""

    def add(test):
        for number in numbers:
            TESTS.setdefault(number, []).append(test)
        return test

    return add


def same(found, expected, tolerance=ROUNDING, what=""):
    """Fail where `found` is off by more than this part of the largest entry of `expected`."""
    found, expected = np.asarray(found), np.asarray(expected)
    assert found.shape == expected.shape, f"{what}: shape {found.shape}, expected {expected.shape}"
    off = np.abs(found - expected).max()
    assert off <= tolerance * np.abs(expected).max(), f"{what}: found {found}, expected {expected}, off by {off}"


def paragraphs(text):
    """{"T4": its text, up to the next equation or heading} of a page like docs/theory.md."""
    parts = re.split(r"^\*\*\((T\d+)\)\*\*|^##.*$", text, flags=re.MULTILINE)
    # re.split keeps the number between the texts; a heading leaves None there.
    return {number: body for number, body in zip(parts[1::2], parts[2::2]) if number}


def squeezed(text):
    """Text without what may differ between page and docstring: white space and the marks of code."""
    return re.sub(r"[\s`]", "", text)


def code_of(paragraph):
    """Pieces of code in a paragraph that state an equation: lines of blocks, and inline code with a `=` or a `<-`."""
    blocks = re.findall(r"```\n(.*?)```", paragraph, flags=re.DOTALL)
    inline = re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", paragraph, flags=re.DOTALL))
    equations = [code for code in inline if "=" in code or "<-" in code]
    return [line for block in blocks for line in block.splitlines()] + equations


def numbers_in(text):
    """Numbers of a line of a formula, right of the first `=` if it has one.

    The digits of names such as mu20 are none, nor is what says that a matrix is inverted or when something is.
    """
    right = re.sub(r"\^-1\b|\(0\)", " ", text.split("=", 1)[-1])
    return {float(number) for number in re.findall(r"(?<![\w.])\d+(?:\.\d+)?", right)}
