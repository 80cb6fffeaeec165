"""The goal of the servo: the view that was taught, and where the joints place the camera relative to it."""

from math import atan2, isfinite, pi, remainder
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..features.base import FeatureSet, View
from ..features.interaction import plane_from
from ..features.sources.base import source_named
from ..ground.errors import DegenerateFeature, ParameterError
from ..ground.types import Reference
from .goal_pose import GoalPose, turns_alike


class Goal:
    """Teaches views, and holds the `Reference` in use.

    Attributes:
        kinematics: `Kinematics`.  features: `FeatureSet`.  source: `Source` of the features.
        reference: `Reference` or None.  s_star: (k,) of it, NaN before.  pose: `GoalPose` of it, or None.
    """

    def __init__(self, kinematics: RobotKinematics, config: Any) -> None:
        """Args: config: `ServoSettings`."""
        self.kinematics, self._config = kinematics, config
        self.features = FeatureSet(config.features, config.settings, config.source)
        self.source = source_named(self.features.source)
        self.reference: Optional[Reference] = None
        self.s_star = np.full(len(self.features), np.nan)
        self.pose: Any = None
        self._X_CgB: Optional[np.ndarray] = None
        self._alike: Tuple[float, ...] = ()

    def set_reference(self, reference: Reference) -> None:
        """Uses a reference taught before."""
        self.pose = GoalPose(self.features, reference, self._config.point_depth, self._config.stop.normal_rad)
        self._alike = (pi,) if self._config.symmetric_target else turns_alike(reference.view)
        posture = reference.posture
        self._X_CgB = None if posture is None else np.linalg.inv(self.kinematics.pose(self.kinematics.vector(posture)))
        self.reference, self.s_star = reference, np.array(reference.s_star, dtype=float)

    def why_lost(self, features: Optional[Any]) -> str:
        """Returns why these features (None: no image) cannot be servoed on, in words; an empty text if they can."""
        return "no image" if features is None else self.source.why_lost(features)

    def taught_by(self, features: Any, q: Any, z_star_m: float) -> Reference:
        """Returns the `Reference` that a view would give as the goal. The goal itself stays as it is.

        Args:
            features: of the view, whatever reference they have themselves.  q: joint positions there [m, rad].
            z_star_m: depth of the target in this view, > 0 [m].
        Raises ParameterError: the features are not fit for it.
        """
        text, q = self.why_lost(features), self.kinematics.vector(q)
        if not (isfinite(z_star_m) and z_star_m > 0.0):
            raise ParameterError(f"z_star_m of the view to teach: found {z_star_m}, allowed > 0")
        try:
            taught: Any = None if text else self.source.taught(features, z_star_m, self._config.target_normal_C)
            s_star = np.array([np.nan] if text else self.features.values(View(taught.features)))
        except DegenerateFeature as error:
            raise ParameterError(f"the view to teach: {error}") from error
        if not (np.isfinite(s_star).all() and np.isfinite(q).all()):
            raise ParameterError(f"the view to teach has no valid features of the target: {text or 'not finite'}")
        return self._reference(s_star, q, taught.view, taught.plane_C)

    def averaged(self, first: Reference, views: Sequence[Any], q: np.ndarray) -> Reference:
        """Returns the mean of several views of one goal: the first, others relative to it; q: (n,) their mean."""
        view = self.source.mean(views)
        return self._reference(np.array(self.features.values(View(view))), q, view, first.plane_C, len(views))

    def _reference(self, s_star: np.ndarray, q: np.ndarray, view: Any, plane_C: Any, images: int = 1) -> Reference:
        axis_B = self.kinematics.pose(q)[:3, 2].copy()
        return Reference(s_star, axis_B, self.kinematics.by_name(q), view, plane_C, images)

    def errors(self, views: Sequence[Any]) -> Tuple[np.ndarray, Optional[np.ndarray]]:
        """Returns how views of the goal differ from the first: (m, k) errors, (m, 6) poses they stand for or None."""
        values = [self.features.values(View(view)) for view in views]
        errors = np.array([self.features.error(s, values[0], self._config.symmetric_target) for s in values])
        poses: List[Any] = [self.pose.of(e, None) for e in errors]
        return errors, self.pose.by_views(views) if poses[0] is None else np.array(poses)

    def unseen(self, tilt_held: bool) -> Tuple[str, ...]:
        """Returns the motions of the camera at the goal that the features do not tell, as `GoalPose.unseen`."""
        reference = self.reference
        if self.pose is None or reference.posture is None or reference.plane_C is None:
            return ()
        jacobian = self.kinematics.jacobian(self.kinematics.vector(reference.posture))
        return self.pose.unseen(jacobian, 1.0 / float(np.linalg.norm(reference.plane_C)), tilt_held)

    def turned_alike(self, X_BC: np.ndarray) -> bool:
        """Whether by the joints the camera is turned by an angle after which the target looks the same."""
        if not self._alike or self._X_CgB is None:
            return False
        R = self.displacement(X_BC)[:3, :3]
        turn = atan2(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1])
        return any(abs(remainder(abs(turn) - angle, 2.0 * pi)) < abs(turn) for angle in self._alike)

    def displacement(self, X_BC: np.ndarray) -> np.ndarray:
        """Returns X_CgC, (4, 4): a camera pose by the kinematics, relative to the goal's. Raises ParameterError."""
        if self._X_CgB is None:
            raise ParameterError("the reference holds no posture: teach it again")
        return self._X_CgB @ X_BC

    def plane(self, X_BC: np.ndarray) -> np.ndarray:
        """Returns (A, B, C), (3,), of the target, at rest, in the frame of a camera at X_BC [1/m] (T21).

        Raises ParameterError: nothing was taught, or the reference does not tell where the target is.
        """
        if self.reference is None or self.reference.plane_C is None:
            raise ParameterError("servo: the goal holds no plane, teach it first")
        return plane_from(self.displacement(X_BC), self.reference.plane_C)

    def plane_at(self, q: Any) -> np.ndarray:
        """`plane` of the camera at joint positions q."""
        return self.plane(self.kinematics.pose(self.kinematics.vector(q)))
