"""Scenes of things that came to rest under gravity: dropped one after another by Bullet, and recorded as numbers.

    python3 -m aras_visual_servo_study.compare.protocols.settled FILE.csv

drops our own things and writes what the workspace keeps as config/protocols/cns_render.csv.
"""

import csv
import sys
import tempfile
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Union

import numpy as np

from aras_visual_servo import ParameterError, spatial
from .props import save_props

SCENES, SEED, LEAST_THINGS, MOST_THINGS = 150, 2023, 8, 11
#: Things fall from this height [m] within this distance of the table's middle [m], one each so many seconds.
HEIGHT_M, RADIUS_M, EACH_S = 0.3, 0.2, 0.3
#: A scene has settled when nothing moves faster than this [m/s, rad/s], or after so long [s].
AT_REST, SETTLE_S, CHECK_S = 0.002, 8.0, 0.25
MASS_KG, PERIOD_S = 0.2, 0.002
COLUMNS = ("scene", "thing", "x_m", "y_m", "z_m", "roll_rad", "pitch_rad", "yaw_rad")
NOTHING = '<robot name="nothing"><link name="world"/></robot>'
KINDS = (".obj", ".dae", ".stl", ".ply")


class Resting(NamedTuple):
    """Where a thing of a scene lies: its name, position [m] and roll, pitch and yaw [rad]."""

    thing: str
    position_m: tuple
    rpy_rad: tuple


def settle(meshes: Dict[str, Path], number: int, count: Optional[int] = None) -> List[Resting]:
    """Drop things on a table and wait until they rest. The same seed and meshes give the same numbers.

    Args: meshes: {name: path of a mesh}.  number: of the scene.  count: of things; None: drawn, 8 to 11.
    Returns: list of `Resting`.
    """
    from aras_visual_servo_sim import Simulation
    rng, names = np.random.default_rng([SEED, number]), sorted(meshes)
    count = int(rng.integers(LEAST_THINGS, MOST_THINGS + 1)) if count is None else count
    sim = table(Simulation)
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


def table(simulation: Any) -> Any:
    """A simulation of nothing but a table, the plane z = 0."""
    return simulation(NOTHING, {"period_s": PERIOD_S, "contacts": {"ground_plane": {"z_m": 0.0}, "pairs": "all"}})


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
