#!/usr/bin/env python3
"""The laws `qp` and `mpc` beside `ibvs`, from starts where that leaves the view or meets a stop: a table for both arms.

python3 constraints.py [--starts 100] [--laws qp] [--seed 0] [--workers 2] [--results FILE] [--minutes M]
[--write PAGE], with the workspace sourced.

Starts are drawn all over the view until N of them have been found from which `ibvs` loses the target, cuts it at
the border of the image or brings a joint to the end of its way. From each of them the other laws run. At every look
each answer of their solver is held to the constraints. One that is violated, or said to be impossible to keep, counts
as a violation where HiGHS, a linear programming solver that shares nothing with ours, finds joint velocities that keep
all of them. Infeasible are the looks at which a law itself says that it cannot keep them.

With --results every run is kept in FILE, and the same command goes on where it was interrupted. --minutes ends the
search after that time: the table then has the starts of each arm that all laws have done.
"""
import argparse
import hashlib
import json
import os
import pathlib
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from aras_visual_servo import Status, load_scenario
from aras_visual_servo_study.sweep.plan import SweepSettings, make_starts
from aras_visual_servo_study.sweep.run import SweepRunner
from aras_visual_servo_study.sweep.statistics import wilson

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "script" / "pictures"))
import marked

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
#: Candidates that are tried at a time, and that are drawn at first for each start that is wanted.
BLOCK, DRAWN = 32, 2
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
        kinematics = base.kinematics(calibrated=False)
        height = float(kinematics.pose(base.goal_posture(kinematics))[2, 3])
        changes["servo.law"] = law
        changes[f"servo.{law}"] = dict(VIEW, walls={"table": {"normal": [0.0, 0.0, 1.0], "offset_m": height - below_m}})
    return load_scenario(name, changes)


class Witness:
    """Stands between a law and its solver, and asks HiGHS what the solver says."""

    def __init__(self, solve):
        self._solve, self.violations = solve, 0

    def __call__(self, H, g, A, b):
        answer = self._solve(H, g, A, b)
        scale = 1.0 + np.abs(b[np.isfinite(b)]).max(initial=0.0)
        kept = bool((A @ answer[0] - b).min(initial=0.0) > -ROUNDING * scale)
        if answer[3] and kept:
            return answer
        from scipy.optimize import linprog
        n, bound = len(g), np.isfinite(b)
        possible = linprog(np.zeros(n), A_ub=-A[bound], b_ub=-b[bound], bounds=[(None, None)] * n).status == 0
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
        _benches[arm, law] = SweepRunner(scenario_of(arm, law))
    row, record = _benches[arm, law].run(start)
    if record is None:
        return start.id, None
    rows, kinematics = record.servo_rows, _kinematics_of(arm)
    q, status, texts = record.q[rows], record.status[rows], [record.status_text[row] for row in rows]
    lower, upper = kinematics.lower, kinematics.upper
    lost = bool((status == Status.TARGET_LOST).any())
    return start.id, {
        "success": bool(row["success"]), "reason": row["reason"], "detail": row["detail"],
        "view": lost or (row["border_px"] is not None and row["border_px"] < 0.0),
        "stop": bool((status == Status.JOINT_LIMIT).any()),
        "beyond": bool((q < lower - 1e-9).any() or (q > upper + 1e-9).any()),
        "border_px": row["border_px"], "looks": len(texts),
        "infeasible": sum("infeasible" in text or "standing still" in text for text in texts),
        "violations": witness.violations,
        "texts": sorted({text.split(" by ")[0] for text in texts if "infeasible" in text})[:3]}


_benches, _arms = {}, {}


def _kinematics_of(arm):
    if arm not in _arms:
        base = scenario_of(arm, "ibvs")
        _arms[arm] = base.kinematics(calibrated=False)
    return _arms[arm]


def candidates(arm, count, seed):
    """Starts that can be run, one after another, always the same ones in the same order; count: about so many."""
    scenario, kinematics, given, drawn = scenario_of(arm, "ibvs"), _kinematics_of(arm), 0, DRAWN * count
    while True:
        settings = SweepSettings.from_scenario(scenario, kinematics, starts=drawn, seed=seed, method="random")
        yield from (start for start in make_starts(settings, scenario, kinematics)[given:] if not start.refusal)
        given, drawn = drawn, 2 * drawn


class Kept:
    """Results of runs by (arm, law, id of the start), kept in a file if there is one: a line of JSON for each of them.

    Args: path: of the file; None: nothing is kept.  about: what the runs depend on, in the first line of the file.
    """

    def __init__(self, path, about):
        self._results, self._file = {}, None
        if path is None:
            return
        whole = path.read_text().rpartition("\n")[0] if path.exists() else ""  # a torn last line is left out
        head, *lines = whole.splitlines() or [json.dumps(about)]
        if json.loads(head) != about:
            raise SystemExit(f"--results: found runs of other scenarios or seeds in {path}, allowed another file")
        for arm, law, number, result in map(json.loads, lines):
            self._results[arm, law, number] = result
        path.write_text("\n".join([head, *lines, ""]))
        self._file = path.open("a", buffering=1)

    def run(self, jobs, pool):
        """Results of the jobs, in their order; those that were not kept are run."""
        left = [job for job in jobs if self._key(job) not in self._results]
        for job, (_, result) in zip(left, pool.map(run, left) if pool else map(run, left)):
            self._results[self._key(job)] = result
            if self._file is not None:
                print(json.dumps([*self._key(job), result]), file=self._file)
        return [self._results[self._key(job)] for job in jobs]

    @staticmethod
    def _key(job):
        return job[0], job[1], job[2].id


class Search:
    """The hard starts of one arm, and what each law makes of them.

    Attributes: results: law -> list of results, in the order of the starts.  tried: candidates so far.
    """

    def __init__(self, arm, laws, count, seed):
        self.arm, self.tried, self.results = arm, 0, {law: [] for law in ("ibvs", *laws)}
        self._count, self._candidates = count, candidates(arm, count, seed)

    @property
    def done(self):
        return len(self.results["ibvs"]) >= self._count

    def go_on(self, kept, pool):
        """Try the next candidates, and run all laws from the hard ones of them."""
        block = [start for start, _ in zip(self._candidates, range(BLOCK))]
        alone = kept.run([(self.arm, "ibvs", start) for start in block], pool)
        hard = [(start, found) for start, found in zip(block, alone)
                if found is not None and (found["view"] or found["stop"])][:self._count - len(self.results["ibvs"])]
        for law, found in self.results.items():
            found += kept.run([(self.arm, law, start) for start, _ in hard], pool)
        self.tried += len(block)
        print(f"{self.arm}: {self.tried} tried, {len(self.results['ibvs'])} hard starts", file=sys.stderr, flush=True)

    def lines(self):
        """Lines of the table."""
        lines = []
        for law, found in self.results.items():
            tried = [one for one in found if one is not None]
            won = sum(one["success"] for one in tried)
            low, high = wilson(won, len(tried))
            looks = sum(one["looks"] for one in tried)
            program = f"{looks} | {sum(one['infeasible'] for one in tried)} | {sum(one['violations'] for one in tried)}"
            lines.append(f"| {self.arm} | `{law}` | {len(tried)} | {sum(one['view'] for one in tried)} | "
                         f"{sum(one['beyond'] for one in tried)} | {won} ({100 * low:.1f} to {100 * high:.1f} %) | "
                         f"{program if law != 'ibvs' else '- | - | -'} |")
        return lines


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
    parser.add_argument("--results", metavar="FILE", type=pathlib.Path, help="keep every run there, and go on with it")
    parser.add_argument("--minutes", type=float, default=float("inf"), help="end the search after that time")
    parser.add_argument("--verbose", action="store_true", help="also list how the runs ended")
    parser.add_argument("--write", metavar="PAGE", type=pathlib.Path, help="put the table into this page")
    arguments = parser.parse_args()
    end_s, laws = time.monotonic() + 60.0 * arguments.minutes, [law for law in arguments.laws.split(",") if law]
    arms = arguments.arms.split(",")
    scenarios = repr([scenario_of(arm, law).as_dict() for arm in ARMS for law in ("ibvs", *laws)])
    kept = Kept(arguments.results, {"seed": arguments.seed, "laws": laws,
                                    "scenarios": hashlib.sha256(scenarios.encode()).hexdigest()})
    pool = ProcessPoolExecutor(arguments.workers, get_context("spawn")) if arguments.workers else None
    searches = [Search(arm, laws, arguments.starts, arguments.seed) for arm in arms]
    while time.monotonic() < end_s and not all(search.done for search in searches):
        for search in searches:
            if not search.done:
                search.go_on(kept, pool)
    lines = [line for search in searches for line in search.lines()]
    if arguments.verbose:
        for search in searches:
            for law, found in search.results.items():
                for i, one in enumerate(found):
                    print(search.arm, law, i, one)
    text = "\n".join([HEAD, *lines])
    print(text)
    if arguments.write:
        arguments.write.write_text(marked.replaced(arguments.write.read_text(), BEGIN + "\n", END, text + "\n"))


if __name__ == "__main__":
    main()
