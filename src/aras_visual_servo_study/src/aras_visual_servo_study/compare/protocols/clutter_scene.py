"""What stands in the way in the protocol `clutter`: solids and lights about a board, drawn by a seeded program.

The board lies in the plane z = 0, its middle at the origin, turned so that its width is along y of the world. The
camera looks down on it.
"""

import math
from typing import Any, Dict, List, Tuple

import numpy as np

#: Width and height of the board [m], how it is turned, half its extent along x and y of the world [m], and how many
#: distractors stand on and beside it.
BOARD_M, TURN_RAD, HALF_M, DISTRACTORS = (0.8, 0.6), -0.5 * math.pi, (0.3, 0.4), 14
#: Share of the board's area that is covered.
COVERED = 0.5
#: The lamp of the scene, of a steady light; `light` moves it.
LAMP = {"name": "lamp", "type": "directional", "direction": [-0.5, -0.3, -1.0], "intensity": 0.6}
CONDITIONS = ("plain", "distractors", "covered", "shadows", "light", "all")


def clutter(condition: str, rng: np.random.Generator) -> Dict[str, List[Dict[str, Any]]]:
    """{"solids": [...], "lights": [...]} of a condition, entries as in the section `sim.scene`."""
    solids, lights = [], []
    if condition in ("distractors", "all"):
        solids += distractors(rng)
    if condition in ("covered", "all"):
        solids += cover(rng)
    if condition in ("shadows", "all"):
        solids += passers(rng)
    if condition in ("light", "all"):
        more, lights = moving_light(rng)
        solids += more
    return {"solids": solids, "lights": lights}


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
