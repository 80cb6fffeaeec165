"""Protocol `cns_affine`: 150 pairs of a goal and a start above a picture, from the publication of CNS."""

import math
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import numpy as np

from aras_visual_servo import Scenario, load_scenario, spatial
from ...sweep.plan import Start
from . import board as boards
from .base import Case, Protocol, register_protocol, spread, with_picture

SEED, STARTS = 2023, 150
#: Distance from the picture's middle [m], angle above the picture [deg], and largest turns about z, y, x [deg].
DISTANCE_M, GOAL_DEG, START_DEG = (0.6, 0.9), (70.0, 90.0), (60.0, 90.0)
GOAL_TURNS_DEG, START_TURNS_DEG = (15.0, 1e-7, 1e-7), (60.0, 5.0, 5.0)
#: A start is turned about its axis so that it differs by at most this from the goal [deg].
MOST_TURN_DEG = 37.0
DETECTORS, BOARD_SEED = ("orb", "akaze", "sift"), 2


@register_protocol("cns_affine")
class CnsAffine(Protocol):
    """150 goals and starts above a picture that fills the view of a camera 1.08 m above it.

    Poses, image (640 x 480, f 540 px), 600 steps at 50 Hz and CNS's metric are those of its program. Ours are the
    picture, drawn by a seeded program (another by --board), and the law (scenario `cns_affine`).
    """

    title = "CNS, affine scenes: 150 goals and starts above a picture"
    source = ("A. Chen, H. Yu, Y. Wang, R. Xiong, \"CNS: Correspondence encoded neural image servo policy\", ICRA "
              "2024; poses as in github.com/hhcaz/CNS (BenchmarkEnvAffine)")
    metric, published_starts, takes = "cns", STARTS, ("board",)

    def cases(self, folder: Path, count: int, board: Optional[str] = None) -> List[Case]:
        path = boards.saved(folder, board, BOARD_SEED)
        cases = []
        for detector in DETECTORS:
            scenario = with_picture(load_scenario("cns_affine", {"vision.matches": {"detector": detector}}), path)
            cases.append(Case(detector, scenario, planned(scenario, count), {"detector": detector.upper()}))
        return cases


def pairs(count: int = STARTS) -> Tuple[np.ndarray, np.ndarray]:
    """(X_WCg, X_WC), (count, 4, 4) each: `count` of the 150 goals and starts of the protocol, optical frames.

    Both look at the middle of the picture. A pair that is closer than 2 mm and 1 degree is drawn again.
    """
    rng, goals, starts = np.random.RandomState(SEED), [], []
    while len(goals) < STARTS:
        goal = drawn(rng, DISTANCE_M, GOAL_DEG, GOAL_TURNS_DEG)
        start = drawn(rng, DISTANCE_M, START_DEG, START_TURNS_DEG)
        turn = spatial.rotation_vector(start[:3, :3].T @ goal[:3, :3])[2]
        most = math.radians(MOST_TURN_DEG)
        if abs(turn) > most:
            back = turn - most if turn >= 0.0 else turn + most
            start[:3, :3] = start[:3, :3] @ spatial.rotation(np.array([0.0, 0.0, back]))
        if apart(goal, start):
            goals.append(goal)
            starts.append(start)
    chosen = spread(count, STARTS)
    return np.array(goals)[chosen], np.array(starts)[chosen]


def planned(scenario: Scenario, count: int) -> List[Start]:
    """The starts, list of `Start`, each with a goal of its own; their id is that of the protocol, from 1 to 150."""
    return starts_of(scenario, spread(count, STARTS), *pairs(count),
                     lambda _, X_WCg: {"experiment.z_star_m": float(np.linalg.norm(X_WCg[:3, 3]))})


def starts_of(scenario: Scenario, indices: Sequence[int], goals: np.ndarray, starts: np.ndarray,
              parameters: Callable[[int, np.ndarray], Dict[str, Any]]) -> List[Start]:
    """List of `Start` from camera poses above the plane z = 0, each with a goal of its own.

    Args: indices: of the pairs in the protocol, from 0; an id counts from 1.  goals, starts: X_WC, (n, 4, 4).
        parameters: function of id and X_WC at the goal, gives what the run's scenario has for itself (dict).
    """
    kinematics = scenario.kinematics(calibrated=False)

    def joints(X_WC):
        return kinematics.by_name(kinematics.coordinates(X_WC))

    found = []
    for index, X_WCg, X_WC in zip(indices, goals, starts):
        normal = (X_WCg[:3, :3].T @ [0.0, 0.0, -1.0]).tolist()  # of the plane, away from the camera
        goal = {"joints": joints(X_WCg), "target_normal_C": normal}
        found.append(Start(index + 1, joints(X_WC), {}, parameters(index + 1, X_WCg), "", goal))
    return found


def apart(goal: np.ndarray, start: np.ndarray) -> bool:
    """Whether two poses differ by 2 mm or 1 degree, as those of a pair have to."""
    return (spatial.rotation_angle(goal[:3, :3].T @ start[:3, :3]) >= math.radians(1.0)
            or bool(np.linalg.norm(goal[:3, 3] - start[:3, 3]) >= 0.002))


def drawn(rng: np.random.RandomState, distance_m: Tuple[float, float], above_deg: Tuple[float, float],
          turns_deg: Sequence[float]) -> np.ndarray:
    """X_WC, (4, 4), that looks at the origin from above: the order of the draws is that of the protocol.

    Args: ranges of the distance [m] and of the angle above the table; largest turns about z, y, x [deg].
    """
    distance = rng.uniform(*distance_m)
    around = rng.uniform(-np.pi, np.pi)
    z = rng.uniform(*np.sin(np.radians(above_deg)))
    above = math.asin(z)
    place = np.array([math.cos(above) * math.cos(around), math.cos(above) * math.sin(around), z])
    y = np.array([math.sin(above) * math.cos(around), math.sin(above) * math.sin(around), -math.cos(above)])
    R = np.stack([np.cross(y, -place), y, -place], axis=1)
    for axis, most in zip(np.eye(3)[::-1], turns_deg):
        R = R @ spatial.rotation(axis * math.radians(rng.uniform(-most, most)))
    return spatial.transform(R, distance * place)
