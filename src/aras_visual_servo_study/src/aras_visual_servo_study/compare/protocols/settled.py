"""Scenes of things that came to rest under gravity: dropped one after another by Bullet, and recorded as numbers.

Our own things are boxes, cans and prisms of the size of groceries, textured and painted by a seeded program.

    python3 -m aras_visual_servo_study.compare.protocols.settled FILE.csv

drops our own things and writes what the workspace keeps as config/protocols/cns_render.csv.
"""

import csv
import math
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Union

import numpy as np

from aras_visual_servo import ParameterError, spatial
from . import board as boards

SCENES, SEED, LEAST_THINGS, MOST_THINGS = 150, 2023, 8, 11
#: Things fall from this height [m] within this distance of the table's middle [m], one each so many seconds.
HEIGHT_M, RADIUS_M, EACH_S = 0.3, 0.2, 0.3
#: A scene has settled when nothing moves faster than this [m/s, rad/s], or after so long [s].
AT_REST, SETTLE_S, CHECK_S = 0.002, 8.0, 0.25
MASS_KG, PERIOD_S = 0.2, 0.002
COLUMNS = ("scene", "thing", "x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")
NOTHING = '<robot name="nothing"><link name="world"/></robot>'
KINDS = (".obj", ".dae", ".stl", ".ply")
#: Size of a texel of the things [m], seed of the first thing's picture, shapes in a square decimetre of a picture.
TEXEL_M, PICTURE_SEED, SHAPES_PER_DM2, LARGEST_PX = 0.0005, 31, 120, 80.0
SIDES = 16  # of a can


@dataclass(frozen=True)
class Prop:
    """One thing: a prism of `corners` [m], counter-clockwise about its middle, and of a height, upright on z."""

    name: str
    corners: np.ndarray
    height_m: float


def _box(name, x, y, z):
    return Prop(name, 0.5 * np.array([(x, -y), (x, y), (-x, y), (-x, -y)]), z)


def _round(name, radius, z, sides=SIDES):
    angles = 2.0 * math.pi * np.arange(sides) / sides
    return Prop(name, radius * np.stack([np.cos(angles), np.sin(angles)], axis=1), z)


#: The things: lengths are those of what stands in kitchens.
PROPS = (_box("box_flat", 0.16, 0.11, 0.035), _box("box_tall", 0.07, 0.05, 0.17), _box("box_cube", 0.075, 0.075, 0.075),
         _box("box_book", 0.20, 0.14, 0.025), _box("box_bar", 0.15, 0.045, 0.03), _box("box_tea", 0.13, 0.07, 0.06),
         _round("can_soup", 0.034, 0.10), _round("can_fish", 0.043, 0.035), _round("can_large", 0.05, 0.13),
         _round("can_small", 0.027, 0.06), _round("prism_six", 0.045, 0.09, 6), _round("prism_three", 0.06, 0.11, 3))


def save_props(folder: Path) -> Dict[str, Path]:
    """Write the things, NAME.obj with .mtl and .png each; files that are there are taken. Returns {name: path}."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, prop in enumerate(PROPS):
        if not (folder / f"{prop.name}.obj").exists():
            _save_prop(folder, prop, PICTURE_SEED + number)
    return {prop.name: (folder / f"{prop.name}.obj").resolve() for prop in PROPS}


def _save_prop(folder, prop, seed):
    """The sides are one strip of the picture, side by side; both ends lie beneath it."""
    points = np.asarray(prop.corners)
    ring = np.vstack([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    width_m = max(along[-1], 2.0 * extent[0])
    height_m = prop.height_m + extent[1]
    size_px = math.ceil(width_m / TEXEL_M), math.ceil(height_m / TEXEL_M)
    shapes = math.ceil(SHAPES_PER_DM2 * 100.0 * width_m * height_m)
    vertices, coordinates, normals, faces = [], [], [], []

    def vertex(place, coordinate):
        vertices.append(place)
        coordinates.append((coordinate[0] / width_m, 1.0 - coordinate[1] / height_m))

    def face(normal, count):
        normals.append(normal)
        first = len(vertices) - count + 1
        faces.extend([(first, first + k, first + k + 1, len(normals)) for k in range(1, count - 1)])

    half = 0.5 * prop.height_m
    for (a, b), (s, t) in zip(zip(ring[:-1], ring[1:]), zip(along[:-1], along[1:])):
        for place, coordinate in ((*a, -half), (s, prop.height_m)), ((*b, -half), (t, prop.height_m)), \
                ((*b, half), (t, 0.0)), ((*a, half), (s, 0.0)):
            vertex(place, coordinate)
        normal = np.array([b[1] - a[1], a[0] - b[0], 0.0])
        face(normal / np.linalg.norm(normal), 4)
    for up, order, shift in ((1.0, 1, 0.0), (-1.0, -1, extent[0])):
        for x, y in points[::order]:
            vertex((x, y, up * half), (shift + x - low[0], prop.height_m + y - low[1]))
        face((0.0, 0.0, up), len(points))
    boards.write_obj(folder / prop.name, boards.draw(seed, size_px, shapes, LARGEST_PX), vertices, coordinates, normals,
                     faces)


class Resting(NamedTuple):
    """Where a thing of a scene lies: its name, position [m] and roll, pitch and yaw [rad]."""

    thing: str
    position_m: tuple
    rpy_rad: tuple


def settle(meshes: Dict[str, Path], number: int, count: Optional[int] = None) -> List[Resting]:
    """Drops things on a table and waits until they rest. The same seed and meshes give the same numbers.

    Args: meshes: {name: path of a mesh}.  number: of the scene.  count: of things; None: drawn, 8 to 11.
    """
    rng, names = np.random.default_rng([SEED, number]), sorted(meshes)
    count = int(rng.integers(LEAST_THINGS, MOST_THINGS + 1)) if count is None else count
    sim = table()
    chosen = [names[k] for k in rng.integers(0, len(names), count)]
    each = round(EACH_S * 1e9 / sim.period_ns)
    for k, name in enumerate(chosen):
        angle, out = rng.uniform(-np.pi, np.pi), RADIUS_M * np.sqrt(rng.random())
        sim.spawn_model({"name": f"thing_{k + 1}", "mesh": str(meshes[name]), "mass_kg": MASS_KG, "touches": "all",
                         "position_m": [float(out * np.cos(angle)), float(out * np.sin(angle)), HEIGHT_M],
                         "rpy_rad": rng.uniform(-np.pi, np.pi, 3).tolist()})
        sim.step(each)
    things = [f"thing_{k + 1}" for k in range(count)]
    for _ in range(round(SETTLE_S / CHECK_S)):
        sim.step(round(CHECK_S * 1e9 / sim.period_ns))
        if max(np.abs(sim.model_twist(thing)).max() for thing in things) < AT_REST:
            break
    return [_rounded(name, sim.model_pose(thing)) for name, thing in zip(chosen, things)]


def save_scenes(path: Union[str, Path], scenes: Dict[int, List[Resting]]) -> None:
    """Write {number: list of Resting} as CSV."""
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for number, things in sorted(scenes.items()):
            for one in things:
                writer.writerow([number, one.thing, *(f"{v:.5f}" for v in (*one.position_m, *one.rpy_rad))])


def load_scenes(path: Union[str, Path]) -> Dict[int, List[Resting]]:
    """{number: list of Resting} of a CSV file of `save_scenes`. Raises ParameterError."""
    scenes = {}
    with open(path, encoding="utf-8", newline="") as file:
        rows = csv.DictReader(file)
        if tuple(rows.fieldnames or ()) != COLUMNS:
            raise ParameterError(f"{path}: found columns {rows.fieldnames}, allowed {', '.join(COLUMNS)}")
        for row in rows:
            values = [float(row[name]) for name in COLUMNS[2:]]
            scenes.setdefault(int(row["scene"]), []).append(Resting(row["thing"], tuple(values[:3]),
                                                                    tuple(values[3:])))
    return scenes


def meshes_in(folder: Union[str, Path]) -> Dict[str, Path]:
    """{name: path} of the meshes in a folder and those below it, but for those called collision; name: path in it.

    Raises ParameterError: there are none.
    """
    root = Path(folder).expanduser()
    found = {str(path.relative_to(root)): path.resolve() for path in sorted(root.rglob("*"))
             if path.suffix.lower() in KINDS and "collision" not in path.name}
    if not found:
        raise ParameterError(f"--meshes: found {folder}, allowed a folder with meshes ({', '.join(KINDS)})")
    return found


def table() -> Any:
    """A simulation of nothing but a table, the plane z = 0."""
    from aras_visual_servo_sim import Simulation
    return Simulation(NOTHING, {"period_s": PERIOD_S, "contacts": {"ground_plane": {"z_m": 0.0}, "pairs": "all"}})


def _rounded(name, X_WM):
    return Resting(name, tuple(round(float(v), 5) for v in X_WM[:3, 3]),
                   tuple(round(float(v), 5) for v in spatial.rpy_of(X_WM[:3, :3])))


def main(path: str) -> None:
    """Drop our own things for all scenes and write the file."""
    with tempfile.TemporaryDirectory() as folder:
        meshes = save_props(Path(folder))
        save_scenes(path, {number: settle(meshes, number) for number in range(1, SCENES + 1)})


if __name__ == "__main__":
    main(sys.argv[1])
