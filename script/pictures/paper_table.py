"""The table of docs/performance.md that stands beside the paper's figures; script/bench --paper prints it as Markdown.

The published law and ours run from the same starts: the first STARTS of `sweep SCENARIO --seed SEED` that the arm can
reach and from which it sees the target. Every run is judged by the true camera pose.
"""
from collections import Counter

import numpy as np

from aras_visual_servo import Kinematics
from aras_visual_servo import load_scenario
from aras_visual_servo_study.sweep.plan import SweepSettings, make_starts
from aras_visual_servo_study.sweep.run import SweepRunner

STARTS, SEED, DRAWN = 16, 0, 64
AXES = ("x_mm", "y_mm", "z_mm", "angle_deg")
#: Experiment -> what the paper reports as its "mean of tracking errors": x, y, z [mm], angle [deg].
PUBLISHED = {1: ("2", "4.7", "2.6", "0.003"), 2: ("4", "8.9", "7.2", "0.03")}
#: What runs here -> the scenario of experiment {n}.
HERE = {"the published law, gains, stop rule and binary images of OSMesa, here": "experiment_{n}_paper",
        "ours: decoupled law, coverage images, tightened stop rule": "experiment_{n}"}
HEAD = "| final error of the true camera pose | x [mm] | y [mm] | z [mm] | angle [deg] |\n" \
       "|---|---|---|---|---|"


def final_errors(name, starts=STARTS):
    """Final errors of a scenario from its starts.

    Returns: (errors, ends): (starts, 4) array of |x|, |y|, |z| [mm] and the angle [deg]; Counter of how the runs ended.
    Raises: RuntimeError: too few of the DRAWN starts can be run, or a run broke off.
    """
    scenario = load_scenario(name)
    kinematics = Kinematics(scenario.urdf_xml(), scenario.robot["base_link"], scenario.robot["tip_link"])
    settings = SweepSettings.from_scenario(scenario, kinematics, starts=DRAWN, seed=SEED)
    bench, errors, ends = SweepRunner(scenario), [], Counter()
    for start in make_starts(settings, scenario, kinematics):
        row, _ = bench.run(start)
        if row["outcome"] == "infeasible":
            continue
        if row["outcome"] == "error":
            raise RuntimeError(f"{name}, start {start.id}: {row['detail']}")
        errors.append([abs(row[axis]) for axis in AXES])
        ends[row["reason"]] += 1
        if len(errors) == starts:
            return np.array(errors), ends
    raise RuntimeError(f"{name}: found {len(errors)} starts that can be run among {DRAWN}, needed {starts}")


def table():
    """(lines of the table, lines that say how the runs ended)."""
    lines, notes = [HEAD], []
    for number, published in PUBLISHED.items():
        lines.append(f"| experiment {number}, published: \"mean of tracking errors\" | {' | '.join(published)} |")
        for what, scenario in HERE.items():
            errors, ends = final_errors(scenario.format(n=number))
            cells = [f"{median:.3f} ({worst:.3f})" for median, worst in zip(np.median(errors, axis=0),
                                                                            errors.max(axis=0))]
            lines.append(f"| experiment {number}, {what} | {' | '.join(cells)} |")
            notes.append(f"{scenario.format(n=number)}: " + ", ".join(f"{n} x {end}" for end, n in ends.items()))
    return lines, notes


def main():
    """Print the table, and under it how the runs ended."""
    lines, notes = table()
    print("\n".join(lines + [""] + notes))
