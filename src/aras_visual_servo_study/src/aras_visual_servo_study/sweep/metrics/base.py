"""Metrics by name: whether a run has succeeded, as this project or a publication has it.

    @register_metric("near", label="success, near", threshold="below 5 mm", source="this project")
    def near(outcome):
        return outcome.error_mm < 5.0

Every sweep computes all of them: `near` is a column of its runs, and `near`, `near_low`, `near_high` are numbers of
its statistics.
"""

from typing import Callable, Dict, List, NamedTuple, Optional

from aras_visual_servo import Registry


class Outcome(NamedTuple):
    """How a run began and ended, by the true camera pose: distances and angles from the goal.

    Attributes:
        error_mm, angle_deg: at the end.  distance0_mm, angle0_deg: at the start.
        goal_distance_mm: of the goal camera from the origin of the scene, the target's frame; None without a target.
    """

    error_mm: float
    angle_deg: float
    distance0_mm: float
    angle0_deg: float
    goal_distance_mm: Optional[float] = None


class Metric(NamedTuple):
    """One way to say that a run has succeeded.

    Attributes:
        name: column of a run.  label: what tables call it.  threshold: the condition in words.  source: whose it is.
        holds: (Outcome) -> bool, or None where it says nothing of such a run.
    """

    name: str
    label: str
    threshold: str
    source: str
    holds: Callable[[Outcome], Optional[bool]]


METRICS: "Registry[Metric]" = Registry("metric", __package__)
Holds = Callable[[Outcome], Optional[bool]]


def register_metric(name: str, label: str, threshold: str, source: str) -> Callable[[Holds], Holds]:
    """Returns a decorator of a function (Outcome) -> bool or None that makes it known as a metric."""

    def add(holds: Holds) -> Holds:
        METRICS[name] = Metric(name, label, threshold, source, holds)
        return holds

    return add


def known_metrics() -> List[Metric]:
    """Returns the registered metrics, this project's own first, then by name."""
    return sorted(METRICS.values(), key=lambda one: (one.name not in ("success", "strict"), one.name != "success",
                                                     one.name))


def judge_by(outcome: Optional[Outcome]) -> Dict[str, Optional[int]]:
    """Returns {name: 1, 0 or None} of all metrics. A run that did not end has `outcome` None and fails them all."""
    judged = {one.name: 0 if outcome is None else one.holds(outcome) for one in known_metrics()}
    return {name: None if holds is None else int(holds) for name, holds in judged.items()}
