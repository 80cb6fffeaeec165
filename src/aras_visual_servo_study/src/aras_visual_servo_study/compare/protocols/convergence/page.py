"""The page of the protocol `map`: every map side by side, sets of features down and laws across, and what can be
promised of its cells."""

import base64
import math
from pathlib import Path
from typing import Any, Dict, Iterator, List, NamedTuple, Tuple

import numpy as np

from ....report.template import render
from ....report.versions import installed_versions
from ....sweep.statistics import wilson
from ..base import Case, success_map
from ..runner import digest, markdown_table
from .starts import MOST_M, MOST_RAD

#: Runs in a cell, about, and the most cells along an axis.
RUNS_PER_CELL, MOST_CELLS = 6, 8
PAGE, PICTURE, TABLE = "map.html", "map.png", "map.md"


class Map(NamedTuple):
    """Runs and successes by [distance, angle], (n, n) whole numbers, and the edges (n + 1,) [m], [rad]."""

    runs: np.ndarray
    won: np.ndarray
    edges_m: np.ndarray
    edges_rad: np.ndarray

    def interval(self, i: int, j: int) -> Tuple[float, float]:
        """Wilson's 95 % interval of the rate in a cell, (low, high)."""
        return wilson(int(self.won[i, j]), int(self.runs[i, j]))


class Certificate(NamedTuple):
    """A box of starts about the goal from which every run arrived.

    Attributes: distance_m, angle_rad: its ends; 0 where there is none.  runs: in it.  least: lower bound of the rate.
    """

    distance_m: float
    angle_rad: float
    runs: int
    least: float

    def words(self) -> str:
        """As text, "" where there is none."""
        if not self.runs:
            return ""
        return (f"{self.distance_m:.2g} m, {math.degrees(self.angle_rad):.0f}°: {self.runs} of {self.runs}, "
                f"> {100.0 * self.least:.0f} %")


def map_of(rows: List[Dict[str, Any]]) -> Map:
    """`Map` of the rows of a case, with about RUNS_PER_CELL runs in a cell."""
    n = int(np.clip(math.sqrt(len(rows) / RUNS_PER_CELL), 1, MOST_CELLS))
    edges_m, edges_rad = np.linspace(0.0, MOST_M, n + 1), np.linspace(0.0, MOST_RAD, n + 1)
    runs, won = success_map(rows, ("distance0_mm", "angle0_deg"), (1e3 * edges_m, np.degrees(edges_rad)))
    return Map(runs, won, edges_m, edges_rad)


def certificate(found: Map) -> Certificate:
    """`Certificate` of a `Map`: of the boxes in which every run succeeded that with most runs."""
    runs, won = (np.cumsum(np.cumsum(part, axis=0), axis=1) for part in (found.runs, found.won))
    whole = np.where(runs == won, runs, 0)
    i, j = np.unravel_index(int(np.argmax(whole)), whole.shape)
    count = int(whole[i, j])
    if not count:
        return Certificate(0.0, 0.0, 0, 0.0)
    return Certificate(float(found.edges_m[i + 1]), float(found.edges_rad[j + 1]), count, wilson(count, count)[0])


class Entry(NamedTuple):
    """One map of the page."""

    law: str
    features: str
    runs: int
    won: int
    strict: int
    map: Map
    promised: Certificate
    hash: str

    def rate(self) -> str:
        """Success in percent with Wilson's 95 % interval, as text."""
        low, high = wilson(self.won, self.runs)
        return f"{_percent(self.won / self.runs)} ({_percent(low)} to {_percent(high)})" if self.runs else ""

    def cells(self) -> Iterator[Tuple[int, int, str, str]]:
        """Of each cell (column, row from above, colour, words); a column is a range of distances."""
        n, found = len(self.map.runs), self.map
        for i in range(n):
            for j in range(n):
                low, high = found.interval(i, j)
                runs, won = int(found.runs[i, j]), int(found.won[i, j])
                words = (f"{1e3 * found.edges_m[i]:.0f} to {1e3 * found.edges_m[i + 1]:.0f} mm, "
                         f"{math.degrees(found.edges_rad[j]):.0f} to {math.degrees(found.edges_rad[j + 1]):.0f}°: "
                         f"{won} of {runs}, {_percent(low)} to {_percent(high)} %")
                yield i, n - 1 - j, _colour(won / runs) if runs else "#ffffff", words


def entries(results: List[Tuple[Case, List[Dict[str, Any]]]]) -> List[Entry]:
    """List of `Entry` of results, list of (Case, rows)."""
    made = []
    for case, rows in results:
        found = map_of(rows)
        made.append(Entry(case.columns["law"], case.columns["features"], len(rows),
                          sum(row["success"] == 1 for row in rows), sum(row["strict"] == 1 for row in rows), found,
                          certificate(found), digest(rows)[:16]))
    return made


def save(results: List[Tuple[Case, List[Dict[str, Any]]]], left_out: List[Tuple[str, str]], folder: Path) -> List[Path]:
    """Write PAGE, PICTURE and TABLE into the folder. Returns their paths.

    Args: results: list of (Case, rows).  left_out: list of (what is not mapped, why).
    """
    made = entries(results)
    picture, table, page = folder / PICTURE, folder / TABLE, folder / PAGE
    _save_picture(made, picture)
    table.write_text(as_markdown(made), encoding="utf-8")
    laws, sets, places = _layout(made)
    grid = [(label, [places.get((law, label)) for law in laws]) for label in sets]
    page.write_text(render("convergence.html.j2", grid=grid, laws=laws, entries=made, left_out=left_out,
                           picture=base64.b64encode(picture.read_bytes()).decode("ascii"),
                           versions=installed_versions()), encoding="utf-8")
    return [page, picture, table]


def as_markdown(made: List[Entry]) -> str:
    """The success rates in percent with their intervals as a table, sets of features down and laws across."""
    laws, sets, places = _layout(made)
    return markdown_table([["features", *(f"`{law}`" for law in laws)], *(
        [label, *(places[law, label].rate() if (law, label) in places else "" for law in laws)] for label in sets)])


def _layout(made):
    """(laws, labels of the sets, {(law, label): entry}), each in the order in which they come."""
    return (list(dict.fromkeys(one.law for one in made)), list(dict.fromkeys(one.features for one in made)),
            {(one.law, one.features): one for one in made})


def _save_picture(made, path):
    import matplotlib  # slow to import
    from matplotlib.figure import Figure

    from ....report.figure import STYLE
    laws, sets, places = _layout(made)
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(2.4 + 1.25 * len(laws), 0.9 + 1.25 * len(sets)), constrained_layout=True)
        panels = figure.subplots(len(sets), len(laws), squeeze=False)
        for label, row in zip(sets, panels):
            for law, panel in zip(laws, row):
                one = places.get((law, label))
                panel.grid(False)
                if one is None:
                    panel.set_axis_off()
                    continue
                rate = np.divide(one.map.won, one.map.runs, out=np.full(one.map.runs.shape, np.nan),
                                 where=one.map.runs > 0)
                panel.pcolormesh(1e3 * one.map.edges_m, np.degrees(one.map.edges_rad), np.ma.masked_invalid(rate.T),
                                 cmap="RdYlBu", vmin=0.0, vmax=1.0, rasterized=True)
                panel.set_title(one.rate(), fontsize=6.5, pad=2.0)
                panel.set_xticks([0, 1e3 * one.map.edges_m[-1]])
                panel.set_yticks([0, 90, 180])
                panel.tick_params(labelsize=6.0, length=2.0)
        for row, label in zip(panels, sets):
            row[0].text(-0.45, 0.5, label.replace(", ", ",\n").replace(": ", ":\n").replace(" of ", "\nof "),
                        transform=row[0].transAxes, ha="right", va="center", fontsize=7.5)
        for panel, law in zip(panels[0], laws):
            panel.text(0.5, 1.3, law, transform=panel.transAxes, ha="center", va="bottom", fontsize=8.5,
                       fontweight="bold")
        figure.supxlabel("distance of the start [mm]; above each map: success [%], 95 % interval", fontsize=8.0)
        figure.supylabel("rotation of the start [deg]", fontsize=8.0)
        figure.savefig(path, dpi=110, metadata={"Software": None})


def _colour(rate):
    """Of a rate in [0, 1], "#rrggbb"; that of the picture."""
    import matplotlib
    from matplotlib.colors import to_hex
    return to_hex(matplotlib.colormaps["RdYlBu"](rate))


def _percent(rate):
    return f"{100.0 * rate:.0f}"
