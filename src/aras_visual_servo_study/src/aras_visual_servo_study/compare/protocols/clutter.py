"""Protocol `clutter`: targets among distractors, half covered, under moving shadows and changing light."""

from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np
import yaml

from aras_visual_servo import (ParameterError, Scenario, load_scenario, load_yaml, resolve_uri, robot_kinematics,
                               scenario_from_dict)
from ...sweep.plan import Start, SweepSettings, make_starts
from . import board as boards
from .base import Case, Protocol, register_protocol
from .clutter_scene import BOARD_M, CONDITIONS, LAMP, TURN_RAD, clutter
from .vit_vs import GOAL_M

STARTS, SEED, BOARD_SEED = 200, 16, 1
BALL = {"distance_m": [0.05, 0.2], "angle_rad": [0.0, 0.5]}
_GAINS = {axis: 1.5 for axis in ("xr", "yr", "zr", "rx", "ry", "rz")}
_MOMENTS = "xn", "yn", "an", "sx", "sy", "alpha"
#: Scheme -> what it changes in the scenario `vit_vs`.
SCHEMES = {
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
        if not 1 <= count <= STARTS:
            raise ParameterError(f"starts: found {count}, allowed 1 to {STARTS}")
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


def scene(mesh: Path, changes: Dict[str, Any]) -> Scenario:
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
    robot = scenario.robot
    kinematics = robot_kinematics(scenario.urdf_xml(), robot["base_link"], robot["tip_link"])
    settings = SweepSettings.from_scenario(scenario, kinematics, starts=count, method="random", seed=SEED)
    return make_starts(settings, scenario, kinematics)


def _sign():
    outlines = load_yaml(resolve_uri(SIGN))["outlines_m"]
    return boards.sign([SIGN_SCALE * np.array(outline) for outline in outlines], BOARD_M)


def _saved(folder, condition, number):
    path = folder / f"{condition}_{number}.yaml"
    if not path.exists():
        rng = np.random.default_rng([SEED, CONDITIONS.index(condition), number])
        path.write_text(yaml.safe_dump(_plain(clutter(condition, rng))), encoding="utf-8")
    return path.resolve()


def _plain(value):
    """The same of Python's own types, which YAML can write."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    return value.item() if isinstance(value, np.generic) else value
