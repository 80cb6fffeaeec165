"""Statistics against published tables, pairing, the gate's expressions, and metrics by name."""

import math
import warnings
from dataclasses import replace

import numpy as np
import pytest
from synthetic import make_record

from aras_visual_servo import ParameterError
from aras_visual_servo_study.compare.sweeps import compare_pair, format_comparison, gate_fires, numbers_of
from aras_visual_servo_study.sweep.judge import COLUMNS, judge_row
from aras_visual_servo_study.sweep.metrics import judge_by, known_metrics, METRICS, Outcome
from aras_visual_servo_study.sweep.report import rate_labels
from aras_visual_servo_study.sweep.statistics import aggregate, mcnemar, reasons, signed_rank, success_curve, wilson

#: Tables give four digits.
TABLE = 5e-5


def row(number, success=1, outcome=None, time_s=2.0, error_mm=0.1, start=0.0, reason="converged"):
    return {"id": number, "outcome": outcome or ("success" if success else "failure"), "success": success,
            "strict": success, "converged": success, "duration_s": time_s, "error_mm": error_mm,
            "angle_deg": 0.01, "reason": reason, "start_J1": start + number}


@pytest.mark.parametrize("successes, count, low, high", [
    (81, 263, 0.2553, 0.3662),   # Newcombe, Statistics in Medicine 17, 1998, table I, method 3
    (15, 148, 0.0624, 0.1605),
    (0, 20, 0.0000, 0.1611),
    (1, 29, 0.0061, 0.1718),
])
def test_wilson_gives_newcombes_table(successes, count, low, high):
    assert wilson(successes, count) == pytest.approx((low, high), abs=TABLE)


def test_wilson_is_symmetric_and_whole_without_data():
    low, high = wilson(20, 20)
    assert high == 1.0 and low == pytest.approx(1.0 - wilson(0, 20)[1])
    assert wilson(0, 0) == (0.0, 1.0)
    assert wilson(1, 1) == (pytest.approx(1.0 / (1.0 + 1.959963984540054**2)), 1.0)


def test_mcnemar_is_the_binomial_sign_test():
    assert mcnemar(1, 9) == pytest.approx(2 * (1 + 10) / 2 ** 10)  # by hand
    assert mcnemar(5, 5) == 1.0 and mcnemar(0, 0) == 1.0


def test_signed_rank_gives_wilcoxons_own_example():
    # Darwin's cross- and self-fertilised Zea mays, eighths of an inch (Fisher, Design of Experiments, table 3):
    # W = 24, two-sided exact p = 0.0413.
    difference = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]
    assert signed_rank(difference, [0] * len(difference)) == pytest.approx(0.0413, abs=TABLE)
    assert signed_rank([1.0, 2.0], [1.0, 2.0]) == 1.0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert signed_rank([*difference, 5.0], [0] * len(difference) + [5.0]) == pytest.approx(0.0413, abs=TABLE)
    assert math.isnan(signed_rank([], []))
    a, b = [0.3, 0.2, 0.9, 2.7, 1.1, 0.7], [0.2, 0.3, 0.4, 2.9, 1.0, 0.5]  # 0.3 - 0.2 is not 0.1
    assert signed_rank(a, b) == signed_rank(b, a)


def test_the_curve_counts_every_run_once():
    curve = success_curve([0.0, 1.0, 2.0, 3.0, 4.0], [1, 1, 1, 0, 0], bins=2)
    assert [(point["count"], point["rate"]) for point in curve] == [(2, 1.0), (3, pytest.approx(1 / 3))]
    assert success_curve([], []) == []
    curve = success_curve([0.0, 1.0, 10.0], [1, 1, 0], bins=5)
    assert [(point["low"], point["high"], point["count"]) for point in curve] == [(0.0, 2.0, 2), (8.0, 10.0, 1)]


def test_infeasible_starts_do_not_count_against_the_law():
    rows = [row(1), row(2, 0, reason="timed out"), row(3, 0, "infeasible", reason="target not in view at the start"),
            row(4, 0, "error", None, None, reason="error: ValueError")]
    numbers = aggregate(rows)
    assert numbers["success"] == pytest.approx(1 / 3)
    assert (numbers["runs"], numbers["feasible"], numbers["infeasible"], numbers["errors"]) == (4, 3, 1, 1)
    assert reasons(rows + [row(5, 0, reason="timed out")]) == [
        ("failure", "timed out", [2, 5]), ("error", "error: ValueError", [4]),
        ("infeasible", "target not in view at the start", [3])]


def test_pairs_compare_success_time_and_error():
    a = [row(i, success=i != 3, time_s=2.0) for i in range(1, 11)]
    b = [row(i, success=i > 5, time_s=3.0, error_mm=0.1 + 0.01 * i) for i in range(1, 11)]
    result = compare_pair(a, b)
    assert (result["pairs"], result["only_a"], result["only_b"]) == (10, 4, 0)
    assert result["success_change"] == pytest.approx(-0.4)
    assert result["mcnemar_p"] == pytest.approx(0.125)
    assert result["time_change_s"] == pytest.approx(1.0)
    assert result["time_p"] == pytest.approx(2 / 2 ** 5)  # five pairs, all one way
    assert "McNemar p" in format_comparison(["a", "b"], [a, b])


def test_pairs_compare_the_angle_too():
    """B is slower and no nearer to the goal, and less turned in nine pairs of ten."""
    a = [dict(row(i), angle_deg=0.01) for i in range(1, 11)]
    b = [dict(row(i), angle_deg=0.01 - 0.001 * i if i > 1 else 0.011) for i in range(1, 11)]
    result = compare_pair(a, b)
    assert result["angle_change_deg"] == pytest.approx(-0.0055)
    assert 2 / 2 ** 10 < result["angle_p"] < 0.01 and result["error_p"] == 1.0
    assert gate_fires("B.angle_change_deg < 0 and angle_p < 0.05", numbers_of([a, b]))[0]
    assert "-0.00550" in format_comparison(["a", "b"], [a, b])


def test_sweeps_of_other_starts_cannot_be_paired():
    with pytest.raises(ParameterError, match="run 1: the starts differ"):
        compare_pair([row(1)], [row(1, start=0.5)])


NUMBERS = {"success": 0.97, "time_median_s": 2.0, "A.time_median_s": 1.0, "error_median_mm": math.nan}


@pytest.mark.parametrize("expression, fires", [
    ("success<0.98", True), ("success < 0.97", False), ("success<0.98 and time_median_s>3", False),
    ("success<0.9 or time_median_s > 1.1*A.time_median_s", True), ("not (success >= 0.97)", False),
    ("0.9 < success <= 0.97", True), ("-success + 1 > 0.5/2", False), ("error_median_mm > 1", True),
])
def test_gates_fire_when_they_hold_or_have_no_value(expression, fires):
    assert gate_fires(expression, NUMBERS)[0] is fires


@pytest.mark.parametrize("expression, message", [
    ("succes<0.98", "found succes, allowed success, time_median_s"),
    ("success", "allowed a comparison"), ("success<", "not an expression"), ("1/0 < success", "divides by zero"),
    ("__import__('os').system('true') < 1", "allowed are numbers"), ("success < '1'", "allowed are numbers"),
    ("success and 1", "where a comparison must stand"), ("2**9 > success", "allowed are numbers"),
    ("(success<1) + 1 > 0", "where a number must stand"), ("", "not an expression"),
])
def test_other_expressions_are_refused_with_a_reason(expression, message):
    with pytest.raises(ParameterError, match=message.replace("(", r"\(")):
        gate_fires(expression, NUMBERS)


def test_a_name_without_a_letter_is_of_the_last_sweep():
    numbers = numbers_of([[row(1)], [row(1, 0)]])
    assert (numbers["A.success"], numbers["B.success"], numbers["success"]) == (1.0, 0.0, 0.0)
    assert "A.mcnemar_p" not in numbers and numbers["B.mcnemar_p"] == 1.0


def test_parts_of_times_and_errors_are_those_of_the_runs_that_succeeded():
    rows = [row(k, time_s=float(k), error_mm=0.1 * k) for k in range(1, 22)] + [row(22, 0, time_s=99.0, error_mm=9.0)]
    numbers = aggregate(rows)
    assert (numbers["time_median_s"], numbers["time_p95_s"], numbers["time_max_s"]) == (11.0, 20.0, 21.0)
    assert (numbers["error_median_mm"], numbers["error_max_mm"]) == (pytest.approx(1.1), pytest.approx(2.1))
    assert (numbers["failures"], numbers["success"]) == (1, pytest.approx(21 / 22))


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
