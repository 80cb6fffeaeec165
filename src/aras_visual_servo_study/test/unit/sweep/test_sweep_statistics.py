"""Statistics against published tables, pairing, and the gate's expressions."""

import math

import pytest

from aras_visual_servo.ground.errors import ParameterError
from aras_visual_servo_study.compare.sweeps import compare_pair, format_comparison, gate_fires, numbers_of
from aras_visual_servo_study.sweep.statistics import (aggregate, mcnemar, reasons, signed_rank, success_curve,
                                                      wilson)

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


def test_mcnemar_is_the_binomial_sign_test():
    assert mcnemar(1, 9) == pytest.approx(2 * (1 + 10) / 2 ** 10)  # by hand
    assert mcnemar(5, 5) == 1.0 and mcnemar(0, 0) == 1.0


def test_signed_rank_gives_wilcoxons_own_example():
    # Darwin's cross- and self-fertilised Zea mays, eighths of an inch (Fisher, Design of Experiments, table 3):
    # W = 24, two-sided exact p = 0.0413.
    difference = [49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48]
    assert signed_rank(difference, [0] * len(difference)) == pytest.approx(0.0413, abs=TABLE)
    assert signed_rank([1.0, 2.0], [1.0, 2.0]) == 1.0
    assert math.isnan(signed_rank([], []))


def test_the_curve_counts_every_run_once():
    curve = success_curve([0.0, 1.0, 2.0, 3.0, 4.0], [1, 1, 1, 0, 0], bins=2)
    assert [(point["count"], point["rate"]) for point in curve] == [(2, 1.0), (3, pytest.approx(1 / 3))]
    assert success_curve([], []) == []


def test_infeasible_starts_do_not_count_against_the_law():
    rows = [row(1), row(2, 0, reason="timed out"), row(3, 0, "infeasible", reason="target not in view at the start"),
            row(4, 0, "error", None, None, reason="error: ValueError")]
    numbers = aggregate(rows)
    assert numbers["success"] == pytest.approx(1 / 3)
    assert (numbers["runs"], numbers["feasible"], numbers["infeasible"], numbers["errors"]) == (4, 3, 1, 1)
    assert [count for _, _, count in reasons(rows)] == [1, 1, 1]


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
    ("success", "allowed is a comparison"), ("success<", "not an expression"), ("1/0 < success", "divides by zero"),
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


def test_one_run_has_an_interval_too():
    assert wilson(1, 1) == (pytest.approx(1.0 / (1.0 + 1.959963984540054**2)), 1.0)


def test_every_bin_of_the_curve_has_its_edges_and_the_last_run_is_in_the_last_bin():
    curve = success_curve([0.0, 1.0, 10.0], [1, 1, 0], bins=5)
    assert [(point["low"], point["high"], point["count"]) for point in curve] == [(0.0, 2.0, 2), (8.0, 10.0, 1)]
