"""What a sweep shows: figures, summary, progress."""

import json
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import LogNorm

from aras_visual_servo_study.sweep import engine
from aras_visual_servo_study.sweep.figure import (
    _cell_edges, _norm, AXES, default_axes, distance_column, known_axes, LABELS, make_figure)
from aras_visual_servo_study.sweep.map import sweep_maps
from aras_visual_servo_study.sweep.report import format_summary, setting_rows


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
    wanted = {"success [%]": tried, "time to the end [s]": [one for one in tried if one["success"]],
              "final error [mm]": tried}
    panels = [axes for axes in make_figure("map", ROWS).axes if axes.get_title(loc="left")]
    assert len(panels) == 3
    for panel, (title, rows) in zip(panels, wanted.items()):
        assert panel.get_title(loc="left").startswith(title)
        crosses, *_, dots = [one for one in panel.collections if len(one.get_offsets()) > 1]
        assert places(crosses) == at(refused) and places(dots) == at(rows)
        column = {"s": "success", "t": "duration_s", "f": "error_mm"}[title[0]]
        factor = 100.0 if column == "success" else 1.0
        np.testing.assert_allclose(sorted(dots.get_array()), sorted(factor * one[column] for one in rows))
        (left, right), (low, high) = panel.get_xlim(), panel.get_ylim()
        assert left < 0.0 and right > 40.0 and low < -15.0 and high > 0.0
    assert "start refused" in panels[0].get_title(loc="left")
    assert (panels[0].collections[-1].norm.vmin, panels[0].collections[-1].norm.vmax) == (0.0, 100.0)


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


def test_the_curve_has_a_point_for_each_bin_and_metric_with_its_interval():
    panel = make_figure("curve", ROWS).axes[0]
    success, strict = panel.containers
    # 23 runs from 5 to 125 mm are three bins of 40 mm; both curves are moved aside by 0.6 % of the way.
    for container, side in ((success, -1.0), (strict, 1.0)):
        for x, y, low in zip(*container[0].get_data(), (5.0, 45.0, 85.0)):
            tried = [one for one in ROWS if one["outcome"] != "infeasible" and low <= one["distance0_mm"] < low + 40.0
                     or one["distance0_mm"] == low + 40.0 == 125.0]
            assert x == pytest.approx(np.mean([one["distance0_mm"] for one in tried]) + side * 0.006 * 120.0)
            assert y == pytest.approx(100.0 * np.mean([one["success"] for one in tried]))
        assert len(container[0].get_xdata()) == 3
    assert panel.get_ylim() == pytest.approx((-3.0, 103.0))


def test_reasons_are_counted_and_without_a_failure_it_is_said():
    assert [text.get_text() for text in make_figure("reasons", [row(1)]).axes[0].texts] == ["every run succeeded"]
    assert "every run succeeded" not in [text.get_text() for text in make_figure("reasons", ROWS).axes[0].texts]


@pytest.mark.parametrize("varies, axes", [
    ({}, ("x0_mm", "y0_mm")), ({"y0_mm": 1e-4}, ("x0_mm", "duration_s")),
    ({"y0_mm": 1e-4, "angle0_deg": 1.0}, ("x0_mm", "angle0_deg")),
    ({"y0_mm": 1e-4, "p_noise": 1e-3, "p_target": "a"}, ("x0_mm", "p_noise")),
    ({"x0_mm": 1e-4, "y0_mm": 1e-4, "z0_mm": 1.0}, ("z0_mm", "duration_s"))])
def test_the_maps_of_a_sweep_in_few_coordinates_have_axes_that_vary(varies, axes):
    rows = [row(k, **{name: step if isinstance(step, str) else k * step for name, step in varies.items()})
            for k in range(1, 25)]
    assert default_axes(rows) == axes
    panel = make_figure("map", rows).axes[0]
    assert (panel.get_xlabel(), panel.get_ylabel()) == tuple(LABELS.get(axis, axis) for axis in axes)
    data = json.loads(sweep_maps(rows, axes))
    assert {axes[0], axes[1]} <= {one["key"] for one in data["axes"]} and {*axes} <= {*data["columns"]}


def test_success_of_starts_that_are_only_turned_is_shown_over_the_angle():
    rows = [row(k, distance0_mm=1e-3 * k, angle0_deg=float(k)) for k in range(1, 25)]
    panel = make_figure("curve", rows).axes[0]
    assert panel.get_xlabel() == LABELS["angle0_deg"] and len(panel.containers[0][0].get_xdata()) == 3
    assert distance_column(ROWS) == "distance0_mm"


def test_axes_are_columns_that_hold_numbers_or_nothing():
    rows = [row(1, p_noise=1.0, start_J1=None, p_target="a", offset_x=2),
            row(2, p_noise=None, start_J1=0.5, p_target=None, offset_x=3)]
    assert known_axes(rows)[-3:] == ["p_noise", "start_J1", "offset_x"] and "p_target" not in known_axes(rows)
    assert known_axes([]) == list(AXES) == ["x0_mm", "y0_mm", "z0_mm", "distance0_mm", "angle0_deg"]


def summary_row(number, outcome="success", **more):
    won = int(outcome == "success")
    return {"id": number, "outcome": outcome, "success": won, "strict": 0, "cns": won, "vit_vs": None,
            "converged": won, "reason": outcome, "duration_s": 2.0 * number, "error_mm": 0.01 * number,
            "angle_deg": 0.001 * number, **more}


def summary(rows):
    store = SimpleNamespace(rows=lambda: rows, meta={"setup": {"scenario": {"name": "mine"}}})
    return format_summary(store).splitlines()


def test_without_a_success_no_time_is_told():
    said = summary([summary_row(1, "failure", reason="timed out", success=0)])
    assert said[-1] == "     1 failure     timed out: id 1" and not any("median" in line for line in said)


@pytest.mark.parametrize("section, rows", [
    ({"ranges": {"x_m": (-0.1, 0.25)}}, [("range of x", "-100 to 250 mm")]),
    ({"goal": {"tilt_rad": (0.0, 0.5)}}, [("goal, range of tilt", "0 to 28.6479 deg")]),
    ({"perturb": {"noise_stddev": "[0, 2]"}}, [("perturbed: noise_stddev", "[0, 2]")])])
def test_the_page_lists_what_a_sweep_varied(section, rows):
    settings = {"starts": 9, "method": "grid", "space": "camera", "seed": 4, "ranges": {}, "goal": {}, "perturb": {}}
    first = [("starts", "9"), ("method", "grid"), ("space", "camera"), ("seed", "4")]
    assert setting_rows({"settings": {**settings, **section}}) == first + rows


@pytest.mark.parametrize("count, workers, sizes", [
    (1, 1, [1]), (9, 1, [2, 2, 2, 2, 1]), (64, 2, [8] * 8), (63, 2, [7] * 9), (1000, 1, [8] * 125), (4, 8, [1] * 4)])
def test_every_worker_is_given_four_pieces_at_least_and_none_has_more_than_eight_runs(count, workers, sizes):
    pieces = engine._chunks(list(range(count)), workers)
    assert [len(piece) for piece in pieces] == sizes and sum(pieces, []) == list(range(count))


class Screen:
    """A stream. Args: terminal: whether it says that it is one."""

    def __init__(self, terminal):
        self.text, self.isatty = "", lambda: terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


def progress_of(terminal, seconds, every_s=10.0, total=4, done=()):
    """What is shown when a run comes in at each of these times."""
    now, screen = [0.0], Screen(terminal)
    progress = engine.Progress(total, done, screen, every_s, lambda: now[0])
    for now[0] in seconds:
        progress.add([{"outcome": "success"}])
    progress.end()
    return screen.text


def test_a_terminal_has_one_line_that_is_written_again():
    text = progress_of(True, [0.19, 0.2, 0.3, 0.39])
    assert text.startswith("\r2/4 runs") and text.count("\r") == 2 and text.endswith("4 success\n")
    assert text.count("\n") == 1


def test_a_file_has_a_new_line_from_time_to_time_and_one_at_the_end():
    lines = progress_of(False, [9.9, 10.0, 19.9, 19.95]).splitlines()
    assert [line.split("  ")[0] for line in lines] == ["2/4 runs", "4/4 runs"]
    assert progress_of(False, [9.9, 10.0, 19.9], total=5).count("\n") == 1


def test_progress_tells_rate_and_time_left():
    now = iter([0.0, 5.0, 5.0, 10.0, 10.0, 10.0])
    before = [{"outcome": "success"}] * 20
    progress = engine.Progress(100, before, stream=sys.stderr, every_s=5.0, clock=lambda: next(now))
    progress.add([{"outcome": "success"}] * 9 + [{"outcome": "failure"}])
    assert "30/100 runs" in progress.line()
    assert "1.0 runs/s  1 min 10 s left  29 success, 1 failure" in progress.line()
