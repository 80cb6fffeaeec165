#!/usr/bin/env python3
"""How far from the goal photometric servoing may begin: `vision.photometric.mapping` beside the grey levels alone.

python3 photometric_domain.py [--starts 16] [--seed 0] [--workers 2] [--write PAGE], with the workspace sourced; one
table.

A free-flying camera of 160 x 120 px sees a board of many small shapes, another for each seed, that fills its view. Each
start is a displacement along all six axes whose direction is drawn; it is made so large that the points of the image
move by the radius, rms, in parts of the image's width. A run succeeds when the camera has been within 3 mm and 0.3 deg
of the goal for half a second before the time is up. All ways have the same starts.
"""
import argparse
import os
import pathlib
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from aras_visual_servo_study.compare.protocols import board as boards
from aras_visual_servo import ExperimentSettings, ServoLoop, load_scenario, scenario_from_dict, spatial
from aras_visual_servo_study.sweep.statistics import wilson

sys.path.append(str(pathlib.Path(__file__).resolve().parents[3] / "script" / "pictures"))
import marked

#: Way: its `vision.photometric`.
WAYS = {
    "`none`": {},
    "`none`, `levels: 4`": {"levels": 4},
    "`pca`": {"mapping": "pca"},
    "`dct`": {"mapping": "dct"},
    "`mixture`": {"mapping": "mixture"},
    "`mutual_information`": {"mapping": "mutual_information"},
    "`mutual_information`, `levels: 4`": {"mapping": "mutual_information", "levels": 4},
}
RADII = (0.03, 0.06, 0.1, 0.15, 0.2, 0.3)  # of the image's width
WIDTH_PX, HEIGHT_PX, FIELD_RAD, Z_STAR_M, RATE_HZ = 160, 120, 1.1344640138, 0.6, 10.0
BOARD_M = [1.6, 1.2]
LIMIT_S, HELD_S, NEAR_M, NEAR_RAD = 10.0, 0.5, 0.003, np.radians(0.3)


def scenario(photometric, picture_file):
    """The scene of `vit_vs` with a board that fills the view, servoed on by its grey levels."""
    template = load_scenario("vit_vs")
    document = template.as_dict()
    camera, picture = document["sim"]["cameras"][0], document["sim"]["scene"]["models"][0]
    camera.update(width=WIDTH_PX, height=HEIGHT_PX, horizontal_fov_rad=FIELD_RAD, rate_hz=RATE_HZ, encoding="mono8")
    picture["image"] = {"file": str(picture_file), "size_m": BOARD_M}
    del document["vision"]["matches"]
    document["vision"]["photometric"] = photometric
    for key in ("source", "pose_from", "stop"):
        del document["servo"][key]
    document["servo"].update(law="photometric", features=["photometric"], gains_per_s={"photometric": 5.0},
                             thresholds={"photometric": 0.01}, time_limit_s=2.0 * LIMIT_S)
    return scenario_from_dict(document, source="photometric_domain", base=template._base, path=template.path)


def image_motion(X, rays):
    """Rms way [-] of the points that the camera at the goal sees at these rays, (n, 3), once it is displaced by X.

    Points that come to lie behind the camera make it infinite."""
    points = (Z_STAR_M * rays - X[:3, 3]) @ X[:3, :3]
    if points[:, 2].min() <= 0.1 * Z_STAR_M:
        return np.inf
    return float(np.sqrt(np.mean(np.sum((points[:, :2] / points[:, 2:] - rays[:, :2]) ** 2, axis=1))))


def displacement(random, radius):
    """(4, 4) displacement of the camera from the goal that moves the image by `radius` of its width.

    Its direction is drawn on the sphere of (translation over depth, rotation vector); its length is found by halving.
    """
    half = np.tan(0.5 * FIELD_RAD)
    u, v = np.meshgrid(np.linspace(-half, half, 9), np.linspace(-0.75 * half, 0.75 * half, 7))
    rays = np.stack([u.ravel(), v.ravel(), np.ones(u.size)], axis=1)
    way = random.normal(size=6)
    way *= np.r_[np.full(3, Z_STAR_M), np.ones(3)] / np.linalg.norm(way)
    short, long = 0.0, 1.0
    while long - short > 1e-6:
        middle = 0.5 * (short + long)
        if image_motion(spatial.exponential(middle * way), rays) < 2.0 * half * radius:
            short = middle
        else:
            long = middle
    return spatial.exponential(short * way)


def run(job):
    """(way, radius, [whether each start arrived]) of one job: (way, radius, starts, seed, board)."""
    way, radius, starts, seed, board = job
    loop = ServoLoop(scenario(WAYS[way], board))
    experiment = dict(loop.scenario.experiment)
    goal = experiment["goal"]["camera"]
    X_WG = spatial.pose_from_rpy(goal["position_m"], goal["rpy_rad"])
    settings = ExperimentSettings.from_dict(experiment, loop.kinematics)
    loop.place(settings.goal.joints, 0.1)
    for _ in loop.teach(settings.z_star_m):
        pass
    X_WG_seen = loop.camera_pose()
    arrived = []
    for k in range(starts):
        X = X_WG @ displacement(np.random.default_rng([seed, k]), radius)
        experiment["start"] = {"camera": {"position_m": X[:3, 3].tolist(),
                                          "rpy_rad": np.asarray(spatial.rpy_of(X[:3, :3])).tolist()}}
        loop.place(ExperimentSettings.from_dict(experiment, loop.kinematics).start.joints, 0.1)
        loop.start(servo_only=True)
        held = 0
        for _ in range(round(LIMIT_S * RATE_HZ)):
            loop.step()
            off = spatial.inverse(X_WG_seen) @ loop.camera_pose()
            near = np.linalg.norm(off[:3, 3]) < NEAR_M and spatial.rotation_angle(off[:3, :3]) < NEAR_RAD
            held = held + 1 if near else 0
            if held > HELD_S * RATE_HZ or np.linalg.norm(off[:3, 3]) > 2.0 * Z_STAR_M or loop.sequence.done:
                break
        arrived.append(held > HELD_S * RATE_HZ)
        command, _ = loop.sequence.stop(loop.seen.stamp_ns, "next start")
        loop.sim.set_command(position=command.position, velocity=command.velocity, stamp_ns=loop.seen.stamp_ns)
    return way, radius, arrived


def half_radius(rates):
    """Radius at which half of the starts arrive, between those of the table on a straight line; text."""
    before = (0.0, 1.0)
    for radius, rate in zip(RADII, rates):
        if rate < 0.5:
            share = (before[1] - 0.5) / (before[1] - rate)
            return f"{100 * (before[0] + share * (radius - before[0])):.0f} %"
        before = (radius, rate)
    return f"> {100 * RADII[-1]:.0f} %"


BEGIN, END = "<!-- table: photometric_domain -->", "<!-- end table: photometric_domain -->"


def table(results):
    """Lines: for each way how many starts arrive at each radius, and the radius at which half of them do."""
    heads = [f"{100 * radius:g} %" for radius in RADII]
    lines = ["| `mapping` | " + " | ".join(heads) + " | half arrive at |", "|---" * (len(RADII) + 2) + "|"]
    for way in WAYS:
        found = [next(arrived for w, r, arrived in results if (w, r) == (way, radius)) for radius in RADII]
        cells = []
        for arrived in found:
            low, high = wilson(sum(arrived), len(arrived))
            cells.append(f"{sum(arrived)} of {len(arrived)} ({100 * low:.0f} to {100 * high:.0f} %)")
        lines.append(f"| {way} | {' | '.join(cells)} | {half_radius([np.mean(arrived) for arrived in found])} |")
    return "\n".join(lines)


def done(jobs, workers):
    """The results of the jobs in their order, as they come."""
    if not workers:
        yield from map(run, jobs)
        return
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        yield from pool.map(run, jobs)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=16, help="of each way and radius (default: 16)")
    parser.add_argument("--seed", type=int, default=0, help="of the displacements")
    parser.add_argument("--workers", type=int, default=2, help="processes; 0: this one")
    parser.add_argument("--write", metavar="PAGE", type=pathlib.Path, help="put the table into this page")
    arguments = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        board = pathlib.Path(folder) / "board.png"
        boards.save(board, boards.draw(arguments.seed))
        jobs = [(way, radius, arguments.starts, arguments.seed, board) for way in WAYS for radius in RADII]
        for result in done(jobs, arguments.workers):
            print(*result, file=sys.stderr, flush=True)
            results.append(result)
    text = table(results)
    print(text)
    if arguments.write:
        arguments.write.write_text(marked.replaced(arguments.write.read_text(), BEGIN + "\n", END, text + "\n"))


if __name__ == "__main__":
    main()
