"""Metrics of a sweep by name: each at its threshold, and computed for every run."""
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from synthetic import make_record

from aras_visual_servo_study.sweep.judge import COLUMNS, judge_row
from aras_visual_servo_study.sweep.metrics import METRICS, Outcome, judge_by, known_metrics
from aras_visual_servo_study.sweep.report import rate_labels
from aras_visual_servo_study.sweep.statistics import aggregate

#: Began 200 mm and 30 deg away, the goal 600 mm from the target.
START = {"distance0_mm": 200.0, "angle0_deg": 30.0, "goal_distance_mm": 600.0}


def holds(name, error_mm, angle_deg, **changes):
    return METRICS[name].holds(Outcome(error_mm, angle_deg, **{**START, **changes}))


@pytest.mark.parametrize("name, error_mm, angle_deg", [
    ("success", 20.0, 10.0), ("strict", 1.0, 0.3), ("cns", 60.0, 10.0), ("vit_vs", 20.0, 3.0)])
def test_a_metric_holds_below_both_its_thresholds(name, error_mm, angle_deg):
    below = 1.0 - 1e-9
    assert holds(name, below * error_mm, below * angle_deg)
    assert not holds(name, error_mm, below * angle_deg) and not holds(name, below * error_mm, angle_deg)


def test_cns_measures_by_the_goal_and_not_by_the_start():
    assert holds("cns", 59.0, 9.0, distance0_mm=1.0, angle0_deg=1.0)
    assert not holds("cns", 59.0, 9.0, goal_distance_mm=500.0)


def test_vit_vs_measures_both_by_the_start():
    assert not holds("vit_vs", 59.0, 0.0) and not holds("vit_vs", 0.0, 9.0)
    assert holds("vit_vs", 59.0, 9.0, distance0_mm=600.0, angle0_deg=100.0)


def test_a_metric_says_nothing_of_runs_it_has_no_measure_for():
    assert holds("cns", 0.0, 0.0, goal_distance_mm=None) is None
    assert holds("vit_vs", 0.0, 0.0, angle0_deg=0.0) is None and holds("vit_vs", 0.0, 0.0, distance0_mm=0.0) is None
    assert holds("success", 0.5, 0.0, distance0_mm=0.0)  # which is why it has a millimetre of its own


def test_every_metric_is_a_column_a_number_and_a_row_of_the_page():
    names = [one.name for one in known_metrics()]
    assert names == ["success", "strict", "cns", "vit_vs"] and set(names) < set(COLUMNS)
    numbers, shown = aggregate([]), {name: (label, source) for label, name, source in rate_labels()}
    for one in known_metrics():
        assert {one.name, f"{one.name}_low", f"{one.name}_high"} < set(numbers)
        assert one.threshold in shown[one.name][0] and one.source == shown[one.name][1]
        assert one.holds.__doc__ and ("Source:" in one.holds.__doc__)


def test_a_run_without_an_end_fails_all_of_them():
    assert judge_by(None) == dict.fromkeys([one.name for one in known_metrics()], 0)


def test_a_rate_counts_the_runs_that_the_metric_speaks_of():
    row = {"outcome": "success", "success": 1, "strict": 1, "cns": 0, "vit_vs": None, "converged": 1,
           "duration_s": 1.0, "error_mm": 0.1, "angle_deg": 0.1}
    numbers = aggregate([row, {**row, "vit_vs": 1}, {**row, "cns": 1, "vit_vs": 0}])
    assert numbers["vit_vs"] == 0.5 and numbers["cns"] == pytest.approx(1 / 3) and numbers["strict"] == 1.0


def test_the_goal_is_as_far_from_the_origin_as_the_target_is():
    record = make_record()
    assert judge_row(record)["goal_distance_mm"] is None and judge_row(record)["cns"] is None
    X_WT = np.eye(4)
    X_WT[:3, 3] = record.X_WC[record.rows("teach")[-1]][:3, 3] + [0.0, 0.3, 0.4]
    row = judge_row(replace(record, X_WT=X_WT))
    assert row["goal_distance_mm"] == pytest.approx(500.0) and row["cns"] == 1


def test_a_metric_is_known_to_whoever_asks_first():
    asks = "from aras_visual_servo_study.sweep.metrics import METRICS; print(METRICS['vit_vs'].label)"
    said = subprocess.run([sys.executable, "-c", asks], stdout=subprocess.PIPE, text=True, check=True,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}).stdout
    assert said.strip() == METRICS["vit_vs"].label == "ViT-VS"
