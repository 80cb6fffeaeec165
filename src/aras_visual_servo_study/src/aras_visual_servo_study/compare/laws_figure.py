"""Figure of a comparison of laws with a row per task and a line per law. The same runs give the same picture."""

import io
from dataclasses import replace
from pathlib import Path
from typing import Any, Dict, Sequence, Tuple

import matplotlib.lines
import numpy as np
from matplotlib.figure import Figure

from aras_visual_servo import palette
from ..report.figure import STYLE
from .laws import Comparison, Results

#: Colours of laws and joints. The ninth law has the first colour again, with the next dash of STYLES.
COLOURS = (palette.BLUE, palette.VERMILION, palette.GREEN, palette.PURPLE, "#E69F00", "#56B4E9", "#000000", "#997700")
STYLES = ("-", (0, (4, 1.5)), (0, (1, 1.2)))
#: Smaller values are drawn at this height of the logarithmic axes [mm, deg].
FLOOR_MM, FLOOR_DEG = 0.01, 0.001
PANELS = ("distance from the goal [mm]", "angle left [deg]", "retreat along the axis [mm]", "target in the image [px]")


#: Laws in one row of the legend of a figure 12 inches wide; height of such a row, and the room around all of them,
#: above the panels [inch].
LEGEND_COLUMNS, LEGEND_ROW_IN, LEGEND_IN = 8, 0.2, 0.15


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
    """Write comparison.png and comparison.pdf. Returns the bytes of the PNG. Raises OSError."""
    figure, stream = make_figure(comparison, results), io.BytesIO()
    with matplotlib.rc_context(STYLE):
        figure.savefig(stream, format="png", dpi=110, metadata={"Software": None})
        figure.savefig(folder / "comparison.pdf", metadata={"CreationDate": None})
    (folder / "comparison.png").write_bytes(stream.getvalue())
    return stream.getvalue()


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
