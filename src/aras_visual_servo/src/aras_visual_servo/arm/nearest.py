"""Inverse kinematics within limits: the joint positions near given ones that bring the camera nearest to a pose.

`arm.reach.reach` decides whether any posture reaches a pose. This module finds how near the camera comes without a
change of posture, as in a servo. It minimises the weighted pose error by the method of Levenberg and Marquardt.
Joints at their limits are kept there (projected gradient), and the damping grows until a step brings the camera nearer,
so that a stretched arm comes to rest.

Reference: T. Sugihara, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method, IEEE T-RO 27(5),
2011.
"""

from typing import NamedTuple, Optional, Tuple

import numpy as np

from ..spatial import rotation_vector
from .kinematics import RobotKinematics

#: Makes translations comparable with rotations [m]. It is large: the camera rather stays away from where it should be
#: than looks elsewhere, which would take the target out of view.
LENGTH_M = 3.0
SCALE = np.array([1.0 / LENGTH_M] * 3 + [1.0] * 3)
#: The search ends where the square of the scaled error is below this: some micrometres.
REACHED = 1e-12
#: Factors of the damping after a step that came nearer and after one that did not; its bounds, as parts of the mean
#: squared column of the Jacobian.
EASIER, HARDER, LEAST, MOST = 0.2, 4.0, 1e-9, 1e4
#: Largest step of a joint [m, rad]. The search ends where a step is smaller than SETTLED, or the error shrinks by less
#: than SLOW of itself.
STEP, SETTLED, SLOW = 0.3, 1e-7, 1e-4


class Nearest(NamedTuple):
    """Attributes: q: (n,) joint positions.  missing: (6,) displacement from the camera there to the pose, in the frame
    of that camera, [p; theta u] [m; rad], without free directions."""

    q: np.ndarray
    missing: np.ndarray

    @property
    def sizes(self) -> Tuple[float, float]:
        """(distance [m], angle [rad]) that is missing."""
        return float(np.linalg.norm(self.missing[:3])), float(np.linalg.norm(self.missing[3:]))

    def within(self, position_m: float, rotation_rad: float) -> bool:
        """Returns whether no more than this is missing."""
        missing_m, missing_rad = self.sizes
        return missing_m <= position_m and missing_rad <= rotation_rad


def nearest(kinematics: RobotKinematics, X_BC: np.ndarray, q: np.ndarray, lower: np.ndarray, upper: np.ndarray,
            rows: Optional[np.ndarray] = None, steps: int = 40) -> Nearest:
    """Returns the `Nearest` joint positions that a search from q, (n,), finds.

    Args:
        X_BC: (4, 4) pose wanted.  lower, upper: (n,) limits of the joints.
        rows: (r, 6) displacements of the camera that count, orthonormal, translations divided by LENGTH_M; None: all.
        steps: of the search, at most.
    """
    q, damping = np.minimum(np.maximum(q, lower), upper), 1e-4
    missing, error, cost, J = _at(kinematics, X_BC, q, rows)
    for _ in range(steps):
        gradient = J.T @ error
        free = ~((q <= lower) & (gradient < 0.0) | (q >= upper) & (gradient > 0.0))
        J_free = J[:, free]
        size = float(np.sum(J_free * J_free)) / max(1, J_free.shape[1])
        if size == 0.0:
            break
        step = np.zeros_like(q)
        step[free] = np.linalg.solve(J_free.T @ J_free + damping * size * np.eye(J_free.shape[1]), gradient[free])
        step *= min(1.0, STEP / max(float(np.abs(step).max()), 1e-12))
        tried = np.minimum(np.maximum(q + step, lower), upper)
        new_missing, new_error, new_cost, new_J = _at(kinematics, X_BC, tried, rows)
        if new_cost >= cost:
            damping *= HARDER
            if damping > MOST:
                break
            continue
        done = np.abs(tried - q).max() < SETTLED or new_cost > (1.0 - SLOW) * cost
        q, missing, error, cost, J = tried, new_missing, new_error, new_cost, new_J
        damping = max(LEAST, damping * EASIER)
        if done or cost < REACHED:
            break
    return Nearest(q, missing)


def _at(kinematics, X_BC, q, rows):
    """Returns ((6,) pose error at q, its scaled rows, the scaled square, the scaled Jacobian)."""
    X = kinematics.pose(q)
    R_T = X[:3, :3].T
    missing = np.concatenate([R_T @ (X_BC[:3, 3] - X[:3, 3]), rotation_vector(R_T @ X_BC[:3, :3])])
    J = SCALE[:, None] * kinematics.jacobian(q)
    if rows is not None:
        missing = (rows.T @ (rows @ (SCALE * missing))) / SCALE
        J = rows @ J
    scaled = SCALE * missing
    return missing, scaled if rows is None else rows @ scaled, float(scaled @ scaled), J
