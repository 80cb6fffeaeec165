"""A posture to work from: the camera looks down and past the arm, and no twist of it is nearly lost. No ROS."""

from typing import Callable, List, Optional, Sequence, Tuple

import numpy as np

from .kinematics import Kinematics, RobotKinematics
from .settings import InverseSettings

#: Postures drawn, steps of Newton's method for each, and the largest step of a joint [m, rad].
GUESSES, STEPS, MAX_STEP = 150, 30, 0.3
#: The optical axis is within this angle of straight down [rad].
DOWN_RAD = 1e-6
#: A posture is singular where the least singular value is below this; `servo.inverse` begins to damp there.
SINGULAR = InverseSettings.singular_value_threshold
#: How far out from the base's axis the camera should be, in parts of its height above the target.
OUT = 0.9
#: The view: half of its width and height at a distance of 1 m, as of a camera of 81 by 65 degrees. [-]
VIEW = np.array([0.86, 0.64])
#: Half the thickness of an arm, and points on the line from one joint to the next. [m], [-]
THICKNESS_M, ON_LINE = 0.07, 6
#: A joint nearer to its limit than this part of its range counts as near it.
NEAR_LIMIT = 0.2


def least_singular_value(kinematics: RobotKinematics, q: np.ndarray,
                         length_m: float = InverseSettings.length_m) -> float:
    """Returns the least singular value of the Jacobian at q, (n,), linear rows divided by length_m.

    An arm of n < 6 joints has n singular values: the twists that it never had do not count.
    """
    J = kinematics.jacobian(q) / np.array([length_m] * 3 + [1.0] * 3)[:, None]
    return float(np.linalg.svd(J, compute_uv=False)[-1])


def points_of(urdf_xml: str, base_link: str, links: Sequence[str],
              joint_names: Sequence[str]) -> Callable[[np.ndarray], np.ndarray]:
    """Returns a function: q, (n,) in the order of joint_names -> points along the arm in the base, (k, 3) [m].

    Args: links: those that the joints of the chain move, from the base on.
    """
    chains = [Kinematics(urdf_xml, base_link, link) for link in links]
    picked = [[list(joint_names).index(name) for name in chain.joint_names] for chain in chains]
    parts = np.linspace(0.0, 1.0, ON_LINE)[:, None]

    def points(q: np.ndarray) -> np.ndarray:
        ends: List[np.ndarray] = [np.zeros(3)] + [chain.pose(q[some])[:3, 3] for chain, some in zip(chains, picked)]
        return np.concatenate([start + parts * (end - start) for start, end in zip(ends, ends[1:])])
    return points


def in_view(X_BC: np.ndarray, points: np.ndarray, depth_m: float) -> bool:
    """Whether the camera sees one of the points, (k, 3) in the base, not farther than depth_m and a half more."""
    seen = (points - X_BC[:3, 3]) @ X_BC[:3, :3]
    z = seen[:, 2]
    inside = np.all(np.abs(seen[:, :2]) < z[:, None] * VIEW + THICKNESS_M, axis=1)
    return bool(np.any(inside & (z > THICKNESS_M) & (z < 1.5 * depth_m)))


def find_home(kinematics: RobotKinematics, above_m: float = 0.0, near: Optional[np.ndarray] = None,
              points: Optional[Callable[[np.ndarray], np.ndarray]] = None) -> Tuple[Optional[np.ndarray], float]:
    """Searches a posture in which the camera looks along -z of the base, far from singularities and limits.

    Args:
        above_m: height in the base above which the camera should be; and OUT of it is how far out it should be, so that
            the view does not show the base.
        near: (n,) posture to begin with, which is only turned until the camera looks down; None tries GUESSES postures,
            the same in every call, and takes the best.
        points: as of `points_of`: the view should not show them within the distance above_m.
    Returns:
        (q, least singular value): (n,) within the limits, or (None, 0) where no posture looks down.
    """
    lower = np.where(np.isfinite(kinematics.lower), kinematics.lower, -np.pi)
    upper = np.where(np.isfinite(kinematics.upper), kinematics.upper, np.pi)
    rng = np.random.default_rng(0)
    guesses = rng.uniform(lower, upper, (GUESSES, len(lower))) if near is None else np.array([near])
    found = [q for q in (_looking_down(kinematics, np.clip(q, lower, upper), lower, upper) for q in guesses)
             if q is not None]
    if not found:
        return None, 0.0
    places = np.array([kinematics.pose(q)[:3, 3] for q in found])
    reach_m = max(float(np.max(np.hypot(places[:, 0], places[:, 1]))), 1e-9)

    def score(i: int) -> float:
        q, place = found[i], places[i]
        room = np.minimum(q - lower, upper - q) / (upper - lower)
        out = np.hypot(place[0], place[1])
        return (least_singular_value(kinematics, q) * float(np.prod(np.minimum(1.0, room / NEAR_LIMIT)))
                * min(1.0, out / max(OUT * above_m, 0.3 * reach_m)) * (1.0 if place[2] >= above_m else 0.1)
                * (0.02 if points is not None and in_view(kinematics.pose(q), points(q), above_m) else 1.0))
    best = found[max(range(len(found)), key=score)]
    return best, least_singular_value(kinematics, best)


def _looking_down(kinematics, q, lower, upper):
    """The posture near q in which the optical axis is -z of the base; None if the search ends elsewhere."""
    for _ in range(STEPS):
        down = -kinematics.pose(q)[2, :3]  # in the camera
        angle = np.arctan2(np.hypot(down[0], down[1]), down[2])
        if angle < DOWN_RAD:
            return q
        turn = np.array([-down[1], down[0]]) * (angle / max(np.hypot(down[0], down[1]), 1e-12))
        J = kinematics.jacobian(q)[3:5]
        step = J.T @ np.linalg.solve(J @ J.T + 1e-6 * np.eye(2), turn)
        q = np.clip(q + step * min(1.0, MAX_STEP / max(np.max(np.abs(step)), 1e-12)), lower, upper)
    return None
