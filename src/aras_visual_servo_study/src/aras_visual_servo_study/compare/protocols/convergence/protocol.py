"""Protocol `map`: from which distances and angles each law arrives with each set of features."""

from aras_visual_servo import ParameterError, load_scenario
from ..base import Case, Protocol, register_protocol
from . import page
from .cells import certificate, map_of
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

    def cases(self, folder, count, board=None):
        if board is not None:
            raise ParameterError(f"--board: found {board}, allowed nothing: the pictures of this protocol are fixed")
        if not 1 <= count <= STARTS:
            raise ParameterError(f"starts: found {count}, allowed 1 to {STARTS}")
        starts = planned(load_scenario(SCENARIO), count)
        return [Case(row.name, row.scenario, starts, {"law": row.law, "features": row.set.label})
                for row in plan()[0]]

    def lines(self, case, rows):
        strict = sum(row["strict"] == 1 for row in rows)
        promised = certificate(map_of(rows)).words()
        return [({**case.columns, "all arrive within": promised, "strict": f"{strict} of {len(rows)}"}, rows)]

    def save_pictures(self, results, folder):
        return page.save(results, plan()[1], folder)
