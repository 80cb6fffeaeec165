"""The public API: who imports what, which types it states, and one error for all of it."""

import ast
import pathlib
import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest

import aras_visual_servo as avs

ROOT = pathlib.Path(__file__).resolve().parents[2]
#: Modules of the core that are public as a whole.
MODULES = {"spatial", "processes", "palette"}
DEEP = re.compile(r"\b(?:from|import) aras_visual_servo\.([\w.]+)")
NAMES = re.compile(r"\bfrom aras_visual_servo import (\([^)]*\)|[^\n\\]+)")
ATTRIBUTE = re.compile(r"\bavs\.(\w+)")
USERS = [ROOT / "README.md", ROOT / "docs/tutorial.ipynb", *ROOT.glob("docs/*.md"), *ROOT.glob("examples/*.py"),
         *(path for name in ("controller", "study", "learning")
           for path in ROOT.glob(f"src/aras_visual_servo_{name}/src/**/*.py"))]


def not_public(text: str) -> set:
    """Returns the names that a text imports or uses of the core and that are not public."""
    deep = {name for name in DEEP.findall(text) if name not in MODULES}
    used = set(ATTRIBUTE.findall(text))
    for names in NAMES.findall(text):
        used |= {name.split()[0] for name in names.strip("()").replace("\n", " ").split("#")[0].split(",")
                 if name.strip()}
    return deep | (used - set(avs.__all__) - MODULES - {"__version__"})


@pytest.mark.parametrize("path", USERS, ids=lambda path: str(path.relative_to(ROOT)))
def test_only_public_names_are_used(path):
    assert not_public(path.read_text(encoding="utf-8")) == set()


def test_what_is_not_public_is_found():
    text = ("from aras_visual_servo import (run,\n  Hidden)\nimport aras_visual_servo.laws.base\navs.nothing\n"
            "from aras_visual_servo.spatial import se3\nfrom aras_visual_servo_study.sweep import run\navs.judge")
    assert not_public(text) == {"Hidden", "laws.base", "nothing"}


@pytest.mark.parametrize("name", sorted(avs.__all__))
def test_a_public_name_exists(name):
    assert getattr(avs, name) is not None


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


aras_visual_servo = pytest.importorskip("aras_visual_servo")
aras_visual_servo_camera = pytest.importorskip("aras_visual_servo_camera")
aras_visual_servo_common = pytest.importorskip("aras_visual_servo_common")
aras_visual_servo_sim = pytest.importorskip("aras_visual_servo_sim")
CAMERA = {"width": 64, "height": 48, "K": [60, 0, 32, 0, 60, 24, 0, 0, 1], "D": [], "distortion_model": "none"}


def of_the_simulator():
    aras_visual_servo_sim.Simulation("<robot", {})


def of_a_section():
    aras_visual_servo_camera.MomentExtractor(CAMERA, {"object": "drak", "orders": None})


def of_an_image():
    aras_visual_servo_camera.TagExtractor(CAMERA).process(np.zeros((2, 3, 5), np.uint8))


def of_the_kinematics():
    from aras_visual_servo import _kinematics
    _kinematics.ChainKinematics("<robot", "a", "b")


@pytest.mark.parametrize("action, name", [(of_the_simulator, "ModelError"), (of_a_section, "ParameterError"),
                                          (of_an_image, "ShapeError"), (of_the_kinematics, "ModelError")])
def test_each_binding_raises_the_common_class(action, name):
    with pytest.raises(aras_visual_servo_common.ArasError) as caught:
        action()
    assert type(caught.value) is getattr(aras_visual_servo_common, name)


def test_the_packages_export_the_common_classes():
    for package in (aras_visual_servo, aras_visual_servo_camera, aras_visual_servo_sim):
        assert package.ArasError is aras_visual_servo_common.ArasError
        assert package.ParameterError is aras_visual_servo_common.ParameterError


def test_a_parameter_error_lists_its_faults():
    with pytest.raises(aras_visual_servo_common.ParameterError) as caught:
        of_a_section()
    assert {fault.split(": ")[0] for fault in caught.value.faults} == {"vision.object", "vision.segmentation",
                                                                       "vision.orders"}
    assert all(part in str(caught.value) for part in ("did you mean dark?", "did you mean order?"))
