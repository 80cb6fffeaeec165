"""Asks ViSP's own vpServo: the program visp_servo, built from visp_servo.cpp."""
import json
import os
import pathlib
import subprocess

import numpy as np

PLACE = "lib/aras_visual_servo_tests/visp_servo"


def program():
    """Path of the program; AssertionError where the workspace was built without its tests."""
    for prefix in os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep):
        if (pathlib.Path(prefix) / PLACE).exists():
            return pathlib.Path(prefix) / PLACE
    raise AssertionError(f"{PLACE}: not found in CMAKE_PREFIX_PATH, build with script/bootstrap --test")


def visp_servo(cases):
    """[{"twist": (6,), "error": (k,), "matrix": (k, 6)}] of cases as visp_servo.cpp describes them."""
    text = json.dumps(cases, default=lambda value: np.asarray(value).tolist())
    done = subprocess.run([program()], input=text, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    answers = [{key: np.array(value) for key, value in one.items()} for one in json.loads(done.stdout)]
    for one in answers:
        one["matrix"] = one["matrix"].reshape(-1, 6)
    assert len(answers) == len(cases)
    return answers
