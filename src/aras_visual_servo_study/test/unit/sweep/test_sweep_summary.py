"""What a sweep says at the terminal and in its page: every number of it, where it belongs."""
from types import SimpleNamespace

import pytest

from aras_visual_servo_study.sweep.report import format_summary, setting_rows


def row(number, outcome="success", **more):
    won = int(outcome == "success")
    return {"id": number, "outcome": outcome, "success": won, "strict": 0, "cns": won, "vit_vs": None,
            "converged": won, "reason": outcome, "duration_s": 2.0 * number, "error_mm": 0.01 * number,
            "angle_deg": 0.001 * number, **more}


def summary(rows):
    store = SimpleNamespace(rows=lambda: rows, meta={"setup": {"scenario": {"name": "mine"}}})
    return format_summary(store).splitlines()


def test_the_summary_tells_counts_rates_times_errors_and_reasons():
    rows = [*(row(k) for k in range(1, 22)), *(row(k, "failure", reason="timed out") for k in range(22, 25)),
            row(25, "error", reason="error: ValueError"), row(26, "infeasible", reason="out of reach")]
    assert summary(rows) == [
        "mine: 26 runs, 25 feasible, 1 starts refused, 1 errors",
        "success             84.00 %   (95 %: 65.35 to 93.60 %)",
        "strict              0.00 %   (95 %: 0.00 to 13.32 %)",
        "CNS                 84.00 %   (95 %: 65.35 to 93.60 %)",
        "converged           84.00 %   (95 %: 65.35 to 93.60 %)",
        "time, median        22.00 s simulated, 95 % below 40.00 s",
        "error, median       0.1100 mm, 95 % below 0.2000 mm",
        "     3 failure     timed out",
        "     1 error       error: ValueError",
        "     1 infeasible  out of reach"]


def test_without_a_success_no_time_is_told():
    said = summary([row(1, "failure", reason="timed out", success=0)])
    assert said[-1] == "     1 failure     timed out" and not any("median" in line for line in said)


@pytest.mark.parametrize("section, rows", [
    ({"ranges": {"x_m": (-0.1, 0.25)}}, [("range of x_m", "-0.1 to 0.25")]),
    ({"goal": {"tilt_rad": (0.0, 0.5)}}, [("goal, range of tilt_rad", "0 to 0.5")]),
    ({"perturb": {"noise_stddev": "[0, 2]"}}, [("perturbed: noise_stddev", "[0, 2]")])])
def test_the_page_lists_what_a_sweep_varied(section, rows):
    settings = {"starts": 9, "method": "grid", "space": "camera", "seed": 4, "ranges": {}, "goal": {}, "perturb": {}}
    first = [("starts", "9"), ("method", "grid"), ("space", "camera"), ("seed", "4")]
    assert setting_rows({"settings": {**settings, **section}}) == first + rows
