"""Protocol `latency`: success over the delays of images and of commands, from 10 000 runs with delays of their own."""

from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

from aras_visual_servo import ParameterError, Scenario, kinematics_of, load_scenario
from ...sweep.plan import Start, SweepSettings, make_starts
from .base import Case, Protocol, halton, register_protocol
from .delay_map import save_map

STARTS, MOST_S, SEED = 10_000, 0.5, 0
_PATIENT = {"servo.input_timeout_s": 1.0}  # images may be so old
#: Case -> its scenario, and what it changes there: four moments on the arm, six points on a camera without inertia.
CASES = {"moments_arm": ("experiment_1", _PATIENT),
         "points_free": ("free_camera", {
             **_PATIENT,
             "vision.points": "corners", "vision.point_count": 6, "servo.features": ["points6"],
             "servo.gains_per_s": {"points6": 3.0}, "servo.thresholds": {"points6": 0.0005}})}
#: Names of the two delays among the perturbations of a sweep.
IMAGE, COMMAND = "latency_s", "sim.command_delay_s"
#: Width of the lines of the table [s].
BAND_S = 0.2


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
        return [save_map(folder / f"{case.name}_map", rows, axes, MOST_S, _gain(case.scenario),
                         case.scenario.sim["cameras"][0]["rate_hz"]) for case, rows in results]


def delays(count: int) -> np.ndarray:
    """(count, 2) delays of image and command [s]: a Halton sequence."""
    return MOST_S * halton(count, (2, 3))


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The first `count` runs, list of `Start`; a start that cannot be tried gives its place to the next one."""
    if not 1 <= count <= STARTS:
        raise ParameterError(f"starts: found {count}, allowed 1 to {STARTS}")
    kinematics = kinematics_of(scenario.urdf_xml(), scenario.robot, calibrated=False)
    drawn, found = 16 + count + count // 2, []
    while len(found) < count:
        settings = SweepSettings.from_scenario(scenario, kinematics, starts=drawn, method="random", seed=SEED)
        found = [start for start in make_starts(settings, scenario, kinematics) if not start.refusal]
        drawn *= 2
    return [Start(i + 1, start.joints, start.offset, {IMAGE: float(image_s), COMMAND: float(command_s)})
            for i, (start, (image_s, command_s)) in enumerate(zip(found, delays(count)))]


def _gain(scenario):
    """The largest gain of the scenario [1/s]: the loop of its feature is the first to swing."""
    return max(scenario.servo["gains_per_s"].values())
