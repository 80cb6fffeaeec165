"""Runs that several tests look at are made once; what tests compared with others is written down."""
import functools
import json
import os

import numpy as np
import pytest


@functools.lru_cache(maxsize=None)
def _run(name, changes):
    from aras_visual_servo_controller.run.judge import run_in_process
    from aras_visual_servo_controller.scenario.scenario import load_scenario

    return run_in_process(load_scenario(name, overrides=dict(changes)))


@pytest.fixture(scope="session")
def run():
    """A function: (scenario name, {dotted path: value}) -> RunRecord of the run in this process."""
    return lambda name, changes=None: _run(name, tuple(sorted((changes or {}).items())))


@pytest.fixture
def compared():
    """A function: (what, against, differences, bound, unit) fails when one of the differences is not within the bound.

    What it found is added, a line of JSON each, to the file that ARAS_COMPARED names, if any: script/validation makes
    the table of docs/validation.md of it.
    """

    def say(what, against, differences, bound, unit="relative"):
        differences = np.asarray(differences, dtype=float)
        assert differences.size > 0 and np.isfinite(differences).all(), f"{what}: {differences}"
        worst = float(differences.max())
        if "ARAS_COMPARED" in os.environ:
            with open(os.environ["ARAS_COMPARED"], "a") as file:
                file.write(json.dumps({"what": what, "against": against, "cases": differences.size, "worst": worst,
                                       "bound": bound, "unit": unit}) + "\n")
        assert worst <= bound, f"{what} against {against}: off by {worst:.3g} {unit}, allowed {bound:.3g}"

    return say
