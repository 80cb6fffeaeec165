"""Pose of points whose depths are seen, too: absolute orientation (docs/theory.md T75).

    seen = SolidPoints(points_T)                # (N, 3) in the target's frame T, N >= 3, not on a line
    X_CT, residual, condition = seen.follow(X_CT, points_C)
"""

from typing import Any, Tuple

import numpy as np

from ...ground.errors import DegenerateFeature
from ..points import depths_in_image, points_seen

#: Largest distance of a point from where the pose puts it, over its own distance, at which a pose is accepted [-]: the
#: depths of a cheap RGB-D camera are good to some 0.01.
MAX_LEFT = 0.03
#: Second singular value of the points about their middle over the first: below this they lie on a line.
LEAST_SPREAD = 1e-3


class SolidPoints:
    """Points anywhere in space, not all on a line; it has the functions of `PlanarPoints`.

    Attributes: points_T: (N, 3) [m].  max_followed: largest residual of a pose that `follow` may be taken at.
    """

    max_followed = MAX_LEFT

    def __init__(self, points_T: np.ndarray) -> None:
        """Raises DegenerateFeature: fewer than three, or all on a line."""
        self.points_T = np.asarray(points_T, dtype=float)
        if len(self.points_T) < 3:
            raise DegenerateFeature(f"pose from depth: found {len(self.points_T)} points, needed at least 3")
        self._middle = self.points_T.mean(axis=0)
        sigmas = np.linalg.svd(self.points_T - self._middle, compute_uv=False)
        if not sigmas[1] > LEAST_SPREAD * sigmas[0]:
            raise DegenerateFeature("pose from depth: the points lie on a line")
        self._condition = float(sigmas[0] / sigmas[1])

    @staticmethod
    def measured(features: Any) -> np.ndarray:
        """(N, 3) points of an image in the camera frame [m]. Raises DegenerateFeature: a depth is missing."""
        Z = depths_in_image(features)
        x, y = np.array(points_seen(features)).T
        return np.stack([x * Z, y * Z, Z], axis=1)

    def find(self, points_C: np.ndarray) -> np.ndarray:
        """X_CT that puts the points where they are seen, with the least squares of distances.

        Raises DegenerateFeature: another number of points.
        References: K. Arun, T. Huang, S. Blostein, IEEE PAMI 9(5), 1987; S. Umeyama, IEEE PAMI 13(4), 1991.
        """
        if points_C.shape != self.points_T.shape:
            raise DegenerateFeature(f"pose from depth: found {len(points_C)} points in this view, "
                                    f"{len(self.points_T)} known")
        middle = points_C.mean(axis=0)
        U, _, Vt = np.linalg.svd((points_C - middle).T @ (self.points_T - self._middle))
        X = np.eye(4)
        X[:3, :3] = U @ np.diag([1.0, 1.0, np.linalg.det(U) * np.linalg.det(Vt)]) @ Vt
        X[:3, 3] = middle - X[:3, :3] @ self._middle
        return X

    def follow(self, X_CT: np.ndarray, points_C: np.ndarray) -> Tuple[np.ndarray, float, float]:
        """(X_CT, residual, condition number) as of `PlanarPoints`; one view is enough, so X_CT is not used."""
        X_CT = self.find(points_C)
        left = np.linalg.norm(self.points_T @ X_CT[:3, :3].T + X_CT[:3, 3] - points_C, axis=1)
        return X_CT, float((left / np.linalg.norm(points_C, axis=1)).max()), self._condition
