"""Every public function of the Python packages has a type for each argument and for what it returns."""

import ast
import re
from collections import Counter
from pathlib import Path

import pytest

SRC = Path(__file__).resolve().parents[2] / "src"
PACKAGES = [f"aras_visual_servo{name}" for name in ("", "_controller", "_study", "_learning")]


def functions(node, of_class=False):
    """(function, whether it is a method) of every public one in a module or class."""
    for part in node.body:
        public = not part.name.startswith("_") or part.name == "__init__" if hasattr(part, "name") else False
        if isinstance(part, ast.ClassDef) and public:
            yield from functions(part, True)
        elif isinstance(part, ast.FunctionDef) and public:
            yield part, of_class and not any(getattr(one, "id", "") == "staticmethod" for one in part.decorator_list)


def missing(function, method):
    """Names of the arguments without a type, and "return" if what it returns has none."""
    given = function.args
    arguments = [*given.posonlyargs, *given.args][method:] + given.kwonlyargs + [given.vararg, given.kwarg]
    return [one.arg for one in arguments if one and not one.annotation] + ["return"] * (function.returns is None)


@pytest.mark.parametrize("package", PACKAGES)
def test_public_signatures_are_annotated(package):
    files = sorted((SRC / package / "src" / package).rglob("*.py"))
    found = [f"{path.relative_to(SRC)}:{function.lineno} {function.name}: {', '.join(names)}" for path in files
             for function, method in functions(ast.parse(path.read_text(encoding="utf-8")))
             if (names := missing(function, method))]
    assert files and not found, "\n".join(found)


def test_a_public_name_stands_once_in_the_stub():
    stub = (SRC / PACKAGES[0] / "src" / PACKAGES[0] / "__init__.pyi").read_text(encoding="utf-8")
    counts = Counter(re.findall(r" as (\w+)$", stub, re.M))
    assert counts and max(counts.values()) == 1, counts.most_common(3)
