#!/usr/bin/env python3
"""The laws `qp` and `mpc` beside `ibvs`, from starts where that leaves the view or meets a stop: a table for both arms.

python3 constraints.py [--starts 100] [--laws qp] [--seed 0] [--workers 2] [--write PAGE], with the workspace sourced.

Starts are drawn in a ball about the goal until N of them have been found from which `ibvs` loses the target, cuts it at
the border of the image or brings a joint to the end of its way. From each of them the other laws run. At every look
their constraints are held to what was commanded. A constraint that is violated counts as a violation where HiGHS, a
linear programming solver that shares nothing with ours, finds joint velocities that keep all of them.
"""
import argparse
import os
import pathlib
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from aras_visual_servo_controller.ground.types import Status
from aras_visual_servo_controller.scenario.scenario import load_scenario
from aras_visual_servo_controller.arm.robot import kinematics_of
from aras_visual_servo_controller.sweep.plan import SweepSettings, make_starts
from aras_visual_servo_controller.sweep.run import Bench
from aras_visual_servo_controller.sweep.statistics import wilson

POINTS = {"vision.points": "corners", "vision.point_count": 4, "vision.order": 3,
          "servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0},
          "servo.thresholds": {"points4": 0.0005}, "servo.interaction": "current"}
#: Half the view (320 x 240 px, f = 188 px), the margin, and how far the blob reaches: 2.44 standard deviations.
VIEW = {"half_width": 0.849, "half_height": 0.636, "margin": 0.05, "extent": 2.5}
JOINTS = ("gantry", "J1", "J2", "J3", "J4", "J5", "J6")
ACCELERATION = {"gantry": 4.0, **dict.fromkeys(JOINTS[1:], 20.0)}
#: Arm: base scenario, what is changed in it, and the wall, a table 0.25 m below the goal.
ARMS = {
    "ARAS arm": ("field_of_view", {"servo.law": "ibvs", "servo.interaction": "current", "servo.on_lost": "hold",
                                   "servo.inverse": {"at_limits": "scale"}, "servo.time_limit_s": 12.0},
                 {"space": "view", "view": {"u": [-0.95, 0.95], "v": [-0.95, 0.95], "depth_m": [0.3, 0.6],
                                            "rz_rad": [-2.9671, 2.9671]}}, 0.12),
    "six-axis arm": ("six_dof_domain", {**POINTS, "servo.law": "ibvs", "servo.on_lost": "hold",
                                        "servo.inverse": {"at_limits": "scale"}, "servo.time_limit_s": 12.0},
                     {"space": "view", "view": {"u": [-0.95, 0.95], "v": [-0.95, 0.95], "depth_m": [0.3, 0.7],
                                                "rz_rad": [-1.5, 1.5]}}, 0.25),
}
#: Candidates that are drawn for each start that is wanted.
DRAWN = 60
#: Rounding of a row of the constraints, relative to its largest term.
ROUNDING = 1e-7


def scenario_of(arm, law):
    """The scenario of an arm with a law."""
    name, changes, sweep, below_m = ARMS[arm]
    changes = dict(changes, **{"sweep": dict(sweep, starts=1)})
    base = load_scenario(name, changes)
    joints = [joint for joint in JOINTS if joint in base.experiment["goal"]["joints"]]
    changes["servo.limits.joint_acceleration"] = {joint: ACCELERATION[joint] for joint in joints}
    if law != "ibvs":
        kinematics = kinematics_of(base.urdf_xml(), base.robot, calibrated=False)
        height = float(kinematics.pose(base.goal_posture(kinematics))[2, 3])
        changes["servo.law"] = law
        changes[f"servo.{law}"] = dict(VIEW, walls={"table": {"normal": [0.0, 0.0, 1.0], "offset_m": height - below_m}})
    return load_scenario(name, changes)


class Witness:
    """Stands between a law and its solver, and asks HiGHS what the solver says."""

    def __init__(self, solve):
        self._solve, self.looks, self.wrong, self.infeasible, self.violations = solve, 0, 0, 0, 0

    def __call__(self, H, g, A, b):
        answer = self._solve(H, g, A, b)
        self.looks += 1
        scale = 1.0 + np.abs(b[np.isfinite(b)]).max(initial=0.0)
        kept = bool((A @ answer[0] - b).min(initial=0.0) > -ROUNDING * scale)
        if answer[3] and kept:
            return answer
        from scipy.optimize import linprog
        n, bound = len(g), np.isfinite(b)
        possible = linprog(np.zeros(n), A_ub=-A[bound], b_ub=-b[bound], bounds=[(None, None)] * n).status == 0
        self.infeasible += not possible
        self.violations += possible
        return answer


def run(job):
    """One start with one law: (id, dict of what happened)."""
    arm, law, start = job
    from aras_visual_servo_controller import _kinematics
    original = getattr(_kinematics.solve_program, "original", _kinematics.solve_program)
    witness = Witness(original)
    witness.original = original
    _kinematics.solve_program = witness
    if (arm, law) not in _benches:
        _benches[arm, law] = Bench(scenario_of(arm, law))
    row, record = _benches[arm, law].run(start)
    if record is None:
        return start.id, None
    rows, kinematics = record.servo_rows, _kinematics_of(arm)
    q, status = record.q[rows], record.status[rows]
    lower, upper = kinematics.lower, kinematics.upper
    lost = bool((status == Status.TARGET_LOST).any())
    return start.id, {
        "success": bool(row["success"]), "reason": row["reason"], "detail": row["detail"],
        "view": lost or (row["border_px"] is not None and row["border_px"] < 0.0),
        "stop": bool((status == Status.JOINT_LIMIT).any()),
        "beyond": bool((q < lower - 1e-9).any() or (q > upper + 1e-9).any()),
        "border_px": row["border_px"], "looks": witness.looks, "infeasible": witness.infeasible,
        "violations": witness.violations,
        "texts": sorted({text.split(" by ")[0] for text in record.status_text[rows] if "infeasible" in text})[:3]}


_benches, _arms = {}, {}


def _kinematics_of(arm):
    if arm not in _arms:
        base = scenario_of(arm, "ibvs")
        _arms[arm] = kinematics_of(base.urdf_xml(), base.robot, calibrated=False)
    return _arms[arm]


def starts_of(arm, count, seed):
    """Candidates that can be run, in the order in which they are drawn."""
    scenario = scenario_of(arm, "ibvs")
    kinematics = _kinematics_of(arm)
    settings = SweepSettings.from_scenario(scenario, kinematics, starts=DRAWN * count, seed=seed, method="random")
    return [start for start in make_starts(settings, scenario, kinematics) if not start.refusal]


def table(arm, laws, count, seed, pool):
    """Lines of the table of one arm, and the results by law."""
    hard, alone = [], []
    for start, (_, found) in _run(pool, [(arm, "ibvs", start) for start in starts_of(arm, count, seed)], count,
                                  lambda found: found is not None and (found["view"] or found["stop"])):
        hard.append(start)
        alone.append(found)
    results = {"ibvs": alone}
    for law in laws:
        results[law] = [found for _, (_, found) in _run(pool, [(arm, law, start) for start in hard])]
    lines = []
    for law, found in results.items():
        tried = [one for one in found if one is not None]
        won = sum(one["success"] for one in tried)
        low, high = wilson(won, len(tried))
        looks = sum(one["looks"] for one in tried)
        program = f"{looks} | {sum(one['infeasible'] for one in tried)} | {sum(one['violations'] for one in tried)}"
        lines.append(f"| {arm} | `{law}` | {len(tried)} | {sum(one['view'] for one in tried)} | "
                     f"{sum(one['beyond'] for one in tried)} | {won} ({100 * low:.0f} to {100 * high:.0f} %) | "
                     f"{program if looks else '- | - | -'} |")
    return lines, results


def _run(pool, jobs, count=None, wanted=lambda found: True):
    """(start, (id, result)) of the jobs, in their order, until `count` of them are `wanted`."""
    found, step = [], 16
    for first in range(0, len(jobs), step):
        part = jobs[first:first + step]
        for job, result in zip(part, pool.map(run, part) if pool else map(run, part)):
            if wanted(result[1]):
                found.append((job[2], result))
        print(f"{jobs[0][0]}, {jobs[0][1]}: {first + len(part)} runs, {len(found)} found", file=sys.stderr)
        if count is not None and len(found) >= count:
            return found[:count]
    return found


HEAD = ("| arm | law | starts | left the view | beyond a joint's end | arrived (95 %) | looks | infeasible | "
        "violations |\n"
        "|---|---|---|---|---|---|---|---|---|")
BEGIN, END = "<!-- table: constraints -->", "<!-- end table: constraints -->"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=100, help="of each arm, from which ibvs fails (default: 100)")
    parser.add_argument("--laws", default="qp", help="comma-separated, beside ibvs (default: qp)")
    parser.add_argument("--arms", default=",".join(ARMS), help="comma-separated (default: both)")
    parser.add_argument("--seed", type=int, default=0, help="of the starts")
    parser.add_argument("--workers", type=int, default=2, help="processes; 0: this one")
    parser.add_argument("--verbose", action="store_true", help="also list how the runs ended")
    parser.add_argument("--write", metavar="PAGE", type=pathlib.Path, help="put the table into this page")
    arguments = parser.parse_args()
    lines, laws = [], [law for law in arguments.laws.split(",") if law]
    pool = ProcessPoolExecutor(arguments.workers, get_context("spawn")) if arguments.workers else None
    for arm in arguments.arms.split(","):
        part, results = table(arm, laws, arguments.starts, arguments.seed, pool)
        lines += part
        if arguments.verbose:
            for law, found in results.items():
                for i, one in enumerate(found):
                    print(arm, law, i, one)
    text = "\n".join([HEAD, *lines])
    print(text)
    if arguments.write:
        page = arguments.write.read_text()
        before, begin, rest = page.partition(BEGIN + "\n")
        _, end, after = rest.partition(END)
        if not (begin and end):
            raise SystemExit(f"constraints: allowed a page with '{BEGIN}' and '{END}'")
        arguments.write.write_text(f"{before}{begin}{text}\n{end}{after}")


if __name__ == "__main__":
    main()
