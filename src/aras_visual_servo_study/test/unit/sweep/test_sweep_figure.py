"""What the figures of a sweep show: which runs are on which panel, the scales of the colours, the cells behind them."""

import json

import numpy as np
import pytest
from matplotlib.colors import LogNorm

from aras_visual_servo_study.sweep.figure import AXES, _cell_edges, _limits, _norm, known_axes, make_figure
from aras_visual_servo_study.sweep.map import start_facts, sweep_maps


def row(number, outcome="success", **more):
    won = int(outcome == "success")
    return {"id": number, "outcome": outcome, "success": won, "strict": won, "converged": won, "reason": outcome,
            "x0_mm": 10.0 * (number % 5), "y0_mm": -3.0 * (number // 5), "distance0_mm": 5.0 * number,
            "duration_s": 1.0 + 0.1 * number, "error_mm": 0.01 * number if outcome != "infeasible" else None, **more}


ROWS = [row(k, "infeasible" if k in (3, 7) else "failure" if k % 6 == 5 else "success") for k in range(1, 26)]


def places(scatter):
    return {tuple(place) for place in np.asarray(scatter.get_offsets()).tolist()}


def at(rows):
    return {(one["x0_mm"], one["y0_mm"]) for one in rows}


def test_each_map_has_the_runs_it_speaks_of_and_a_cross_for_each_refused_start():
    refused = [one for one in ROWS if one["outcome"] == "infeasible"]
    tried = [one for one in ROWS if one["outcome"] != "infeasible"]
    wanted = {"success rate": tried, "time to the end [s]": [one for one in tried if one["success"]],
              "final error [mm]": tried}
    panels = [axes for axes in make_figure("map", ROWS).axes if axes.get_title(loc="left")]
    assert len(panels) == 3
    for panel, (title, rows) in zip(panels, wanted.items()):
        assert panel.get_title(loc="left").startswith(title)
        crosses, *_, dots = [one for one in panel.collections if len(one.get_offsets()) > 1]
        assert places(crosses) == at(refused) and places(dots) == at(rows)
        column = {"s": "success", "t": "duration_s", "f": "error_mm"}[title[0]]
        np.testing.assert_allclose(sorted(dots.get_array()), sorted(one[column] for one in rows))
        (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
        assert left < 0.0 and right > 40.0 and low < -15.0 and high > 0.0
    assert "start refused" in panels[0].get_title(loc="left")
    assert (panels[0].collections[-1].norm.vmin, panels[0].collections[-1].norm.vmax) == (0.0, 1.0)


def test_where_every_run_succeeds_there_is_no_map_of_it():
    titles = [axes.get_title(loc="left") for axes in make_figure("map", [row(k) for k in range(1, 20)]).axes]
    assert [title for title in titles if title] == ["time to the end [s]", "final error [mm]"]


@pytest.mark.parametrize("column, values, log, low, high", [
    ("error_mm", [0.1, 100.0], True, 0.1, 100.0), ("error_mm", [1.0, 100.0], False, 1.0, 100.0),
    ("error_mm", [1.0, 100.1], True, 1.0, 100.1),
    ("error_mm", [0.0, 1e-9], True, 1e-6, 2e-6), ("duration_s", [0.1, 100.0], False, 0.1, 100.0),
    ("duration_s", [2.0, 2.0], False, 2.0, 2.0 + 1e-9)])
def test_errors_a_hundred_times_apart_have_a_logarithmic_scale(column, values, log, low, high):
    norm = _norm(column, np.array(values), None)
    assert isinstance(norm, LogNorm) == log and (norm.vmin, norm.vmax) == pytest.approx((low, high), rel=1e-12)


def test_cells_are_about_four_runs_large_and_need_an_area():
    rows = [row(k) for k in range(25)]
    x, y = _cell_edges(rows, ("x0_mm", "y0_mm"))
    np.testing.assert_allclose(x, [0.0, 20.0, 40.0])  # sqrt(25 / 4) is 2.5
    np.testing.assert_allclose(y, [-12.0, -6.0, 0.0])
    assert _cell_edges(rows[:15], ("x0_mm", "y0_mm")) is None
    assert _cell_edges([row(5 * k) for k in range(20)], ("x0_mm", "y0_mm")) is None
    assert _cell_edges([row(k % 5) for k in range(20)], ("x0_mm", "y0_mm")) is None


def test_limits_leave_a_margin():
    assert _limits(np.array([0.0, 100.0])) == pytest.approx((-3.0, 103.0))
    assert _limits(np.array([5.0, 5.0])) == (4.0, 6.0)


def test_the_curve_has_a_point_for_each_bin_and_metric_with_its_interval():
    panel = make_figure("curve", ROWS).axes[0]
    success, strict = panel.containers
    # 23 runs are one bin; both curves are moved aside by 0.6 % of the way.
    for container, side in ((success, -1.0), (strict, 1.0)):
        (x,), (y,) = container[0].get_data()
        tried = [one for one in ROWS if one["outcome"] != "infeasible"]
        assert x == pytest.approx(np.mean([one["distance0_mm"] for one in tried]) + side * 0.006 * 120.0)
        assert y == pytest.approx(np.mean([one["success"] for one in tried]))
    assert panel.get_ylim() == pytest.approx((-0.03, 1.03))


def test_reasons_are_counted_and_without_a_failure_it_is_said():
    assert [text.get_text() for text in make_figure("reasons", [row(1)]).axes[0].texts] == ["every run succeeded"]
    assert "every run succeeded" not in [text.get_text() for text in make_figure("reasons", ROWS).axes[0].texts]


def test_axes_are_columns_that_hold_numbers_or_nothing():
    rows = [row(1, p_noise=1.0, start_J1=None, p_target="a", offset_x=2),
            row(2, p_noise=None, start_J1=0.5, p_target=None, offset_x=3)]
    assert known_axes(rows)[-3:] == ["p_noise", "start_J1", "offset_x"] and "p_target" not in known_axes(rows)
    assert known_axes([]) == list(AXES) == ["x0_mm", "y0_mm", "z0_mm", "distance0_mm", "angle0_deg"]


def test_under_the_pointer_a_map_tells_the_result_and_how_far_the_start_was():
    rows = [dict(one, angle0_deg=1.0) for one in ROWS]
    facts = json.loads(sweep_maps(rows, ("x0_mm", "y0_mm")))["facts"]
    assert {one["key"] for one in facts if one["short"]} == {"outcome", "reason", "duration_s", "error_mm",
                                                             "distance0_mm", "angle0_deg"}


def test_axes_of_a_map_have_the_names_of_their_columns():
    panels = [axes for axes in make_figure("map", ROWS, ("distance0_mm", "y0_mm")).axes if axes.get_title(loc="left")]
    assert {(panel.get_xlabel(), panel.get_ylabel()) for panel in panels} == {("initial distance [mm]",
                                                                              "initial $y$ [mm]")}


def test_a_start_is_told_with_the_digits_of_each_length_and_angle_and_joints_by_their_own_names():
    rows = [{"start_J1": 0.1, "start_start_x": None, "offset_x_m": 0.2, "p_target": "blob"}]
    found = [(one["key"], one["label"], one["unit"], one["digits"]) for one in start_facts(rows)]
    assert found == [
        ("distance0_mm", "initial distance", "mm", 1), ("angle0_deg", "initial angle", "deg", 2),
        ("x0_mm", "initial x", "mm", 2), ("y0_mm", "initial y", "mm", 2), ("z0_mm", "initial z", "mm", 2),
        ("start_J1", "start, J1", "", 4), ("start_start_x", "start, start_x", "", 4),
        ("offset_x_m", "offset_x_m", "", 4), ("p_target", "target", "", None)]
