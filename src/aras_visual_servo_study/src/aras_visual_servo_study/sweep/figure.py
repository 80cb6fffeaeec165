"""Figures of a sweep: maps of the convergence domain, success against distance, and why runs failed."""

import difflib
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import ParameterError, palette
from ..report.drawing import Drawing, drawn_side_by_side, prepare
from .metrics import METRICS
from .statistics import every_run_succeeds, reasons, success_curve

FIGURES = ("map", "curve", "reasons")
DEFAULT_AXES = ("x0_mm", "y0_mm")
#: Columns that may be axes of a map, together with start_*, offset_*, goal_* and those of p_* that hold numbers.
AXES = ("x0_mm", "y0_mm", "z0_mm", "distance0_mm", "angle0_deg")
LABELS = {"x0_mm": "initial $x$ [mm]", "y0_mm": "initial $y$ [mm]", "z0_mm": "initial $z$ [mm]",
          "distance0_mm": "initial distance [mm]", "angle0_deg": "initial angle [deg]",
          "goal_distance_mm": "distance of the goal [mm]", "duration_s": "time to the end [s]",
          "duration_s_a": "time to the end of A [s]"}
#: A column that differs by less than this hardly varies [mm, deg]: the arm does not come to rest in the same place.
HARDLY = 0.1


def known_axes(rows: List[Dict[str, Any]]) -> List[str]:
    """Columns that a map can be drawn over."""
    extra = [name for name in (rows[0] if rows else {}) if name.startswith(("start_", "offset_", "goal_", "p_"))
             and all(row[name] is None or isinstance(row[name], (int, float)) for row in rows)]
    return [*AXES, *extra]


def check_axes(axes: Sequence[str], rows: List[Dict[str, Any]]) -> Tuple[str, ...]:
    """The two axes. Raises ParameterError listing the known ones, with the nearest name."""
    known, faults = known_axes(rows), []
    for axis in axes:
        if axis not in known:
            near = difflib.get_close_matches(axis, known, 1)
            faults.append(f"--axes: found {axis}, allowed {', '.join(known)}"
                          + (f"; did you mean {near[0]}?" if near else ""))
    if faults:
        raise ParameterError(faults)
    return tuple(axes)


def default_axes(rows: List[Dict[str, Any]], time: str = "duration_s") -> Tuple[str, ...]:
    """Returns the two axes of the maps of a sweep: the first columns that vary.

    A sweep in one coordinate has the column `time` as its second axis.
    """
    perturbed = [name for name in known_axes(rows) if name.startswith("p_") and _spread(rows, name) > 0.0]
    places = [name for name in (*DEFAULT_AXES, "z0_mm", "angle0_deg") if _spread(rows, name) > HARDLY]
    axes = tuple([*places, *perturbed, time][:2])
    return axes if len(axes) == 2 and all(name in rows[0] for name in axes) else DEFAULT_AXES


def distance_column(rows: List[Dict[str, Any]]) -> str:
    """Returns the column that says how far away a start is: the angle where only that varies."""
    turned = _spread(rows, "distance0_mm") <= HARDLY < _spread(rows, "angle0_deg")
    return "angle0_deg" if turned else "distance0_mm"


def _spread(rows, column):
    found = [row[column] for row in rows if row.get(column) is not None]
    return max(found) - min(found) if found else 0.0


def make_figure(name: str, rows: List[Dict[str, Any]], axes: Optional[Tuple[str, ...]] = None) -> Any:
    """One of FIGURES as a matplotlib Figure; the same rows give the same picture. axes: None for `default_axes`."""
    import matplotlib  # slow to import, and not needed where the runs are done

    from ..report.figure import STYLE
    with matplotlib.rc_context(STYLE):
        if name == "map":
            return _map(rows, axes or default_axes(rows))
        return _curve(rows) if name == "curve" else _reasons(rows)


def save_figures(rows: List[Dict[str, Any]], folder: Path, axes: Tuple[str, ...],
                 drawing: Optional[Drawing] = None) -> Dict[str, bytes]:
    """Write NAME.png and NAME.pdf of every figure; {name: png bytes}.

    Args: drawing: `Drawing` that has imported what it needs meanwhile; None: it is imported here.
    """
    jobs = [(name, rows, folder, axes) for name in FIGURES]
    if drawing is not None:
        return dict(zip(FIGURES, drawing.side_by_side(_save_figure, jobs)))
    prepare()
    return dict(zip(FIGURES, drawn_side_by_side(_save_figure, jobs)))


def _save_figure(name, rows, folder, axes):
    from ..report.figure import save_both
    return save_both(make_figure(name, rows, axes), folder / name, 150)


def _map(rows, axes):
    from matplotlib.figure import Figure
    figure = Figure(figsize=(11.0, 4.2), constrained_layout=True)
    placed = [row for row in rows if row[axes[0]] is not None and row[axes[1]] is not None]
    feasible = [row for row in placed if row["outcome"] != "infeasible"]
    refused = [row for row in placed if row["outcome"] == "infeasible"]
    cells = _cell_edges(feasible, axes)
    limits_of = [_limits(values) for values in _columns(placed, axes)] if placed else None
    success = [] if every_run_succeeds(placed) else [("success [%]", "success", feasible, "RdYlBu", (0.0, 100.0))]
    panels = (*success,
              ("time to the end [s]", "duration_s", [r for r in feasible if r["success"]], "viridis", None),
              ("final error [mm]", "error_mm", [r for r in feasible if r["error_mm"] is not None], "viridis", None))
    for index, (title, column, chosen, colours, limits) in enumerate(panels):
        panel = figure.add_subplot(1, len(panels), index + 1)
        panel.set_title(f"{title}   (×: start refused)" if refused and index == 0 else title, loc="left")
        panel.set_xlabel(LABELS.get(axes[0], axes[0]))
        panel.set_ylabel(LABELS.get(axes[1], axes[1]))
        panel.grid(False)
        if limits_of:
            panel.set(xlim=limits_of[0], ylim=limits_of[1])
        if refused:
            panel.scatter(*_columns(refused, axes), marker="x", s=12, linewidths=0.7, c=palette.GREY)
        if chosen:
            x, y = _columns(chosen, axes)
            values = (100.0 if column == "success" else 1.0) * np.array([row[column] for row in chosen], dtype=float)
            norm = _norm(column, values, limits)
            _cells(panel, x, y, values, colours, norm, cells)
            dots = panel.scatter(x, y, c=values, cmap=colours, norm=norm, s=14, linewidths=0.4, edgecolors="#333333")
            figure.colorbar(dots, ax=panel, shrink=0.9)
    return figure


def _norm(column, values, limits):
    from matplotlib.colors import LogNorm, Normalize
    if limits:
        return Normalize(*limits)
    low, high = float(values.min()), float(values.max())
    # A run that was lost ends a thousand times farther away than the others; only a logarithmic scale shows both.
    return LogNorm(max(low, 1e-6), max(high, 2e-6)) if column == "error_mm" and high > 100.0 * low else \
        Normalize(low, high if high > low else low + 1e-9)


def _limits(values):
    margin = 0.03 * (values.max() - values.min()) or 1.0
    return values.min() - margin, values.max() + margin


def _cell_edges(rows, axes):
    """Edges (x, y) of a grid of cells with about four points in each; None if there are too few points or no area."""
    if len(rows) < 16:
        return None
    x, y = _columns(rows, axes)
    count = int(np.clip(np.sqrt(len(x) / 4.0), 2, 20))
    if x.min() == x.max() or y.min() == y.max():
        return None
    return np.linspace(x.min(), x.max(), count + 1), np.linspace(y.min(), y.max(), count + 1)


def _cells(panel, x, y, values, colours, norm, edges):
    """Draw the mean of each cell behind the points."""
    if edges is None:
        return
    total, edges_x, edges_y = np.histogram2d(x, y, bins=edges)
    sums, _, _ = np.histogram2d(x, y, bins=edges, weights=values)
    means = np.ma.masked_invalid(np.divide(sums, total, out=np.full_like(sums, np.nan), where=total > 0))
    panel.pcolormesh(edges_x, edges_y, means.T, cmap=colours, norm=norm, alpha=0.45, linewidth=0, rasterized=True)


def _curve(rows):
    from matplotlib.figure import Figure
    figure = Figure(figsize=(6.2, 3.7), constrained_layout=True)
    panel = figure.add_subplot()
    column = distance_column(rows)
    feasible = [row for row in rows if row["outcome"] != "infeasible" and row[column] is not None]
    distances = [row[column] for row in feasible]
    bins = int(np.clip(len(feasible) // 12, 3, 10))
    shift = 0.006 * (max(distances) - min(distances)) if distances else 0.0  # equal curves do not hide each other
    for name, colour, style, sign in (("success", palette.BLUE, "o-", -1), ("strict", palette.VERMILION, "s--", 1)):
        curve = success_curve(distances, [row[name] for row in feasible], bins)
        if curve:
            x = np.array([point["middle"] for point in curve]) + sign * shift
            rate = 100.0 * np.array([point["rate"] for point in curve])
            low, high = (100.0 * np.array([point[key] for point in curve]) for key in ("ci_low", "ci_high"))
            panel.errorbar(x, rate, [np.maximum(0, rate - low), np.maximum(0, high - rate)], color=colour, fmt=style,
                           markersize=4, linewidth=1.2, elinewidth=1.0, capsize=2.5,
                           label=f"{METRICS[name].label}: {METRICS[name].threshold}")
    panel.set_ylim(-3.0, 103.0)
    panel.set_xlabel(LABELS[column])
    panel.set_ylabel("success [%], 95 % Wilson")
    if distances:
        panel.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    return figure


def _reasons(rows):
    from matplotlib.figure import Figure
    found = reasons(rows)[:12]
    figure = Figure(figsize=(6.2, max(1.6, 0.7 + 0.34 * len(found))), constrained_layout=True)
    panel = figure.add_subplot()
    if not found:
        panel.text(0.5, 0.5, "every run succeeded", ha="center", va="center", transform=panel.transAxes,
                   color=palette.GREY)
        panel.set_axis_off()
        return figure
    colours = {"infeasible": palette.GREY, "failure": palette.VERMILION, "error": "#7a1f1f"}
    names = [reason for _, reason, _ in found][::-1]
    counts = [len(ids) for _, _, ids in found][::-1]
    bars = panel.barh(range(len(found)), counts, color=[colours[outcome] for outcome, _, _ in found][::-1])
    panel.bar_label(bars, padding=2, fontsize=8)
    panel.set_yticks(range(len(found)), names)
    panel.set_xlabel("runs (grey: start refused, not counted against the law)")
    panel.grid(False, axis="y")
    return figure


def _columns(rows, axes):
    return tuple(np.array([row[axis] for row in rows], dtype=float) for axis in axes)
