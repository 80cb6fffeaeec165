"""Protocol `map`: from which distances and angles each law arrives with each set of features; `sets` says which."""

from pathlib import Path
from typing import Any, Dict, List, Tuple

from aras_visual_servo import load_scenario
from ..base import Case, Protocol, check_count, register_protocol
from . import entries, page
from .sets import SCENARIO, plan
from .starts import planned

STARTS = 250


@register_protocol("map")
class ConvergenceMap(Protocol):
    """Every law with every set of features that it works on, from the same starts, on the free camera.

    Starts are given by their distance from the goal and the angle of their rotation. The first N of them cover the
    plane of both about as evenly as N points can, so that fewer runs give the same maps, only coarser. A start from
    which nothing is recognised counts as a failure.
    """

    title = "Map of convergence: each law with each set of features, over distance and angle of the start"
    source = "this project"
    metric, published_starts = "success", STARTS

    def cases(self, folder: Path, count: int) -> List[Case]:
        return self.changed_cases(folder, count, {})

    def changed_cases(self, folder: Path, count: int, changes: Dict[str, Any]) -> List[Case]:
        check_count(count, STARTS)
        starts = planned(load_scenario(SCENARIO), count)
        return [Case(row.name, row.scenario, starts, {"law": row.law, "features": row.set.label})
                for row in plan(changes)[0]]

    def lines(self, case: Case, rows: List[Dict[str, Any]]) -> List[Tuple[Dict[str, Any], List[Dict[str, Any]]]]:
        strict = sum(row["strict"] == 1 for row in rows)
        promised = entries.certificate(entries.map_of(rows)).words()
        return [({**case.columns, "all arrive within": promised, "strict": f"{strict} of {len(rows)}"}, rows)]

    def save_pictures(self, results: List[Tuple[Case, List[Dict[str, Any]]]], folder: Path) -> List[Path]:
        return page.save(results, plan()[1], folder)
