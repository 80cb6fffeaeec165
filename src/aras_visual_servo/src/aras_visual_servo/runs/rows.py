"""Compares the rows of the interaction matrix with central differences of the features in rendered images.

The target moves instead of the camera, so that every arm sees all six directions. The images pass the scenario's whole
camera: what a source extracts from them is what a law gets.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Dict, Tuple

import numpy as np

from ..features.base import View
from ..features.interaction import plane_from
from ..ground.errors import ParameterError
from ..spatial import exponential, inverse, quaternion_xyzw, rotation_vector
from .loop import ServoLoop

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario

#: Step of the differences, which are of fourth order: a rotation [rad], and a translation as a part of the target's
#: depth. A longer step leaves less of the rounding by pixels.
STEP = 0.04
#: The views are off the goal by at most these: across and along the axis in depths, tilt and turn. [rad]
ACROSS, ALONG, TILT_RAD, TURN_RAD = 0.05, 0.1, 0.15, 0.4
#: Views that lose the target are drawn again, so often at most.
TRIALS = 10
COLUMNS = ("vx", "vy", "vz", "wx", "wy", "wz")


@dataclass(frozen=True)
class RowCheck:
    """Attributes:
        feature_names: k names.
        rows, differences: (n, k, 6) of n views, columns [v; w] in the camera frame, as `Feature.row`.
        depth_m: of the target at the goal.
    """

    feature_names: Tuple[str, ...]
    rows: np.ndarray
    differences: np.ndarray
    depth_m: float

    @property
    def deviation(self) -> Dict[str, float]:
        """Norm of rows minus differences by that of the differences, by feature. A right row has about 0.01."""
        off, whole = (np.sqrt(np.sum(each**2, axis=(0, 2))) for each in (self._scaled(self.rows - self.differences),
                                                                         self._scaled(self.differences)))
        return dict(zip(self.feature_names, (off / np.maximum(whole, 1e-12)).tolist()))

    def columns(self, name: str, part: float) -> Dict[str, Tuple[float, float]]:
        """Returns (row, difference) by column, of the columns of a feature that are off by more than this part of the
        differences' norm, in the view where that is most."""
        k = self.feature_names.index(name)
        off = np.abs(self._scaled(self.rows - self.differences)[:, k])
        limit = part * np.sqrt(np.mean(np.sum(self._scaled(self.differences)[:, k]**2, axis=1)))
        worst = np.argmax(off, axis=0)
        return {column: (float(self.rows[i, k, j]), float(self.differences[i, k, j]))
                for j, (column, i) in enumerate(zip(COLUMNS, worst)) if off[i, j] > limit}

    def _scaled(self, matrix: np.ndarray) -> np.ndarray:
        """Columns of translations by depths, which are comparable to those of rotations."""
        return matrix * ([self.depth_m] * 3 + [1.0] * 3)


def check_rows(scenario: "Scenario", views: int = 4, seed: int = 0) -> RowCheck:
    """Returns the rows of the features of a scenario, and central differences of their values.

    Args: views: about the goal, tilted.  seed: of their places.
    Raises: ParameterError: no features, a goal without a plane, a scene without a target that can be moved, or views
            that lose it.  The errors of features.
    """
    if views < 1:
        raise ParameterError(f"views: found {views}, allowed 1 or more")
    return _Check(scenario).result(views, np.random.default_rng(seed))


class _Check:
    def __init__(self, scenario):
        self._loop = loop = ServoLoop(scenario)
        self._features, faults = loop.servo.goal.features, []
        if not loop.servo.feature_names:
            faults.append("servo.features: found none, allowed features whose rows can be checked")
        if loop.target_pose() is None or loop.eye_to_hand:
            faults.append("sim.scene.models: found no target to move, allowed one that the arm does not carry")
        if faults:
            raise ParameterError(faults)
        loop.teach_goal()
        self._plane, self._depth = loop.servo.reference.plane_C, loop.sequence.config.z_star_m
        if self._plane is None:
            raise ParameterError("servo: the goal of this source tells no plane, without which no row can be checked")
        self._name = loop.sim.model_names[0]
        self._X_CT = inverse(loop.camera_pose()) @ loop.seen_target_pose()

    def _view(self, X):
        """`View` of a camera at X, (4, 4), in the frame of the goal's camera; None without the target."""
        X_WT = self._loop.camera_pose() @ inverse(X) @ self._X_CT
        self._loop.sim.set_model_pose(self._name, X_WT[:3, 3], quaternion_xyzw(X_WT[:3, :3]))
        features = self._loop.look()
        # The arm may give way a little meanwhile.
        X = self._X_CT @ inverse(inverse(self._loop.camera_pose()) @ self._loop.seen_target_pose())
        displacement = np.r_[X[:3, 3], rotation_vector(X[:3, :3])]
        return None if self._loop.servo.why_lost(features) else View(features, plane_from(X, self._plane), displacement)

    def _pair(self, X):
        """(rows, differences), (k, 6) each, at a pose; None where a view loses the target."""
        here = self._view(X)
        if here is None:
            return None
        steps = STEP * np.array([self._depth] * 3 + [1.0] * 3)
        columns = []
        for step, direction in zip(steps, np.eye(6)):
            there = [self._view(X @ exponential(side * step * direction)) for side in (1.0, -1.0, 2.0, -2.0)]
            if None in there:
                return None
            near, far = (np.array(self._features.error(*map(self._features.values, pair), False))
                         for pair in (there[:2], there[2:]))
            columns.append((8.0 * near - far) / (12.0 * step))
        return self._features.matrix(here), np.column_stack(columns)

    def result(self, count, rng):
        """`RowCheck` of so many views."""
        found = []
        for _ in range(count * TRIALS):
            xi = rng.uniform(-1.0, 1.0, 6) * ([ACROSS * self._depth] * 2 + [ALONG * self._depth] + [TILT_RAD] * 2
                                              + [TURN_RAD])
            pair = self._pair(exponential(xi))
            found += [] if pair is None else [pair]
            if len(found) == count:
                rows, differences = (np.array(each) for each in zip(*found))
                return RowCheck(tuple(self._loop.servo.feature_names), rows, differences, self._depth)
        raise ParameterError(f"sim.scene: found the target in view in {len(found)} of {count * TRIALS} views about the "
                             f"goal, allowed at least {count}")
