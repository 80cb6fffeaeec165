"""Protocol `clutter`: targets among distractors, half covered, under moving shadows and changing light."""

import json
import math
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple, Union

import numpy as np
import yaml

from aras_visual_servo import Scenario, load_scenario, load_yaml, resolve_uri, scenario_from_dict
from ...sweep.plan import Start, SweepSettings, make_starts
from . import board as boards
from .base import Case, Protocol, check_count, register_protocol
from .vit_vs import GOAL_M

STARTS, SEED, BOARD_SEED = 200, 16, 1
#: The board lies in the plane z = 0, its middle at the origin, and the camera looks down on it.
#: Width and height of the board [m], how it is turned, half its extent along x and y of the world [m], and how many
#: distractors stand on and beside it.
BOARD_M, TURN_RAD, HALF_M, DISTRACTORS = (0.8, 0.6), -0.5 * math.pi, (0.3, 0.4), 14
#: Share of the board's area that is covered.
COVERED = 0.5
#: The lamp of the scene, of a steady light; `light` moves it.
LAMP = {"name": "lamp", "type": "directional", "direction": [-0.5, -0.3, -1.0], "intensity": 0.6}
CONDITIONS = ("plain", "distractors", "covered", "shadows", "light", "all")
BALL = {"distance_m": [0.05, 0.2], "angle_rad": [0.0, 0.5]}
_GAINS = {axis: 1.5 for axis in ("xr", "yr", "zr", "rx", "ry", "rz")}
_MOMENTS = "xn", "yn", "an", "sx", "sy", "alpha"
#: Scheme -> what it changes in the scenario `vit_vs`.
SCHEMES: Dict[str, Dict[str, Any]] = {
    "orb": {"vision.matches": {"detector": "orb"}, "servo.gains_per_s": _GAINS},
    "sift": {"vision.matches": {"detector": "sift"}, "servo.gains_per_s": _GAINS},
    "photometric": {
        "vision.matches": None, "servo.source": None, "servo.pose_from": None, "servo.law": "photometric",
        "vision.photometric": {"interaction": "mean", "levels": 4, "switch_px": 0.5,
                               "target_normal_C": [0.0, 0.0, 1.0]},
        "servo.features": ["photometric"], "servo.gains_per_s": {"photometric": 1.5},
        "servo.thresholds": {"photometric": 2.0}, "servo.photometric": {"damping": 0.01}, "servo.stop": None},
    "moments": {  # of a dark sign on a bright board; shadows and distractors may be dark too
        "vision.matches": None, "servo.source": None, "servo.pose_from": None, "servo.law": "ibvs",
        "vision.segmentation": "coverage", "vision.component": "most_similar",
        "vision.min_area_px": 800, "vision.order": 4, "servo.interaction": "mean",
        "servo.features": list(_MOMENTS), "servo.gains_per_s": {name: 1.5 for name in _MOMENTS},
        "servo.thresholds": {"xn": 0.0005, "yn": 0.0005, "an": 0.0005, "sx": 0.001, "sy": 0.001, "alpha": 0.001},
        "servo.stop": None},
}
#: The sign that moments are computed of, and how much smaller than in its file it is on the board.
SIGN, SIGN_SCALE = "package://aras_description/targets/l_shape.yaml", 0.8


@register_protocol("clutter")
class Clutter(Protocol):
    """Each scheme of SCHEMES under each of CONDITIONS. Where the camera is, is known exactly, whatever it sees.

    The goal is taught without clutter; then it comes, another one for each start, and the camera is put at the start.
    """

    title = "Clutter: distractors, half the target covered, moving shadows, changing light"
    source = "this project"
    metric, published_starts, takes = "success", STARTS, ("board",)

    def cases(self, folder: Path, count: int, board: Optional[str] = None) -> List[Case]:
        check_count(count, STARTS)
        folder.mkdir(parents=True, exist_ok=True)
        textured = boards.save_mesh(folder / "board", lambda: boards.asked_for(board, BOARD_SEED), BOARD_M)
        sign = boards.save_mesh(folder / "sign", _sign, BOARD_M)
        files = {(condition, number): _saved(folder, condition, number) for condition in CONDITIONS[1:]
                 for number in range(1, count + 1)}
        cases = []
        for scheme, changes in SCHEMES.items():
            scenario = scene(sign if scheme == "moments" else textured, changes)
            starts = planned(scenario, count)
            for condition in CONDITIONS:
                chosen = starts if condition == "plain" else [
                    Start(start.id, start.joints, start.offset, {"clutter": str(files[condition, start.id])})
                    for start in starts]
                cases.append(Case(f"{scheme}_{condition}", scenario, chosen, {"scheme": scheme, "clutter": condition}))
        return cases


def scene(mesh: Union[str, Path], changes: Dict[str, Any]) -> Scenario:
    """The scenario: a lit board below the camera of `vit_vs`, drawn by OpenGL, 15 s for a run.

    Args: changes: {"section.key": value}; a key whose value is None is left out.
    """
    template = load_scenario("vit_vs")
    document = template.as_dict()
    camera = {**document["sim"]["cameras"][0], "renderer": "opengl"}
    camera.pop("sampling")
    document["sim"].update(cameras=[camera], scene={
        "background_rgb": [178, 178, 178], "lighting": {"lights": [LAMP]},
        "solids": [{"name": "board", "mesh": str(mesh), "rpy_rad": [0.0, 0.0, TURN_RAD]}]})
    document["sweep"] = {"abort_factor": 5.0, "space": "ball", "ball": BALL}
    for path, value in {"servo.time_limit_s": 15.0, "experiment.z_star_m": GOAL_M[2], **changes}.items():
        section, key = path.split(".")
        document[section].pop(key, None)
        if value is not None:
            document[section][key] = value
    return scenario_from_dict(document, source="clutter", base=template._base, path=template.path)


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The first `count` starts, list of `Start`, at random in the ball about the goal."""
    kinematics = scenario.kinematics(calibrated=False)
    settings = SweepSettings.from_scenario(scenario, kinematics, starts=count, method="random", seed=SEED)
    return make_starts(settings, scenario, kinematics)


def _sign():
    outlines = load_yaml(resolve_uri(SIGN))["outlines_m"]
    return boards.sign([SIGN_SCALE * np.array(outline) for outline in outlines], BOARD_M)


def _saved(folder, condition, number):
    path = folder / f"{condition}_{number}.yaml"
    if not path.exists():
        rng = np.random.default_rng([SEED, CONDITIONS.index(condition), number])
        # Through JSON, since YAML cannot write numpy's numbers.
        plain = json.loads(json.dumps(clutter(condition, rng), default=np.generic.item))
        path.write_text(yaml.safe_dump(plain), encoding="utf-8")
    return path.resolve()


def clutter(condition: str, rng: np.random.Generator) -> Dict[str, List[Dict[str, Any]]]:
    """{"solids": [...], "lights": [...]} of a condition, entries as in the section `sim.scene`."""
    makers = {"distractors": distractors, "covered": cover, "shadows": passers}
    solids = [solid for name, make in makers.items() if condition in (name, "all") for solid in make(rng)]
    carriers, lights = moving_light(rng) if condition in ("light", "all") else ([], [])
    return {"solids": solids + carriers, "lights": lights}


def distractors(rng: np.random.Generator) -> List[Dict[str, Any]]:
    """Boxes, balls and cylinders of all colours, lying on the board's outer half and around it."""
    found = []
    for number in range(DISTRACTORS):
        size = rng.uniform(0.015, 0.045)
        kind = ({"box_m": [2.0 * size, rng.uniform(0.5, 2.0) * size, size]}, {"sphere_m": 0.5 * size},
                {"cylinder_m": [0.5 * size, size]})[rng.integers(3)]
        angle, out = rng.uniform(-math.pi, math.pi), rng.uniform(0.55, 1.15)
        place = [out * HALF_M[0] * math.cos(angle), out * HALF_M[1] * math.sin(angle), 0.5 * size]
        found.append({"name": f"distractor_{number + 1}", **kind, "color_rgb": rng.integers(0, 256, 3).tolist(),
                      "position_m": place, "rpy_rad": [0.0, 0.0, angle]})
    return found


def cover(rng: np.random.Generator) -> List[Dict[str, Any]]:
    """A sheet of one grey that lies on half of the board, on a side of chance."""
    along = rng.integers(2)
    half = [HALF_M[0], HALF_M[1]]
    half[along] *= COVERED
    place = [0.0, 0.0]
    place[along] = (1.0 - COVERED) * HALF_M[along] * rng.choice((-1.0, 1.0))
    return [{"name": "cover", "box_m": [2.0 * half[0], 2.0 * half[1], 0.004], "position_m": [*place, 0.004],
             "color_rgb": [int(rng.integers(60, 200))] * 3}]


def passers(rng: np.random.Generator) -> List[Dict[str, Any]]:
    """Boxes that circle beside the camera, between the lamp and the board, and throw their shadows on it."""
    found = []
    for number in range(3):
        height, phase = rng.uniform(0.9, 1.2), rng.uniform(-math.pi, math.pi)
        radius, turns = rng.uniform(0.1, 0.3), rng.choice((-1.0, 1.0)) * rng.uniform(0.3, 1.0)
        middle = [-LAMP["direction"][0] * height, -LAMP["direction"][1] * height]  # its shadow goes about the board's
        start = [middle[0] + radius * math.cos(phase), middle[1] + radius * math.sin(phase), height]
        found.append({"name": f"passer_{number + 1}", "box_m": [0.12, 0.08, 0.02], "position_m": start,
                      "color_rgb": [90, 90, 90],
                      "motion": {"type": "circle", "radius_m": radius, "phase_rad": phase,
                                 "angular_speed_rad_per_s": turns}})
    return found


def moving_light(rng: np.random.Generator) -> Tuple[List[Dict[str, Any]], List[Dict[str, Any]]]:
    """(solids, lights): a lamp on a carrier that comes and goes, and another brightness and tint of the steady one."""
    phase, turns = rng.uniform(-math.pi, math.pi), rng.uniform(0.4, 1.2)
    start = [0.9 * math.cos(phase), 0.9 * math.sin(phase), 1.6]
    carrier = {"name": "carrier", "sphere_m": 0.01, "position_m": start, "material": {"casts_shadows": False},
               "motion": {"type": "circle", "radius_m": 0.9, "phase_rad": phase, "angular_speed_rad_per_s": turns}}
    tint = [int(grey) for grey in rng.integers(170, 256, 3)]
    lamps = [{**LAMP, "intensity": float(rng.uniform(0.2, 0.6)), "color_rgb": tint},
             {"name": "wanderer", "type": "point", "attached_to": "carrier", "intensity": float(rng.uniform(0.4, 0.9)),
              "attenuation_quadratic": 0.5, "casts_shadows": False}]
    return [carrier], lamps
