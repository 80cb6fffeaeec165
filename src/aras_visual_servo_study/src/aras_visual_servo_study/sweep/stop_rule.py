"""Does the servo say CONVERGED where the camera has arrived, and only there? Many different runs, judged by true poses.

Scenarios, starts, gains, noise, latency and friction come from one Latin hypercube, so that they meet in all
combinations. A run is inside when the true pose of the camera was within the judge of its scenario for `hold_s` at the
end of the servo. The servo is wrong in two ways: CONVERGED and not inside, or inside and not CONVERGED.
"""

from collections import Counter
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any, Dict, List

import numpy as np

from aras_visual_servo import Kinematics, Scenario, Status, load_scenario, true_error
from .perturb import perturbed
from .plan import Planner, Start, SweepSettings, sample
from .run import SweepRunner

#: Half of the runs are of the first group, half of the second.
EXPERIMENTS = ("experiment_1", "experiment_2")
SIX_AXIS = ("six_axis_flange", "six_dof_broyden", "six_dof_canonical", "six_dof_domain", "six_dof_hybrid",
            "six_dof_pbvs", "six_dof_photometric", "six_dof_points", "six_dof_rectangle", "six_dof_sliding",
            "six_dof_tilted")
#: What varies: name -> (low, high, on a logarithmic scale).
VARIED = {"gain_factor": (0.5, 4.0, True), "tilt_gain_per_s": (0.5, 12.0, True), "noise_stddev": (0.0, 5.0, False),
          "latency_s": (0.0, 0.08, False), "friction_scale": (1.0, 5.0, False)}
#: Each joint starts up to this many times as far from the goal as in the scenario, up to LEAST_WAY at least [m, rad].
WAY, LEAST_WAY = 1.25, 0.05
#: A start that cannot be run is brought nearer to the goal by this factor until it can.
NEARER = 0.7
#: The whole target is this far inside the image at the start [px].
BORDER_PX = 3.0
#: Dimensions of a start (joints of the longest arm) and of a goal (those of `sweep.goal`).
JOINTS, GOAL = 7, 2


@dataclass(frozen=True)
class Case:
    """One run: the scenario, what varies, and where the arm starts."""

    id: int
    scenario: str
    gain_factor: float
    tilt_gain_per_s: float
    noise_stddev: float
    latency_s: float
    friction_scale: float
    joints: dict
    goal: dict


def draw(count: int, seed: int) -> List[Case]:
    """`count` cases from a Latin hypercube with this seed; equal arguments give equal cases."""
    places = sample("latin_hypercube", count, 1 + len(VARIED) + JOINTS + GOAL, seed)
    return [_case(number + 1, place.tolist()) for number, place in enumerate(places)]


def _case(number, place):
    group, u = (EXPERIMENTS, 2.0 * place[0]) if place[0] < 0.5 else (SIX_AXIS, 2.0 * place[0] - 1.0)
    name = group[int(u * len(group))]
    values = {}
    for (key, (low, high, logarithmic)), t in zip(VARIED.items(), place[1:]):
        values[key] = low * (high / low) ** t if logarithmic else low + t * (high - low)
    rest = place[1 + len(VARIED):]
    joints, goal = _start_and_goal(name, rest[:JOINTS], rest[JOINTS:])
    return Case(number, name, joints=joints, goal=goal, **values)


@lru_cache(maxsize=None)
def _known(name):
    """(kinematics, `Planner`, goal, start) of a scenario."""
    scenario = load_scenario(name)
    kinematics = Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    planner = Planner(SweepSettings.from_scenario(scenario, kinematics), scenario, kinematics)
    return kinematics, planner, scenario.goal_posture(kinematics), scenario.start_posture(kinematics)


def _start_and_goal(name, place, goal_place):
    """(joints, goal) of a `Start`."""
    kinematics, planner, q_goal, q_start = _known(name)
    reach = np.maximum(WAY * np.abs(q_start - q_goal), LEAST_WAY)
    way = (2.0 * np.array(place[:len(q_goal)]) - 1.0) * reach
    goal = {}
    if planner.settings.goal:
        goal, q_goal = _tilted(planner, kinematics, goal_place)
    outline = planner.feasibility.outline
    while planner.feasibility.refusal(q_goal, q_goal + way) or (
            outline is not None and outline.border_px(kinematics.pose(q_goal + way)) < BORDER_PX):
        way = NEARER * way
    return kinematics.by_name(q_goal + way), goal


def _tilted(planner, kinematics, place):
    """(goal, joint positions there): a tilt that the arm can reach with the target in view."""
    wanted = {name: low + t * (high - low) for (name, (low, high)), t in zip(planner.settings.goal.items(), place)}
    while True:
        goal, refusal = planner.tilted(wanted)
        if not refusal:
            q = kinematics.vector(goal["joints"])
            if not planner.feasibility.refusal(q, q):
                return goal, q
        wanted["tilt_rad"] *= NEARER


def scenario_of(case: Case) -> Scenario:
    """The `Scenario` of a case."""
    scenario = load_scenario(case.scenario)
    gains = {name: case.gain_factor * gain for name, gain in scenario.servo["gains_per_s"].items()}
    cameras = [dict(camera, noise_stddev=case.noise_stddev, latency_s=case.latency_s)
               for camera in scenario.sim["cameras"]]
    return perturbed(scenario, {
        "friction_scale": case.friction_scale, "sim.cameras": cameras, "sim.seed": case.id,
        "servo.gains_per_s": gains, "servo.tilt_gain_per_s": case.tilt_gain_per_s})


def run_case(case: Case) -> Dict[str, Any]:
    """Run a case. Returns a dict: the case, how it ended, the true error at the end, `converged` and `inside`."""
    scenario = scenario_of(case)
    row, record = SweepRunner(scenario).run(Start(case.id, dict(case.joints), goal=case.goal))
    found = dict(asdict(case), converged=False, inside=False, status="", reason=row["detail"], duration_s=None)
    if record is None:
        return dict(found, status=row["outcome"])
    rows = record.servo_rows
    hold_ns = round(1e9 * scenario.servo.get("hold_s", 0.2))
    last = rows[record.stamp_ns[rows] >= record.stamp_ns[rows[-1]] - hold_ns]
    errors = [true_error(record, at) for at in last]
    judge = scenario.experiment["judge"]
    found["inside"] = all(abs(error[key]) <= limit for error in errors for key, limit in judge.items())
    found["worst"] = max(abs(error[key]) / limit for error in errors for key, limit in judge.items())
    found.update(errors[-1], status=Status(record.status[rows[-1]]).name, duration_s=row["duration_s"],
                 run_hash=row["run_hash"], e=record.e[rows[-1]].tolist())
    found["converged"] = found["status"] == Status.CONVERGED.name
    return found


def tally(rows: List[Dict[str, Any]]) -> Dict[str, Counter]:
    """Counts by scenario and of all, dict of name -> Counter: runs, inside, converged, false_converged, missed.

    Cases that could not be run (the target was not in view at the start after all) are left out.
    """
    counts = {}
    for row in rows:
        if row["status"] == "infeasible":
            continue
        for name in (row["scenario"], "all"):
            counts.setdefault(name, Counter()).update(
                runs=1, inside=row["inside"], converged=row["converged"],
                false_converged=row["converged"] and not row["inside"], missed=row["inside"] and not row["converged"])
    return counts
