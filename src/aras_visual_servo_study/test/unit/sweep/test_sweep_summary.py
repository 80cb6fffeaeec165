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
