"""Cells of a map over distance and angle of the start, and what can be promised of them."""

import math
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from ....sweep.statistics import wilson
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
        return (f"{self.distance_m:.2g} m, {math.degrees(self.angle_rad):.0f}°: {self.runs} of {self.runs}, "
                f"> {100.0 * self.least:.0f} %")


def map_of(rows: List[Dict[str, Any]], cells: Optional[int] = None) -> Map:
    """`Map` of the rows of a case. cells: along an axis; None: so many that a cell has about RUNS_PER_CELL runs."""
    n = cells or int(np.clip(math.sqrt(len(rows) / RUNS_PER_CELL), 1, MOST_CELLS))
    edges_m, edges_rad = np.linspace(0.0, MOST_M, n + 1), np.linspace(0.0, MOST_RAD, n + 1)
    place = [np.array([row[key] for row in rows], dtype=float) / factor
             for key, factor in (("distance0_mm", 1e3), ("angle0_deg", 180.0 / math.pi))]
    which = [np.clip((n * at / most).astype(int), 0, n - 1) for at, most in zip(place, (MOST_M, MOST_RAD))]
    runs, won = np.zeros((n, n), dtype=int), np.zeros((n, n), dtype=int)
    np.add.at(runs, tuple(which), 1)
    np.add.at(won, tuple(which), [int(row["success"] == 1) for row in rows])
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
