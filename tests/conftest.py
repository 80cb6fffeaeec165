"""Runs that several tests look at are made once; what tests compared with others is written down."""
import functools
import importlib
import json
import os
import pathlib
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "tests" / "support"))


@functools.lru_cache(maxsize=None)
def _run(name, changes):
    import aras_visual_servo as avs

    return avs.run(avs.load_scenario(name, overrides=dict(changes)))


@pytest.fixture(scope="session")
def run():
    """A function: (scenario name, {dotted path: value}) -> RunRecord of the run in this process."""
    return lambda name, changes=None: _run(name, tuple(sorted((changes or {}).items())))


@pytest.fixture(scope="session")
def docs():
    """A function: name of a module of script/pictures -> that module."""
    return _docs


@functools.lru_cache(maxsize=None)
def _docs(name):
    folder = str(ROOT / "script" / "pictures")
    if folder not in sys.path:
        sys.path.append(folder)
    return importlib.import_module(name)


#: The worst difference that a test finds is that of docs/validation.md to this factor: rounding differs from one
#: machine to the next. Below the second, a difference is rounding anyway.
STALE, ROUNDING = 10.0, 1e-11


@pytest.fixture
def compared(request):
    """A function: (what, against, differences, bound, unit) fails when one of the differences is not within the bound.

    It also fails when docs/validation.md says something else of this comparison. With ARAS_COMPARED in the environment
    that page is about to be made anew: what was found is added, a line of JSON each, to the file of that name.
    """

    def say(what, against, differences, bound, unit="relative"):
        differences = np.asarray(differences, dtype=float)
        assert differences.size > 0 and np.isfinite(differences).all(), f"{what}: {differences}"
        worst = float(differences.max())
        assert worst <= bound, f"{what} against {against}: off by {worst:.3g} {unit}, allowed {bound:.3g}"
        found = {"cases": differences.size, "worst": worst, "bound": bound, "unit": unit}
        if "ARAS_COMPARED" in os.environ:
            entry = {"group": request.path.parent.name, "what": what, "against": against, **found}
            with open(os.environ["ARAS_COMPARED"], "a") as file:
                file.write(json.dumps(entry) + "\n")
        else:
            _same_as_said(found, what, against)

    return say


def _same_as_said(found, what, against):
    said = _docs("validation").read((ROOT / "docs" / "validation.md").read_text()).get((what, against))
    again = "script/validation makes the page again"
    assert said is not None, f"docs/validation.md: found no row '{what} | {against}'; {again}"
    for key in ("cases", "bound", "unit"):
        assert found[key] == said[key], f"docs/validation.md, {what}: {key} is {said[key]}, found {found[key]}; {again}"
    same = said["worst"] / STALE <= found["worst"] <= said["worst"] * STALE
    assert same or max(found["worst"], said["worst"]) < ROUNDING, \
        f"docs/validation.md, {what}: worst is {said['worst']:.1e}, found {found['worst']:.1e}; {again}"
