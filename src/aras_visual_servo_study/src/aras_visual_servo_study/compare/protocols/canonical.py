"""Protocol `canonical`: the laws on the tasks of Gans, Hutchinson and Corke, on the free camera and on the arm."""

from ..laws import load_comparison, starts_of
from .base import Case, Protocol, register_protocol, spread

ROBOTS = {"free camera": "free_camera", "six-axis arm": None}
TASKS = 7


@register_protocol("canonical")
class Canonical(Protocol):
    """Each law of the comparison `canonical` on its seven tasks. `compare_laws canonical` draws the figure of them."""

    title = "The canonical tasks: turns, retreat, feature plane, general motion"
    source = ("N. Gans, S. Hutchinson, P. Corke, \"Performance tests for visual servo control systems, with "
              "application to partitioned approaches to visual servo control\", IJRR 22(10-11), 2003")
    metric, published_starts = "strict", TASKS

    def cases(self, folder, count):
        cases = []
        for robot, scenario in ROBOTS.items():
            comparison = load_comparison("canonical", scenario=scenario)
            tasks = [comparison.tasks[index] for index in spread(count, TASKS)]
            for law, changed in comparison.scenarios.items():
                cases.append(Case(f"{law}_{robot.replace(' ', '_').replace('-', '_')}", changed,
                                  starts_of(changed, tasks), {"law": law, "robot": robot}))
        return cases
