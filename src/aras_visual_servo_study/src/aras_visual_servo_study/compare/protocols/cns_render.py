"""Protocol `cns_render`: 150 scenes of things that came to rest on a table, from the publication of CNS."""

from pathlib import Path
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np
import yaml

from ...files import share_dir
from ...sweep.plan import Start
from aras_visual_servo import Scenario, load_scenario
from .base import Case, Protocol, register_protocol, spread
from .cns_affine import apart, drawn, starts_of
from .settled import SCENES, load_scenes, meshes_in, save_props, settle

#: Distance from the middle of the table [m], angle above it [deg], largest turns about z, y, x [deg]: of both poses.
DISTANCE_M, ABOVE_DEG, TURNS_DEG = (0.5, 0.9), (70.0, 90.0), (15.0, 5.0, 5.0)
SEED, DETECTORS = 2023, ("orb", "akaze", "sift")
#: Where our own things lie.
RECORD = share_dir() / "config" / "protocols" / "cns_render.csv"
PUBLISHED = {"akaze": (1.0, "CNS's network on AKAZE, Chen et al. 2024")}


@register_protocol("cns_render")
class CnsRender(Protocol):
    """150 tables with 8 to 11 things on each, and a goal and a start of its own.

    Image (640 x 480, f 540 px), ranges of the poses, 600 steps at 50 Hz and CNS's metric are those of its program. Ours
    are the things (others by --meshes), where they lie, the poses that were drawn, light and table, and the law
    (scenario `cns_render`).
    """

    title = "CNS, rendered scenes: 150 tables with things that came to rest"
    source = ("A. Chen, H. Yu, Y. Wang, R. Xiong, \"CNS: Correspondence encoded neural image servo policy\", ICRA "
              "2024; ranges as in github.com/hhcaz/CNS (BenchmarkEnvRender)")
    metric, published_starts, takes = "cns", SCENES, ("meshes",)

    def cases(self, folder: Path, count: int, meshes: Optional[str] = None) -> List[Case]:
        scenes = saved_scenes(folder, [index + 1 for index in spread(count, SCENES)], meshes)
        cases = []
        for detector in DETECTORS:
            scenario = load_scenario("cns_render", {"vision.matches": {"detector": detector}})
            cases.append(Case(detector, scenario, planned(scenario, count, scenes), {"detector": detector.upper()},
                              PUBLISHED.get(detector)))
        return cases


def pairs(count: int = SCENES) -> Tuple[np.ndarray, ...]:
    """(X_WCg, X_WC), (count, 4, 4) each: `count` of the 150 goals and starts, optical frames that look at the table."""
    rng, found = np.random.RandomState(SEED), []
    while len(found) < SCENES:
        goal, start = (drawn(rng, DISTANCE_M, ABOVE_DEG, TURNS_DEG) for _ in range(2))
        if apart(goal, start):
            found.append((goal, start))
    return tuple(np.array(poses) for poses in zip(*(found[index] for index in spread(count, SCENES))))


def planned(scenario: Scenario, count: int, scenes: Dict[int, Path]) -> List[Start]:
    """The starts, list of `Start`, each with a goal and a scene of its own; their id is that of the protocol.

    Args: scenes: {id: path of the file with the things}.
    """
    def parameters(number, X_WCg):
        depth_m = float(-X_WCg[2, 3] / X_WCg[2, 2])  # of the table along the axis
        return {"experiment.z_star_m": depth_m, "scene": str(scenes[number])}

    goals, starts = pairs(count)
    return starts_of(scenario, spread(count, SCENES), goals, starts, parameters)


def saved_scenes(folder: Path, numbers: Sequence[int], meshes: Optional[str] = None) -> Dict[int, Path]:
    """{number: path of a file with the things of a scene}; files that are there are taken.

    Args: meshes: folder of the user's meshes, which are dropped first; None: our own, where the record has them.
    Raises ParameterError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = save_props(folder / "meshes") if meshes is None else meshes_in(meshes)
    recorded = load_scenes(RECORD) if meshes is None else {}
    paths = {}
    for number in numbers:
        paths[number] = path = (folder / f"scene_{number}.yaml").resolve()
        if not path.exists():
            things = recorded[number] if meshes is None else settle(files, number)
            solids = [{"name": f"thing_{k + 1}", "mesh": str(files[one.thing]), "position_m": list(one.position_m),
                       "rpy_rad": list(one.rpy_rad)} for k, one in enumerate(things)]
            path.write_text(yaml.safe_dump({"solids": solids}), encoding="utf-8")
    return paths
