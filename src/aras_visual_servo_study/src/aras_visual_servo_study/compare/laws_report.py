"""Writes the results of a comparison of laws: comparison.{csv,png,pdf,html}, and the table for the terminal.

The figure has a row per task and a line per law. The same runs give the same files.
"""

import base64
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, List, Sequence, Tuple

import matplotlib.lines
import numpy as np
from matplotlib.figure import Figure

from aras_visual_servo import palette
from ..files import write_whole
from ..report.figure import STYLE, save_both
from ..report.template import render
from ..report.versions import installed_versions
from ..sweep import store
from .laws import Comparison, Results

#: Columns of the table: name in the row, heading, format.
TABLE = (("error_mm", "error [mm]", "{:.2f}"), ("angle_deg", "[deg]", "{:.3f}"), ("duration_s", "time [s]", "{:.1f}"),
         ("path_mm", "path [mm]", "{:.0f}"), ("detour_mm", "detour [mm]", "{:.0f}"),
         ("farthest_mm", "farthest [mm]", "{:.0f}"), ("joint_room", "joint room", "{:.2f}"),
         ("border_px", "border [px]", "{:.0f}"))
#: A law has arrived if the camera ends this close to the goal. The limits are loose: a law whose features hardly tell a
#: tilt may stop more than a millimetre away.
ARRIVED_MM, ARRIVED_DEG = 2.0, 0.5
COLUMNS = ("outcome", "reason", "detail", "converged", "distance0_mm", "angle0_deg", "error_mm", "x_mm", "y_mm", "z_mm",
           "angle_deg", "duration_s", "images", "path_mm", "detour_mm", "farthest_mm", "joint_room", "border_px",
           "run_hash", "trace_hash")
#: Colours of laws and joints. The ninth law has the first colour again, with the next dash of STYLES.
COLOURS = (palette.BLUE, palette.VERMILION, palette.GREEN, palette.PURPLE, "#E69F00", "#56B4E9", "#000000", "#997700")
STYLES = ("-", (0, (4, 1.5)), (0, (1, 1.2)))
#: Smaller values are drawn at this height of the logarithmic axes [mm, deg].
FLOOR_MM, FLOOR_DEG = 0.01, 0.001
PANELS = ("distance from the goal [mm]", "angle left [deg]", "retreat along the axis [mm]", "target in the image [px]")
#: Laws in one row of the legend of a figure 12 inches wide; height of such a row, and the room around all of them,
#: above the panels [inch].
LEGEND_COLUMNS, LEGEND_ROW_IN, LEGEND_IN = 8, 0.2, 0.15


def arrived(row: Dict[str, Any]) -> bool:
    """Whether the true camera pose at the end is within ARRIVED_MM and ARRIVED_DEG of the goal."""
    return row["error_mm"] is not None and row["error_mm"] < ARRIVED_MM and row["angle_deg"] < ARRIVED_DEG


def verdict(row: Dict[str, Any]) -> str:
    """How a run ended in a word or two."""
    if row["outcome"] == "infeasible":
        return f"refused: {row['reason']}"
    if arrived(row):
        return "arrived" if row["converged"] else f"arrived, {row['reason']}"
    return "converged elsewhere" if row["converged"] else row["reason"]


def cells(row: Dict[str, Any]) -> List[str]:
    """The cells of a row of TABLE as texts, empty where there is no value."""
    return ["" if row[column] is None else form.format(row[column]) for column, _, form in TABLE]


def csv_text(results: Results) -> str:
    """The results as CSV text, one row per task and law."""
    rows = ([task, law, *(row[name] for name in COLUMNS)] for task, law, row, _ in results)
    return store.csv_text(["task", "law", *COLUMNS], rows)


def format_table(comparison: Comparison, results: Results) -> str:
    """The table as text for the terminal, a block per task."""
    width = max(12, *(len(law) + 2 for law in comparison.scenarios))
    lines = [f"{comparison.name}: {comparison.description}"]
    for task in comparison.tasks:
        lines += ["", task.title.ljust(width + 26) + "".join(f"{title:>14}" for _, title, _ in TABLE)]
        lines += [f"  {law:<{width}}{verdict(row):<24}" + "".join(f"{cell:>14}" for cell in cells(row))
                  for name, law, row, _ in results if name == task.name]
    return "\n".join(lines)


def save_comparison(comparison: Comparison, results: Results, folder: Path, command: str) -> Path:
    """Writes all files into an existing folder. Returns the path of comparison.html. Raises ResultFolderError."""
    write_whole(folder / "comparison.csv", csv_text(results))
    picture = save_figure(comparison, results, folder)
    return write_whole(folder / "comparison.html", page(comparison, results, picture, command))


def page(comparison: Comparison, results: Results, picture: bytes, command: str) -> str:
    """The report as one self-contained page, str."""
    blocks = [(task.title, [(law, verdict(row), arrived(row), cells(row)) for name, law, row, _ in results
                            if name == task.name]) for task in comparison.tasks]
    counts = [(law, sum(arrived(row) for _, name, row, _ in results if name == law)) for law in comparison.scenarios]
    return render("comparison.html.j2", name=comparison.name, description=comparison.description, blocks=blocks,
                  headings=[title for _, title, _ in TABLE], arrived=counts, tasks=len(comparison.tasks),
                  picture=base64.b64encode(picture).decode("ascii"), command=command, versions=installed_versions())


def line_of(index: int) -> Dict[str, Any]:
    """Colour and dash of the law that stands at this place of the file."""
    return {"color": COLOURS[index % len(COLOURS)], "linestyle": STYLES[index // len(COLOURS) % len(STYLES)]}


def make_figure(comparison: Comparison, results: Results, width_in: float = 12.0, row_in: float = 2.05) -> Figure:
    """Figure of `run_comparison`'s results.

    Args: width_in: of the figure.  row_in: height of the row of a task. In a small figure lines and letters look large.
    """
    laws, tasks = list(comparison.scenarios), comparison.tasks
    tracks = {(task, law): track for task, law, _, track in results}
    camera = next(iter(comparison.scenarios.values())).sim["cameras"][0]
    with matplotlib.rc_context(dict(STYLE, **{"lines.linewidth": 1.2})):
        figure = Figure(figsize=(width_in, 0.6 + row_in * len(tasks)), constrained_layout=True)
        panels = figure.subplots(len(tasks), len(PANELS), squeeze=False)
        for row, task in zip(panels, tasks):
            for i, law in enumerate(laws):
                track = tracks[task.name, law]
                if track is not None:
                    _draw(row, track, line_of(i))
            _dress(row, task, camera, last=task is tasks[-1])
        for panel, title in zip(panels[0], PANELS):
            panel.set_title(title, loc="left")
        # The legend has a line for every law, also for one whose runs were all refused.
        handles = [matplotlib.lines.Line2D([], [], label=law, **line_of(i)) for i, law in enumerate(laws)]
        columns = min(len(laws), max(1, int(LEGEND_COLUMNS * width_in / 12.0)))
        legend_in = LEGEND_IN + LEGEND_ROW_IN * -(-len(laws) // columns)
        figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, 1.0 - legend_in / figure.get_figheight()))
        figure.legend(handles=handles, loc="upper center", ncol=columns)
    return figure


def part_of(comparison: Comparison, results: Results, laws: Sequence[str],
            tasks: Sequence[str]) -> Tuple[Comparison, Results]:
    """(comparison, results) of these laws on these tasks alone, for a figure that is read at a glance."""
    chosen = replace(comparison, scenarios={law: comparison.scenarios[law] for law in laws},
                     tasks=tuple(task for task in comparison.tasks if task.name in tasks))
    return chosen, [one for one in results if one[0] in tasks and one[1] in laws]


def save_figure(comparison: Comparison, results: Results, folder: Path) -> bytes:
    """Writes comparison.png and comparison.pdf. Returns the bytes of the PNG. Raises ResultFolderError."""
    return save_both(make_figure(comparison, results), folder / "comparison")


def _draw(row, track, line):
    distance, angle, retreat, image = row
    distance.plot(track.t_s, np.maximum(track.distance_mm, FLOOR_MM), **line)
    angle.plot(track.t_s, np.maximum(track.angle_deg, FLOOR_DEG), **line)
    retreat.plot(track.t_s, track.retreat_mm, **line)
    if track.u_px:
        image.plot(track.u_px, track.v_px, **line)
        image.plot(track.u_px[:1], track.v_px[:1], linestyle="", marker="o", markersize=4.5, markerfacecolor="none",
                   color=palette.GREY)


def _dress(row, task, camera, last):
    distance, angle, retreat, image = row
    distance.set_ylabel(task.title, fontweight="bold")
    distance.set_yscale("log")
    angle.set_yscale("log")
    retreat.axhline(0.0, color=palette.GREY, linewidth=0.7)
    image.set(xlim=(-0.5, camera["width"] - 0.5), ylim=(camera["height"] - 0.5, -0.5), aspect="equal")
    image.grid(False)
    for spine in image.spines.values():
        spine.set_visible(True)
    if last:
        for panel in (distance, angle, retreat):
            panel.set_xlabel("time since the servo started [s]")
