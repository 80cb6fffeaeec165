#!/usr/bin/env python3
"""The target is dragged over its plane as on the live page: does the arm come to rest, and does the status say why?

python3 drags.py [SCENARIO ...] [--drags 200] [--seed 0] [--workers 2] [--rows FILE], with the workspace sourced.

Each drag is a live session of its own, without a page. The run of the scenario converges. Then the target goes along a
straight line to a place drawn evenly over the map of the reach (`reach` of the page), at a speed that is drawn too.
Five simulated seconds after it lies still, the arm has to be at rest, and to stay so. The status has to be true, by
ground truth and by an inverse kinematics that shares no code with the servo's (SciPy, from two postures):

- CONVERGED: the true pose of the camera is within the judge of the scenario.
- OUT_OF_REACH: the camera cannot come to the taught view, and it is nearly as near as it can be.
- SERVOING: the same, and the servo converges before STAYS_S: it works off what dry friction holds.
- TARGET_LOST: the image does not show the whole target, or shows more than one object.
"""
import argparse
import json
import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.ndimage import label
from scipy.optimize import least_squares

from aras_visual_servo import Outline, ParameterError, Status, load_scenario, spatial
from aras_visual_servo_study.live import messages as ask
from aras_visual_servo_study.live.run import LiveRun

SCENARIOS = ("experiment_1", "ur5e")
SPEED_M_S = (0.1, 0.4)
#: As a page asks for places of the target [s].
PAGE_S = 0.04
#: The arm has to be at rest REST_S after the drag and to stay so until STAYS_S: the camera moves no more than this.
REST_S, STAYS_S, STILL_M, STILL_RAD = 5.0, 8.0, 5e-4, 2e-3
#: The nearest point counts as reached within this, and this part of what is missing [m].
NEAR_M, NEAR_PART = 0.003, 0.1
#: The images tell how far the goal is to the rest of this part of what the stop rule allows.
TOLD_PART = 0.9
#: A target nearer to the border of the image than this may count as cut [px].
CUT_PX = 3.0
#: Grey below which a pixel is of a dark object, and the smallest one that counts [px]: `vision` of the scenarios.
DARK, LEAST_PX = 125, 50
#: Makes rotations weigh much more than translations, as for the servo [m].
LENGTH_M = 3.0
#: A joint without a limit [m, rad].
FAR = 1e3
WHOLE_NS = 10**12


def begun(name):
    """A live run that has converged at its goal."""
    run = LiveRun(load_scenario(name))
    run.do(ask.Start())
    while not run.loop.sequence.done:
        run.advance(WHOLE_NS)
    if run.record.status != Status.CONVERGED:
        raise ParameterError(f"{name}: found an end of {run.record.status.name}, allowed CONVERGED: "
                             f"{run.record.status_text}")
    return run


@lru_cache(maxsize=None)
def reach_of(name):
    """The map of the reach, as a page gets it."""
    return begun(name).do(ask.Reach())()


def to_place(run, begin, place_m, speed):
    """Drags the target from a pose, (4, 4), to a place in the world at this speed [m/s]."""
    q, way = spatial.quaternion_xyzw(begin[:3, :3]), place_m - begin[:3, 3]
    begin_ns, length_s = run.time_ns, float(np.linalg.norm(way)) / speed
    part = 0.0
    while part < 1.0:
        part = min(1.0, 1e-9 * (run.time_ns - begin_ns) / length_s)
        run.do(ask.PlaceTarget(tuple(begin[:3, 3] + part * way), tuple(q)))
        until_ns = run.time_ns + round(1e9 * PAGE_S)
        while part < 1.0 and run.time_ns < until_ns:
            run.advance(until_ns - run.time_ns)


def missing(kinematics, X_BC, starts, margin):
    """How near the camera comes to a pose, (4, 4), from the best of these joint positions: (m, rad)."""
    low, high = np.maximum(kinematics.lower + margin, -FAR), np.minimum(kinematics.upper - margin, FAR)

    def off(q):
        X = np.linalg.solve(kinematics.pose(q), X_BC)
        return np.concatenate([X[:3, 3] / LENGTH_M, spatial.rotation_vector(X[:3, :3])])

    best = min((least_squares(off, np.clip(q, low + 1e-9, high - 1e-9), bounds=(low, high), xtol=1e-12, ftol=1e-12,
                              gtol=1e-12, max_nfev=300) for q in starts), key=lambda result: result.cost)
    return LENGTH_M * float(np.linalg.norm(best.fun[:3])), float(np.linalg.norm(best.fun[3:]))


def drag(job):
    """Does one drag. Returns a dict: where to, how it ended, when the arm rested, whether the status is true, why."""
    name, number, seed = job
    draws, reach, run = np.random.default_rng([seed, number]), reach_of(name), begun(name)
    X_WP = spatial.pose_from_quaternion(reach["pose"][:3], reach["pose"][3:])
    rows = np.array(reach["missing_mm"])
    cell = [float(draws.uniform(-0.5, size - 0.5)) for size in rows.shape[::-1]]
    in_plane = [first + at * step for first, at, step in zip(reach["first_m"], cell, reach["step_m"])]
    place_m = X_WP[:3, :2] @ in_plane + X_WP[:3, 3]
    X_WT, X_WC, q_home = run.target_pose(), run.camera_pose(), run.joints()
    X_TC = np.linalg.solve(X_WT, X_WC)
    to_place(run, X_WT, place_m, draws.uniform(*SPEED_M_S))
    end_ns, poses = run.time_ns, []
    told = None
    while run.time_ns - end_ns < 1e9 * STAYS_S:
        run.advance(WHOLE_NS)
        t_s = 1e-9 * (run.time_ns - end_ns)
        poses.append((t_s, run.camera_pose()))
        if told is None and t_s >= REST_S:
            told = run.record, np.array(run.image)
    last = poses[-1][1]
    moves = [t_s for t_s, X in poses if not still(X, last)]
    record, image = told
    wanted = run.target_pose() @ X_TC
    true, why = judged(run, record, image, wanted, last, [run.joints(), q_home])
    return {"scenario": name, "number": number, "way_mm": np.round(1e3 * (place_m - X_WT[:3, 3]), 1).tolist(),
            "status": record.status.name, "rest_s": round(max(moves, default=0.0), 2), "true": true, "why": why,
            "green": bool(rows[tuple(int(round(at)) for at in cell[::-1])] == 0), "text": record.status_text}


def still(X, last):
    moved_m, moved_rad = spatial.size_of(spatial.inverse(last) @ X)
    return moved_m < STILL_M and moved_rad < STILL_RAD


def judged(run, record, image, wanted, X_WC, starts):
    """(whether the status is true, why) for a camera at X_WC that should be at `wanted`, (4, 4) each."""
    off_m, off_rad = spatial.size_of(spatial.inverse(wanted) @ X_WC)
    waits = record.status == Status.SERVOING and run.record.status == Status.CONVERGED
    if record.status == Status.CONVERGED or waits:
        judge = run.scenario.experiment.get("judge", {})
        most_m = 1e-3 * float(np.linalg.norm([judge.get(f"{axis}_mm", 1.0) for axis in "xyz"]))
        most_rad = np.radians(judge.get("angle_deg", 0.2))
        return bool(off_m <= most_m and off_rad <= most_rad), f"{1e3 * off_m:.3f} mm, {np.degrees(off_rad):.3f} deg off"
    if record.status == Status.OUT_OF_REACH:
        stop = run.servo.config.stop
        least_m, least_rad = missing(run.kinematics, wanted, starts, run.servo.config.joint_limit_margin)
        outside = least_m > TOLD_PART * stop.position_m or least_rad > stop.rotation_rad
        near = off_m - least_m < max(NEAR_M, NEAR_PART * least_m)
        return bool(outside and near), f"{1e3 * off_m:.2f} mm off, of {1e3 * least_m:.2f} mm and {least_rad:.4f} rad"
    if record.status == Status.TARGET_LOST:
        border_px = Outline.of(run.scenario).border_px(X_WC, run.target_pose())
        sizes = np.bincount(label(np.asarray(image).reshape(*image.shape[:2], -1).mean(axis=2) < DARK)[0].ravel())[1:]
        objects = int((sizes >= LEAST_PX).sum())
        return bool(border_px < CUT_PX or objects != 1), f"{border_px:.0f} px to the border, {objects} objects"
    return False, f"{1e3 * off_m:.2f} mm and {np.degrees(off_rad):.3f} deg off"


def main():
    """Exit code 1 unless the arm rested in time in every drag, with a true status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenarios", nargs="*", default=SCENARIOS, metavar="SCENARIO")
    parser.add_argument("--drags", type=int, default=200, help="of each scenario (default: 200)")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2, help="processes; 0: this one")
    parser.add_argument("--rows", default=os.devnull, help="file for one line of JSON per drag")
    arguments = parser.parse_args()
    jobs = [(name, arguments.first + number, arguments.seed)
            for name in arguments.scenarios for number in range(arguments.drags)]
    if arguments.workers:
        with ProcessPoolExecutor(arguments.workers, get_context("spawn")) as pool:
            rows = list(pool.map(drag, jobs))
    else:
        rows = list(map(drag, jobs))
    with open(arguments.rows, "w") as file:
        file.writelines(json.dumps(row) + "\n" for row in rows)
    failed = [row for row in rows if not row["true"] or row["rest_s"] > REST_S]
    for name in arguments.scenarios:
        of = [row for row in rows if row["scenario"] == name]
        good = sum(row not in failed for row in of)
        agrees = sum(row["green"] == (row["status"] == "CONVERGED") for row in of if row["status"] != "TARGET_LOST")
        seen = sum(row["status"] != "TARGET_LOST" for row in of)
        print(f"{name}: at rest within {REST_S:g} s and status true in {good} of {len(of)}; the last at rest after "
              f"{max(row['rest_s'] for row in of):.2f} s; {dict(Counter(row['status'] for row in of))}; the map agrees "
              f"in {agrees} of {seen} that kept the target in view")
    for row in failed:
        print("FAILED", json.dumps(row))
    return int(bool(failed))


if __name__ == "__main__":
    sys.exit(main())
