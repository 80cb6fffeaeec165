"""Protocol `vit_vs`: a camera in front of a poster, from the publication of ViT-VS."""

import math
from pathlib import Path
from typing import List, Optional

import numpy as np

from aras_visual_servo import Scenario, load_scenario
from ...sweep.plan import Start
from . import board as boards
from .base import Case, Protocol, register_protocol, spread, with_picture

DETECTORS, CONDITIONS = ("orb", "akaze", "sift"), ("plain", "perturbed")
SEED, STARTS, CIRCLES, RADIUS_M, ROLL_RAD = 41, 500, 4, 0.08, math.radians(120.0)
GOAL_M, BOX_M, REFERENCE_M = (0.0, 0.0, 0.61), (1.2, 1.2, 0.3), (0.0, 0.0, 0.01)
#: Seeds of our own board and of its perturbed copies.
BOARD_SEED, PERTURBED_SEED = 1, 489
#: What the publication gives for its classical detectors (SIFT, ORB and AKAZE with the plain matrix of points).
PUBLISHED = {"plain": 0.896, "perturbed": 0.584}
WHOSE = "classical detectors, Scherl et al. 2025"


@register_protocol("vit_vs")
class VitVs(Protocol):
    """500 starts about a poster of 0.8 x 0.6 m, with keypoints matched to those of the goal image.

    Image, starts, number of iterations, success and abort are those published. Ours are: the boards (theirs by
    --board), 10 images a second of simulated time with a gain of 3/s, the law (scenario `vit_vs`), and that a camera
    which has converged stands still until its 300th iteration instead of going on.
    """

    title = "ViT-VS: 500 starts in front of a textured board, plain and perturbed"
    source = ("A. Scherl, S. Thalhammer, B. Neuberger, W. Woeber, J. Garcia-Rodriguez, \"ViT-VS: On the applicability "
              "of pretrained vision transformer features for generalizable visual servoing\", 2025, arXiv 2503.04545; "
              "starts and perturbations as in github.com/AlessandroScherl/ViT-VS")
    metric, published_starts, takes = "vit_vs", STARTS, ("board",)

    def cases(self, folder: Path, count: int, board: Optional[str] = None) -> List[Case]:
        picture, perturbed = _pictures(folder, board, spread(count, STARTS))
        cases = []
        for condition in CONDITIONS:
            for detector in DETECTORS:
                scenario = with_picture(load_scenario("vit_vs", {"vision.matches": {"detector": detector}}), picture)
                starts = planned(scenario, count)
                if condition == "perturbed":
                    starts = [Start(start.id, start.joints, start.offset, {"picture": str(perturbed[start.id])})
                              for start in starts]
                cases.append(Case(f"{detector}_{condition}", scenario, starts,
                                  {"detector": detector.upper(), "board": condition}, (PUBLISHED[condition], WHOSE)))
        return cases


def camera_poses(count: int = STARTS) -> np.ndarray:
    """X_WC, (count, 4, 4) of the optical frame at the starts, `count` of the 500 of the protocol.

    Places are uniform in the box about the goal. Each camera looks at a point on one of four circles about the middle
    of the board; its roll goes evenly from -120 to 120 degrees along the starts of a circle.
    """
    rng, each = np.random.RandomState(SEED), STARTS // CIRCLES
    goal, half = np.array(GOAL_M), 0.5 * np.array(BOX_M)
    places = rng.uniform(goal - half, goal + half, size=(STARTS, 3))
    poses = np.tile(np.eye(4), (STARTS, 1, 1))
    for circle in range(CIRCLES):
        angles = rng.uniform(-math.pi, math.pi, size=each)
        for k, (angle, roll) in enumerate(zip(angles, np.linspace(-ROLL_RAD, ROLL_RAD, each))):
            i, radius = circle * each + k, RADIUS_M * (circle + 1)
            look_at = np.array(REFERENCE_M) + [radius * math.cos(angle), radius * math.sin(angle), 0.0]
            z = (look_at - places[i]) / np.linalg.norm(look_at - places[i])
            x = np.cross(z, [1.0, 0.0, 0.0])  # without roll, the image's upper edge is on the side of +x of the world
            x /= np.linalg.norm(x)
            y = np.cross(z, x)
            poses[i, :3, :3] = np.stack([x, y, z], axis=1) @ _about_z(roll)
            poses[i, :3, 3] = places[i]
    return poses[spread(count, STARTS)]


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The starts, list of `Start`; their id is that of the protocol, from 1 to 500."""
    kinematics = scenario.kinematics(calibrated=False)
    return [Start(index + 1, kinematics.by_name(kinematics.coordinates(X_WC)))  # type: ignore[attr-defined]
            for index, X_WC in zip(spread(count, STARTS), camera_poses(count))]


def _about_z(angle):
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _pictures(folder, board, indices):
    """(path of the board, {id of a start: path of its perturbed copy}); files that are there already are taken."""
    path = boards.saved(folder, board, BOARD_SEED)
    picture, copies = boards.load(path), {}
    for index in indices:
        copies[index + 1] = copy = folder / f"board_{index + 1}.png"
        if not copy.exists():
            boards.save(copy, boards.perturbed(picture, [PERTURBED_SEED, index + 1]))
    return path, {key: copy.resolve() for key, copy in copies.items()}
