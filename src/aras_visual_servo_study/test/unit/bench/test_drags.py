"""bench/drags.py tells true statuses from false ones."""

import importlib.util
import pathlib
from dataclasses import replace

import numpy as np
import pytest

from aras_visual_servo import Status
from aras_visual_servo.scenario import reach_map

PATH = pathlib.Path(__file__).resolve().parents[3] / "bench" / "drags.py"
NAME = "experiment_1"


@pytest.fixture(scope="module")
def bench():
    spec = importlib.util.spec_from_file_location("drags_bench", PATH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("number", [0, 5])
def test_after_a_drag_the_arm_rests_in_time_and_the_status_is_true(bench, monkeypatch, number):
    monkeypatch.setattr(reach_map, "SIDE", 9)
    row = bench.drag((NAME, number, 1))
    assert row["true"] and row["rest_s"] < bench.REST_S, row
    assert row["status"] == ("CONVERGED" if row["green"] else "OUT_OF_REACH")


def test_a_false_status_is_found(bench):
    run = bench.begun(NAME)
    image, X_WC, starts = np.array(run.image), run.camera_pose(), [run.joints()]
    aside, beyond = X_WC.copy(), X_WC.copy()
    aside[1, 3] += 0.01
    beyond[0, 3] += 0.2

    def true(status, wanted):
        return bench.judged(run, replace(run.record, status=status), image, wanted, X_WC, starts)[0]

    assert true(Status.CONVERGED, X_WC) and not true(Status.CONVERGED, aside)
    assert not true(Status.OUT_OF_REACH, X_WC) and not true(Status.OUT_OF_REACH, aside)
    assert not true(Status.OUT_OF_REACH, beyond)  # it stands where it was, and not at the nearest point
    assert not true(Status.TARGET_LOST, X_WC) and not true(Status.TIMED_OUT, beyond)
