"""Pose of points of a plane from their image: homography, then least squares by Gauss-Newton (docs/theory.md T29).

    seen = PlanarPoints(points_T)               # (N, 3) in the target's frame T, N >= 4, in one plane
    X_CT = seen.find(xy)                        # from one view, xy (N, 2)
    X_CT, residual, condition = seen.follow(X_CT, xy)
"""

from math import isfinite
from typing import Any, Tuple

import numpy as np

from ...ground.errors import DegenerateFeature, NotFiniteError
from ...spatial import exponential

#: Largest residual of a coordinate at which a pose is accepted [-]: four pixels at f = 200 px; the noise of corners is
#: below half a pixel.
MAX_LEFT = 0.02
#: Iteration ends after a step shorter than this [m, rad]: the error that is left is about the square of the step.
SHORT, MAX_STEPS = 1e-5, 20


class PlanarPoints:
    """Points of a plane, not all on a line.

    Attributes: points_T: (N, 3) [m].  max_followed: largest residual of a pose that `follow` may be taken at.
    """

    max_followed = MAX_LEFT

    def __init__(self, points_T: np.ndarray) -> None:
        """Raises DegenerateFeature: fewer than four, or all on a line."""
        self.points_T = np.asarray(points_T, dtype=float)
        if len(self.points_T) < 4:
            raise DegenerateFeature(f"pose of the points: found {len(self.points_T)}, needed at least 4")
        self._middle = self.points_T.mean(axis=0)
        _, sigmas, Vt = np.linalg.svd(self.points_T - self._middle)
        if not sigmas[1] > 1e-3 * sigmas[0]:
            raise DegenerateFeature("pose of the points: they lie on a line")
        self._axes = np.stack([Vt[0], Vt[1], np.cross(Vt[0], Vt[1])], axis=1)  # of the plane, in T
        self._flat = (self.points_T - self._middle) @ self._axes[:, :2]

    @staticmethod
    def measured(features: Any) -> np.ndarray:
        """(N, 2) of an image. Raises DegenerateFeature without points, NotFiniteError."""
        if not 0 < len(features.point_x) == len(features.point_y):
            raise DegenerateFeature("pose of the points: none in this view")
        xy = np.array([features.point_x, features.point_y]).T
        if not isfinite(float(xy.sum())):
            raise NotFiniteError(f"points: found {xy.tolist()}, allowed finite numbers")
        return xy

    def improve(self, X_CT: np.ndarray, xy: np.ndarray) -> Tuple[np.ndarray, float, float, float]:
        """One step of `gauss_newton`, whose residuals are those of the coordinates."""
        self._check_number(xy)
        X, Y, Z = X_CT[:3, :3] @ self.points_T.T + X_CT[:3, 3:]
        if not Z.min() > 0.0:
            raise DegenerateFeature("pose of the points: behind the camera")
        over_Z = 1.0 / Z
        x, y = X * over_Z, Y * over_Z
        L, xx, mixed, yy = np.zeros((2 * len(Z), 6)), x * x, x * y, y * y  # (T26)
        of_x, of_y = L[0::2].T, L[1::2].T
        of_x[0] = of_y[1] = -over_Z
        of_x[2], of_x[3], of_x[4], of_x[5] = x * over_Z, mixed, -1.0 - xx, y
        of_y[2], of_y[3], of_y[4], of_y[5] = y * over_Z, 1.0 + yy, -mixed, -x
        return gauss_newton(X_CT, L, (xy - np.array([x, y]).T).ravel())

    def _check_number(self, xy):
        if xy.shape != self._flat.shape:
            raise DegenerateFeature(f"pose of the points: found {len(xy)} points in this view, {len(self._flat)} known")

    def follow(self, X_CT: np.ndarray, xy: np.ndarray) -> Tuple[np.ndarray, float, float]:
        """Gauss-Newton steps from a pose nearby; where they find no pose, `find` looks for one without a first guess.

        Returns: (X_CT, residual, condition number).
        """
        try:
            found = self._descend(X_CT, xy)
        except DegenerateFeature:
            found = None
        if found is not None and found[1] < self.max_followed:
            return found
        return self._descend(self.find(xy), xy)

    def _descend(self, X_CT, xy):
        for _ in range(MAX_STEPS):
            X_CT, residual, condition, length = self.improve(X_CT, xy)
            if length < SHORT:
                break
        return X_CT, residual, condition

    def find(self, xy: np.ndarray) -> np.ndarray:
        """X_CT from a view alone.

        The first guesses are the pose of the homography and its mirror image in the line of sight. From afar both
        explain a view nearly equally well; the better one is returned.
        Raises DegenerateFeature: no pose of these points explains this view.
        """
        best, least = None, MAX_LEFT
        for X in self._guesses(xy):
            try:
                X, residual, _ = self._descend(X, xy)
            except (DegenerateFeature, np.linalg.LinAlgError):
                continue
            if residual < least:
                best, least = X, residual
        if best is None:
            raise DegenerateFeature("pose of the points: no pose explains this view")
        return best

    def _guesses(self, xy):
        self._check_number(xy)
        H = homography(self._flat, xy)
        H *= 2.0 / (np.linalg.norm(H[:, 0]) + np.linalg.norm(H[:, 1])) * (1.0 if H[2, 2] > 0.0 else -1.0)
        sight = H[:, 2] / np.linalg.norm(H[:, 2])
        for mirror in (np.eye(3), np.eye(3) - 2.0 * np.outer(sight, sight)):
            a, b = mirror @ H[:, 0], mirror @ H[:, 1]
            U, _, Vt = np.linalg.svd(np.stack([a, b, np.cross(a, b)], axis=1))
            X = np.eye(4)
            X[:3, :3] = U @ np.diag([1.0, 1.0, np.linalg.det(U @ Vt)]) @ Vt @ self._axes.T
            X[:3, 3] = H[:, 2] - X[:3, :3] @ self._middle
            yield X


def gauss_newton(X_CT: np.ndarray, L: np.ndarray, left: np.ndarray) -> Tuple[np.ndarray, float, float, float]:
    """One Gauss-Newton step of a pose, by the interaction matrix L, (k, 6), of its measures and their residuals, (k,).

    Returns: (X_CT, largest residual before the step, condition number of L, length of the step).
    Raises DegenerateFeature: L is singular.
    """
    U, sigmas, Vt = np.linalg.svd(L, full_matrices=False)
    if not sigmas[-1] > 1e-6 * sigmas[0]:
        raise DegenerateFeature("pose of the target: this view does not determine it")
    twist = ((left @ U) / sigmas) @ Vt
    condition, length = float(sigmas[0] / sigmas[-1]), float(twist @ twist) ** 0.5
    return exponential(-twist) @ X_CT, float(np.abs(left).max()), condition, length


def homography(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """H, (3, 3), of unit norm, with b ~ H a: a, b (N, 2), N >= 4 (direct linear transform, both sides normalised).

    References: R. Hartley and A. Zisserman, Multiple View Geometry in Computer Vision, 2nd ed., 2004, algorithm 4.2.
    """
    (a, T_a), (b, T_b) = _normalised(a), _normalised(b)
    rows = np.zeros((2 * len(a), 9))
    rows[0::2, 0:3] = rows[1::2, 3:6] = a
    rows[0::2, 6:9], rows[1::2, 6:9] = -b[:, :1] * a, -b[:, 1:2] * a
    H = np.linalg.inv(T_b) @ np.linalg.svd(rows)[2][-1].reshape(3, 3) @ T_a
    return H / np.linalg.norm(H)


def _normalised(points):
    """Homogeneous points about their middle, at a mean distance of sqrt(2), and the transform (3, 3) that did it."""
    middle = points.mean(axis=0)
    scale = np.sqrt(2.0) / max(np.linalg.norm(points - middle, axis=1).mean(), 1e-12)
    T = np.array([[scale, 0.0, -scale * middle[0]], [0.0, scale, -scale * middle[1]], [0.0, 0.0, 1.0]])
    return np.concatenate([points, np.ones((len(points), 1))], axis=1) @ T.T, T


def corners_clockwise(outline: np.ndarray) -> np.ndarray:
    """Corners (N, 3) of an outline (N, 2) in the target's plane z = 0, clockwise as its viewers see them [m]."""
    outline = np.asarray(outline, dtype=float)
    x, y = outline.T
    if np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) > 0.0:
        outline = outline[::-1]
    return np.concatenate([outline, np.zeros((len(outline), 1))], axis=1)


def find_corners(outline: np.ndarray, xy: np.ndarray) -> Tuple[PlanarPoints, np.ndarray]:
    """Find which corner of an outline each point is, and the pose.

    Args: outline: (N, 2) in the target's plane z = 0 [m].  xy: (N, 2), its corners seen, clockwise on the screen.
    Returns: (`PlanarPoints` in the order of xy, X_CT). A symmetric target has several such poses; one is returned.
    Raises: DegenerateFeature: another number of corners, or no pose explains the view.
    """
    corners = corners_clockwise(outline)
    if len(xy) != len(corners):
        raise DegenerateFeature(f"pose of the points: found {len(xy)} in this view, the target has {len(corners)} "
                                "corners")
    best, least = None, MAX_LEFT
    for first in range(len(corners)):
        points = PlanarPoints(np.roll(corners, -first, axis=0))
        try:
            X_CT = points.find(xy)
            _, residual, _, _ = points.improve(X_CT, xy)
        except DegenerateFeature:
            continue
        if residual < least and X_CT[2, 2] < 0.0:  # the target's face looks at the camera
            best, least = (points, X_CT), residual
    if best is None:
        raise DegenerateFeature("pose of the points: no pose of the known corners explains this view")
    return best
