"""The picture of the protocol `latency`: how many runs succeed at each pair of delays, and the border by theory."""

import math
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

#: Runs in a cell of the map, about, and the most cells along an axis.
RUNS_PER_CELL, MOST_CELLS = 12, 25


def cells(rows: List[Dict[str, Any]], axes: Tuple[str, str], most_s: float) -> Tuple[np.ndarray, np.ndarray]:
    """(rate, edges): success rate by [image delay, command delay], (n, n), NaN without a run; edges (n + 1,) [s]."""
    n = int(np.clip(math.sqrt(len(rows) / RUNS_PER_CELL), 2, MOST_CELLS))
    edges = np.linspace(0.0, most_s, n + 1)
    x, y = (np.array([row[axis] for row in rows], dtype=float) for axis in axes)
    runs, _, _ = np.histogram2d(x, y, bins=(edges, edges))
    won, _, _ = np.histogram2d(x, y, bins=(edges, edges), weights=[float(row["success"] == 1) for row in rows])
    return np.divide(won, runs, out=np.full_like(won, np.nan), where=runs > 0), edges


def border_s(gain_per_s: float, rate_hz: float) -> float:
    """Sum of both delays from which on a loop of this gain does not come to rest any more [s].

    A velocity of gain times an error that is T old is stable for gain T < pi / 2. A command holds for one period of the
    images, on average half of it after it began, which counts as delay too.
    """
    return 0.5 * math.pi / gain_per_s - 0.5 / rate_hz


def save_map(path: Path, rows: List[Dict[str, Any]], axes: Tuple[str, str], most_s: float, gain_per_s: float,
             rate_hz: float) -> Path:
    """Draw PATH.png and PATH.pdf. Returns the path of the first.

    Args: rows: of the runs.  axes: columns of the delays of image and command [s].  most_s: the longest one.
    """
    import matplotlib  # slow to import
    from matplotlib.figure import Figure

    from ...report.figure import STYLE
    rate, edges = cells(rows, axes, most_s)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(5.4, 4.4), constrained_layout=True)
        panel = figure.add_subplot()
        panel.grid(False)
        shown = panel.pcolormesh(1e3 * edges, 1e3 * edges, np.ma.masked_invalid(rate.T), cmap="RdYlBu", vmin=0.0,
                                 vmax=1.0, rasterized=True)
        figure.colorbar(shown, ax=panel, label=f"success rate, {len(rows)} runs")
        sum_ms = 1e3 * border_s(gain_per_s, rate_hz)
        panel.plot([0.0, sum_ms], [sum_ms, 0.0], color="black", linestyle="--", linewidth=1.2,
                   label=f"gain {gain_per_s:g}/s, delays together {sum_ms:.0f} ms: π/2")
        panel.set(xlim=(0.0, 1e3 * most_s), ylim=(0.0, 1e3 * most_s), xlabel="delay of images [ms]",
                  ylabel="delay of commands [ms]")
        panel.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
        picture = path.with_suffix(".png")
        figure.savefig(picture, dpi=150, metadata={"Software": None})
        figure.savefig(path.with_suffix(".pdf"), metadata={"CreationDate": None})
    return picture
