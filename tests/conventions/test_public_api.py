"""Pages, examples and the packages built on the core import its public names only, and every public name exists."""
import pathlib
import re

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
    return deep | (used - set(avs.__all__) - MODULES)


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
