"""Protocol `latency`: success over the delays of images and of commands, from 10 000 runs with delays of their own."""

import math
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

from aras_visual_servo import Scenario, load_scenario
from ...sweep.plan import Start, SweepSettings, make_starts
from .base import Case, Protocol, check_count, halton, register_protocol, success_map

STARTS, MOST_S, SEED = 10_000, 0.5, 0
_PATIENT = {"servo.input_timeout_s": 1.0}  # images may be so old
#: Case -> its scenario, and what it changes there: four moments on the arm, six points on a camera without inertia.
CASES: Dict[str, Any] = {
    "moments_arm": ("experiment_1", _PATIENT),
    "points_free": ("free_camera", {
        **_PATIENT,
        "vision.points": "corners", "vision.point_count": 6, "servo.features": ["points6"],
        "servo.gains_per_s": {"points6": 3.0}, "servo.thresholds": {"points6": 0.0005}})}
#: Names of the two delays among the perturbations of a sweep.
IMAGE, COMMAND = "latency_s", "sim.command_delay_s"
#: Width of the lines of the table [s].
BAND_S = 0.2
#: Runs in a cell of the map, about, and the most cells along an axis.
RUNS_PER_CELL, MOST_CELLS = 12, 25


@register_protocol("latency")
class Latency(Protocol):
    """An image comes up to 0.5 s after it was taken, and a command acts up to 0.5 s after it was given.

    Starts are drawn at random as the scenario's section `sweep` has them. The pairs of delays are a Halton sequence:
    the first N of them cover the square about as evenly as N points can, so that fewer runs give the same map, only
    coarser.
    """

    title = "Latency: success over the delays of images and of commands"
    source = "this project"
    metric, published_starts = "success", STARTS

    def cases(self, folder: Path, count: int) -> List[Case]:
        return [Case(name, scenario, planned(scenario, count), {"case": name})
                for name, scenario in ((name, load_scenario(file, changes)) for name, (file, changes) in CASES.items())]

    def lines(self, case: Case, rows: List[Dict[str, Any]]) -> List[Tuple[Dict[str, str], List[Dict[str, Any]]]]:
        """By the sum of both delays."""
        total = [row[f"p_{IMAGE}"] + row[f"p_{COMMAND}"] for row in rows]
        bands = [(low, low + BAND_S) for low in np.arange(0.0, 2.0 * MOST_S - 1e-9, BAND_S)]
        return [({**case.columns, "sum of delays": f"{low:.1f} to {high:.1f} s"},
                 [row for row, delay_s in zip(rows, total) if low <= delay_s < high]) for low, high in bands]

    def save_pictures(self, results: List[Tuple[Case, List[Dict[str, Any]]]], folder: Path) -> List[Path]:
        axes = f"p_{IMAGE}", f"p_{COMMAND}"
        # The loop of the feature with the largest gain is the first to swing.
        return [save_map(folder / f"{case.name}_map", rows, axes, max(case.scenario.servo["gains_per_s"].values()),
                         case.scenario.sim["cameras"][0]["rate_hz"]) for case, rows in results]


def delays(count: int) -> np.ndarray:
    """(count, 2) delays of image and command [s]: a Halton sequence."""
    return MOST_S * halton(count)


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The first `count` runs, list of `Start`; a start that cannot be tried gives its place to the next one."""
    check_count(count, STARTS)
    kinematics = scenario.kinematics(calibrated=False)
    drawn, found = 16 + count + count // 2, []
    while len(found) < count:
        settings = SweepSettings.from_scenario(scenario, kinematics, starts=drawn, method="random", seed=SEED)
        found = [start for start in make_starts(settings, scenario, kinematics) if not start.refusal]
        drawn *= 2
    return [Start(i + 1, start.joints, start.offset, {IMAGE: float(image_s), COMMAND: float(command_s)})
            for i, (start, (image_s, command_s)) in enumerate(zip(found, delays(count)))]


def cells(rows: List[Dict[str, Any]], axes: Tuple[str, str], most_s: float) -> Tuple[np.ndarray, np.ndarray]:
    """(rate, edges): success rate by [image delay, command delay], (n, n), NaN without a run; edges (n + 1,) [s]."""
    n = int(np.clip(math.sqrt(len(rows) / RUNS_PER_CELL), 2, MOST_CELLS))
    edges = np.linspace(0.0, most_s, n + 1)
    runs, won = success_map(rows, axes, (edges, edges))
    return np.divide(won, runs, out=np.full(runs.shape, np.nan), where=runs > 0), edges


def border_s(gain_per_s: float, rate_hz: float) -> float:
    """Sum of both delays from which on a loop of this gain does not come to rest any more [s].

    A velocity of gain times an error that is T old is stable for gain T < pi / 2. A command holds for one period of the
    images, on average half of it after it began, which counts as delay too.
    """
    return 0.5 * math.pi / gain_per_s - 0.5 / rate_hz


def save_map(path: Path, rows: List[Dict[str, Any]], axes: Tuple[str, str], gain_per_s: float, rate_hz: float) -> Path:
    """Draws PATH.png and PATH.pdf. Returns the path of the first. axes: columns of the delays of image and command."""
    import matplotlib  # slow to import
    from matplotlib.figure import Figure

    from ...report.figure import STYLE, save_both
    rate, edges = cells(rows, axes, MOST_S)
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
        panel.set(xlim=(0.0, 1e3 * MOST_S), ylim=(0.0, 1e3 * MOST_S), xlabel="delay of images [ms]",
                  ylabel="delay of commands [ms]")
        panel.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.2)
    save_both(figure, path, 150)
    return path.with_suffix(".png")
