"""Helpers of the packages' tests, and where these tests find them; figures of what was compared."""
import json
import os
import pathlib
import sys

import numpy as np
import pytest

SRC = pathlib.Path(__file__).resolve().parents[2] / "src"
sys.path[:0] = [str(SRC / "aras_visual_servo_controller/test/support"), str(SRC / "aras_visual_servo_camera/test/unit")]


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
