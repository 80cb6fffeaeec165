"""Maps of the protocol `map`: success by distance and angle of the start, and what can be promised of the cells."""

import math
from typing import Any, Dict, Iterator, List, NamedTuple, Sequence, Tuple

import numpy as np

from ....sweep.statistics import wilson
from ..base import Case, success_map
from ..runner import digest
from .starts import MOST_M, MOST_RAD

#: Runs in a cell, about, and the most cells along an axis.
RUNS_PER_CELL, MOST_CELLS = 6, 8


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
        return (f"{1e3 * self.distance_m:.0f} mm, {math.degrees(self.angle_rad):.0f} deg: {self.runs} of {self.runs}, "
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
                         f"{math.degrees(found.edges_rad[j]):.0f} to {math.degrees(found.edges_rad[j + 1]):.0f} deg: "
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


def of_laws_and_sets(made: Sequence[Entry]) -> Tuple[List[str], List[str], Dict[Tuple[str, str], Entry]]:
    """(laws, labels of the sets, {(law, label): entry}), each in the order in which they come."""
    return (list(dict.fromkeys(one.law for one in made)), list(dict.fromkeys(one.features for one in made)),
            {(one.law, one.features): one for one in made})


def _colour(rate):
    """Of a rate in [0, 1], "#rrggbb"; that of the picture."""
    import matplotlib
    from matplotlib.colors import to_hex
    return to_hex(matplotlib.colormaps["RdYlBu"](rate))


def _percent(rate):
    return f"{100.0 * rate:.0f}"
