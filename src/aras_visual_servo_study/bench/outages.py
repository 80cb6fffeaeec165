#!/usr/bin/env python3
"""A moving target that is not seen for a while: `servo.filter` beside hold, back_off and search, over the length of it.

python3 outages.py [--runs 10] [--seed 0] [--workers 2] [--write PAGE], with the workspace sourced; one table.

The target of scenario moving_target goes round on a circle whose radius and speed are drawn for each run; at a time
that is drawn too, no image shows it for so many seconds. A run succeeds when the camera is within 5 mm of its moving
goal half a second after the target is seen again. All ways have the same draws.
"""
import argparse
import os
import pathlib
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from aras_visual_servo import ExperimentSettings, Features, ServoLoop, load_scenario
from aras_visual_servo_study.sweep.statistics import wilson

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "script" / "pictures"))
import marked

LENGTHS_S = (0.25, 0.5, 1.0, 2.0)
#: Way: what it changes in the scenario. Search and backing off begin after 0.1 s.
WAYS = {
    "hold": {"servo.on_lost": "hold"},
    "back_off": {"servo.on_lost": "back_off"},
    "search": {"servo.on_lost": "search"},
    "filter": {"servo.filter": {"outage_s": 3.0, "noise": 0.0003, "acceleration": 0.05}},
}
RADIUS_M, SPEED_M_S, BEGIN_S = (0.03, 0.08), (0.02, 0.05), (2.5, 4.0)
NEAR_M, AFTER_S = 0.005, 0.5


def run(job):
    """(way, length, whether it succeeded, distance from the goal when the target is seen again [m]) of one job."""
    way, length_s, seed = job
    random = np.random.default_rng([seed, 7])
    radius, speed, begin_s = (float(random.uniform(*ends)) for ends in (RADIUS_M, SPEED_M_S, BEGIN_S))
    motion = {"type": "circle", "radius_m": radius, "angular_speed_rad_per_s": speed / radius, "axis": [0.0, 0.0, 1.0],
              "delay_s": 0.0}
    base = load_scenario("moving_target")
    model = dict(base.sim["scene"]["models"][0], motion=motion)
    changes = {"sim.scene.models": [model], "servo.time_limit_s": 20.0, **WAYS[way]}
    loop = ServoLoop(load_scenario("moving_target", changes))
    settings = ExperimentSettings.from_dict(loop.scenario.experiment, loop.kinematics)
    loop.place(settings.goal.joints, 0.5)
    for _ in loop.teach(settings.z_star_m):
        pass
    X_TG = np.linalg.solve(loop.moving_target_pose(), loop.camera_pose())
    loop.place(settings.start.joints, 0.5)
    loop.start(servo_only=True)
    step, first_ns, at_s = loop.servo.step, [], [0.0]

    def hidden(observation, dt_s):
        first_ns[:] = first_ns or [observation.stamp_ns]
        at_s[0] = 1e-9 * (observation.stamp_ns - first_ns[0])
        if begin_s <= at_s[0] < begin_s + length_s:
            observation.features = Features()
        return step(observation, dt_s)

    loop.servo.step = hidden
    when_seen = None
    while at_s[0] < begin_s + length_s + AFTER_S and not loop.sequence.done:
        loop.step()
        off = float(np.linalg.norm((loop.moving_target_pose() @ X_TG - loop.camera_pose())[:3, 3]))
        if when_seen is None and at_s[0] >= begin_s + length_s:
            when_seen = off
    return way, length_s, off < NEAR_M and not loop.servo.finished, off if when_seen is None else when_seen


BEGIN, END = "<!-- table: outages -->", "<!-- end table: outages -->"


def table(results):
    """Lines: for each way the successes and the median distance at the end of the outage, for each length."""
    lines = ["| while it is not seen | " + " | ".join(f"{length:g} s" for length in LENGTHS_S) + " |",
             "|---" * (len(LENGTHS_S) + 1) + "|"]
    for way in WAYS:
        cells = []
        for length in LENGTHS_S:
            found = [result for result in results if result[:2] == (way, length)]
            won = sum(result[2] for result in found)
            low, high = wilson(won, len(found))
            median = 1e3 * float(np.median([result[3] for result in found]))
            cells.append(f"{won} ({100 * low:.0f} to {100 * high:.0f} %), {median:.0f} mm")
        lines.append(f"| `{way}` | {' | '.join(cells)} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=10, help="of each way and length (default: 10)")
    parser.add_argument("--seed", type=int, default=0, help="of the circles and times")
    parser.add_argument("--workers", type=int, default=2, help="processes; 0: this one")
    parser.add_argument("--write", metavar="PAGE", type=pathlib.Path, help="put the table into this page")
    arguments = parser.parse_args()
    jobs = [(way, length, 1000 * arguments.seed + k)
            for way in WAYS for length in LENGTHS_S for k in range(arguments.runs)]
    if arguments.workers:
        with ProcessPoolExecutor(arguments.workers, get_context("spawn")) as pool:
            results = list(pool.map(run, jobs, chunksize=4))
    else:
        results = list(map(run, jobs))
    text = table(results)
    print(text)
    if arguments.write:
        arguments.write.write_text(marked.replaced(arguments.write.read_text(), BEGIN + "\n", END, text + "\n"))


if __name__ == "__main__":
    main()
