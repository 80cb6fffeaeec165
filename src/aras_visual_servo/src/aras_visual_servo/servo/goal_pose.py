"""The pose error that the feature errors imply at the goal (T60), and its undetermined part (T73)."""

from functools import cached_property
from math import cos, nan, sin
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from ..arm.nearest import SCALE
from ..features.base import FeatureSet, View
from ..features.edges import edge_changes, whole
from ..features.interaction import plane_from_pose
from ..features.points import depths_in_image
from ..ground.errors import DegenerateFeature
from ..ground.types import Reference
from ..laws.base import MAX_CONDITION

TILT_COLUMNS, OTHER_COLUMNS = [3, 4], [0, 1, 2, 5]
#: A motion counts as seen when the features change by more than this part of what they change by with others.
SEEN = 1e-4
#: ... and is named when it has at least this part of a motion that is not seen.
NAMED = 0.3
#: Makes translations comparable with rotations where the depth is not asked for [m].
UNIT_M = 0.5
MOTIONS = ("translation along x", "translation along y", "translation along the optical axis", "rotation about x",
           "rotation about y", "rotation about the optical axis")
#: The same view after another turn: the points differ by no more than this part of their distance from their middle.
ALIKE = 0.02


class LeftOpen(NamedTuple):
    """Part of the displacement from a goal that no number of images determines (T73).

    Attributes:
        edge_stddev: of the taught view; NaN: not known.
        edges: (6, 6) covariance of the displacement for an `edge_stddev` of 1.
        of_features: (k,) standard deviation of each feature for an `edge_stddev` of 1; empty: not known.
        planes: (p, 6, 6), each from a displacement to what it would be if the target's plane lay otherwise, within
            the tolerance; the first is the identity.
    """

    edge_stddev: float = nan
    edges: np.ndarray = np.zeros((6, 6))
    of_features: np.ndarray = np.zeros(0)
    planes: np.ndarray = np.eye(6)[None]


class GoalPose:
    """From the error of the features to the displacement of the camera from the goal, (6,), [p_CgC; theta u] (T60)."""

    def __init__(self, features: FeatureSet, reference: Reference, point_depth: str = "plane",
                 normal_rad: float = 0.0) -> None:
        """Args: point_depth: of followed points (`LawSetup`).  normal_rad: by how much the target's plane may be
        inclined otherwise than it was taught."""
        self._features, self._sees_tilt, self._normal_rad = features, features.sees_tilt, normal_rad
        self._view = self._L = self._inverse = self._with_tilt = None  # type: Any
        if reference.view is None or reference.plane_C is None:
            return
        try:
            self._depths = 1.0 / depths_in_image(reference.view) if point_depth == "image" else None
            self._view, self._plane = whole(reference.view), reference.plane_C
            self._L = L = self._matrix(features, self._plane)
        except DegenerateFeature:
            return
        self._inverse = _inverse(L, self._sees_tilt)
        if self._inverse is not None and not self._sees_tilt:
            of_tilt = np.eye(6)[:, TILT_COLUMNS] - self._inverse @ L[:, TILT_COLUMNS]
            self._with_tilt = np.hstack([self._inverse, of_tilt])

    def _matrix(self, features, plane):
        return features.matrix(View(self._view, plane, None, self._depths))

    @cached_property
    def _told_by(self):
        """(features, their matrix, its inverse) that tell the pose: the points, where the law measures it."""
        if self._L is None and self._view is not None and len(self._view.point_x):
            features = FeatureSet([f"points{len(self._view.point_x)}"])
            try:
                L = self._matrix(features, self._plane)
            except DegenerateFeature:
                return self._features, None, None
            return features, L, _inverse(L, self._sees_tilt)
        return self._features, self._L, self._inverse

    def by_views(self, views: Sequence[Any]) -> Optional[np.ndarray]:
        """Returns the displacements of the camera, (m, 6), by views of the goal; None where they cannot be told."""
        features, _, inverse = self._told_by
        if inverse is None:
            return None
        values = np.array([features.values(View(view)) for view in views])
        return (values - values[0]) @ inverse.T

    @cached_property
    def left_open(self) -> LeftOpen:
        """Returns the part of the pose that images do not determine. A law that measures the pose uses the points."""
        view = self._view
        if view is None:
            return LeftOpen()
        nothing, (features, L, inverse) = LeftOpen(view.edge_stddev), self._told_by
        if inverse is None:
            return nothing
        try:
            changes = edge_changes(features, view)
        except DegenerateFeature:
            return nothing
        if not np.isfinite(changes).all():
            return nothing
        off = inverse @ changes
        of_features = np.sqrt(np.sum(changes**2, axis=1)) if self._L is not None else nothing.of_features
        return LeftOpen(view.edge_stddev, off @ off.T, of_features, self._planes(features, L, inverse))

    def _planes(self, features, L, inverse):
        here = LeftOpen().planes
        if self._depths is not None or not self._normal_rad > 0.0:
            return here
        try:
            others = [self._matrix(features, other) for other in _inclined(self._view, self._plane, self._normal_rad)]
        except DegenerateFeature:
            return here
        return np.array([*here, *(self._meant_by(inverse, L, other) for other in others)])

    def _meant_by(self, inverse, L, other):
        """(6, 6): from the displacement that errors stand for by L to the one that they stand for by matrix `other`."""
        seen = inverse @ other
        if not self._sees_tilt:
            seen[:, TILT_COLUMNS] += np.eye(6)[:, TILT_COLUMNS] - inverse @ L[:, TILT_COLUMNS]
        usable = np.isfinite(seen).all() and np.linalg.cond(seen) < MAX_CONDITION
        return np.linalg.inv(seen) if usable else np.eye(6)

    def of(self, e: np.ndarray, tilt: Optional[Sequence[float]]) -> Optional[np.ndarray]:
        """Returns the displacement, (6,), or None where it cannot be told.

        Args: e: (k,) array of errors.  tilt: (2,) displacement about x and y by the joints; None: it is not held.
        """
        if self._inverse is None:
            return None
        if self._with_tilt is None or tilt is None:
            return self._inverse @ e
        return self._with_tilt @ np.array((*e.tolist(), *tilt))  # floats: NumPy's numbers take twice as long

    def told_rows(self, tilt_held: bool) -> Optional[np.ndarray]:
        """Returns (r, 6) orthonormal displacements that count, translations over `arm.nearest.LENGTH_M`; None: all six.

        Args: tilt_held: rotations about x and y are known from the joints.
        """
        if self._L is None or not np.isfinite(self._L).all():
            return None
        unit = np.array([1.0 / UNIT_M] * 3 + [1.0] * 3)  # what is seen does not depend on the unit of SCALE
        _, sigmas, Vt = np.linalg.svd(np.vstack([self._L / unit, *(np.eye(6)[TILT_COLUMNS] if tilt_held else ())]))
        seen = Vt[:len(sigmas)][sigmas > SEEN * sigmas[0]] * unit / SCALE
        return None if len(seen) == 6 else np.linalg.qr(seen.T)[0].T

    def unseen(self, jacobian: np.ndarray, length_m: float, tilt_held: bool) -> Tuple[str, ...]:
        """Returns the motions of the camera that the arm can make and the features do not tell, in words.

        Args: jacobian: (6, n) J_BC_C at the goal.  length_m: that translations are compared with rotations by, such
            as the depth of the target [m].  tilt_held: rotations about x and y are known from the joints.
        """
        if self._L is None or not np.isfinite(self._L).all():
            return ()
        scale = np.array([1.0 / length_m] * 3 + [1.0] * 3)
        U, sigmas, _ = np.linalg.svd(scale[:, None] * jacobian, full_matrices=False)
        can = U[:, sigmas > SEEN * sigmas[0]]
        L = np.vstack([self._L / scale, *(np.eye(6)[TILT_COLUMNS] if tilt_held else ())])
        _, sigmas, Vt = np.linalg.svd(L @ can)
        seen = np.zeros(can.shape[1], bool)
        seen[:len(sigmas)] = sigmas > SEEN * sigmas[0]
        part = np.abs(can @ Vt[~seen].T).max(axis=1, initial=0.0)
        return tuple([name for name, most in zip(MOTIONS, part) if most > NAMED])


def _inverse(L: np.ndarray, sees_tilt: bool) -> Optional[np.ndarray]:
    """(6, k) from errors to displacements; None where the matrix has no usable inverse."""
    if not np.isfinite(L).all():
        return None
    U, sigmas, Vt = np.linalg.svd(L if sees_tilt else L[:, OTHER_COLUMNS], full_matrices=False)
    if not sigmas[0] < MAX_CONDITION * sigmas[-1]:
        return None
    if sees_tilt:
        return (Vt.T / sigmas) @ U.T
    inverse = np.zeros((6, len(L)))
    inverse[OTHER_COLUMNS] = (Vt.T / sigmas) @ U.T
    return inverse


def _inclined(view: Any, plane: np.ndarray, angle_rad: float) -> List[np.ndarray]:
    """The plane turned by this angle about axes through its middle, to eight sides."""
    A, B, C = (float(value) for value in plane)
    depth = 1.0 / (A * view.xg + B * view.yg + C)
    normal, middle = np.array([A, B, C]), depth * np.array([view.xg, view.yg, 1.0])
    normal /= np.linalg.norm(normal)
    across = np.cross(normal, (0.0, 1.0, 0.0) if abs(normal[1]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    along = np.cross(normal, across)
    sides = [cos(way) * across + sin(way) * along for way in np.arange(8) * 0.25 * np.pi]
    return [plane_from_pose(cos(angle_rad) * normal + sin(angle_rad) * side, middle) for side in sides]


def turns_alike(view: Any) -> Tuple[float, ...]:
    """Angles about the target's normal by which followed points, numbered in turn, are the same again [rad].

    As seen from afar and nearly parallel: a rectangle has pi, a square pi / 2, pi and 3 pi / 2.
    """
    if view is None:
        return ()
    z = np.array(view.point_x, dtype=float) + 1j * np.array(view.point_y, dtype=float)
    z, found = z - z.mean() if len(z) > 1 else z, []
    for k in range(1, len(z)):
        turn = np.vdot(z, np.roll(z, -k))
        if abs(turn) > 0.0 and np.abs(np.roll(z, -k) - turn / abs(turn) * z).max() < ALIKE * np.abs(z).max():
            found.append(float(np.angle(turn) % (2.0 * np.pi)))
    return tuple(found)
