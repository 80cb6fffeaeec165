"""Laws that know the camera's displacement from the goal, by the pose of the target (docs/theory.md T24, T25, T29)."""

import numpy as np

from ..ground.errors import DegenerateFeature, ParameterError
from ..features.base import View
from .base import Law, LawSetup, register, sampled_gains
from ..target.points_pose import PlanarPoints, find_corners
from ..ground.spatial import inverse, rotation_vector


class PoseLaw(Law):
    """Base: follows the pose of the target from image to image, what the joints say moved before what the image says.

    `pose_from` moments: of the known target (T24). points: of its corners where the target is known, else of points
    that lie where the taught view and its plane put them (T29).

    Attributes: R_CgC, p_CgC: where the camera is, seen from the goal.  X_CT: pose of the target's frame, which without
    a known target is the camera's at the goal.
    """

    needs_pose = True

    def __init__(self, gains_per_s, setup=LawSetup()):
        super().__init__(gains_per_s, setup)
        if setup.target is None and setup.pose_from == "moments":
            raise ParameterError(f"target_model: found nothing, law '{self.name}' needs the file of the known target, "
                                 "or pose_from: points")
        if setup.target is not None and setup.pose_from == "points" and len(setup.target.outlines_m) != 1:
            raise ParameterError(f"target_model: found {len(setup.target.outlines_m)} outlines, allowed one "
                                 "with pose_from: points")
        self._seen = setup.target
        self._X_CgT = self.X_CT = self._X_CgC_then = self.R_CgC = self.p_CgC = None

    def reset(self, reference):
        """Finds the pose of the target in the taught view."""
        super().reset(reference)
        view, plane = self.taught_view(reference)
        if self._setup.pose_from == "moments":
            self._X_CgT = self._seen.find(view, self._setup.target_normal_C)
        else:
            self._seen, self._X_CgT = self._taught_points(PlanarPoints.measured(view), plane)
        self.X_CT, self._X_CgC_then = self._X_CgT, np.eye(4)

    def _taught_points(self, xy, plane):
        """(`PlanarPoints`, X_CgT): the known corners, or the taught points in the taught plane, T the camera there."""
        if self._setup.target is not None:
            return find_corners(self._setup.target.outlines_m[0], xy)
        rays = np.concatenate([xy, np.ones((len(xy), 1))], axis=1)
        return PlanarPoints(rays / (rays @ plane)[:, None]), np.eye(4)

    def _look(self, features, plane):
        seen = self._seen
        X_CT = inverse(self.X_CgC) @ self._X_CgC_then @ self.X_CT
        X_CT, residual, condition = seen.follow(X_CT, seen.measured(features))
        if not residual < seen.max_followed:
            raise DegenerateFeature(f"pose of the target: {residual:.2g} of its measures unexplained")
        self.X_CT, self._X_CgC_then, self.condition = X_CT, self.X_CgC, condition
        X_CgC = self._X_CgT @ inverse(X_CT)
        self.R_CgC, self.p_CgC = X_CgC[:3, :3], X_CgC[:3, 3]
        return View(features, plane, np.concatenate([self.p_CgC, rotation_vector(self.R_CgC)]))


@register("pbvs")
class PoseBased(PoseLaw):
    """Straight home: v = -R_CgC^T Lambda t, w = -Lambda theta u (T25)."""

    works_on = ("tx", "ty", "tz", "rx", "ry", "rz")

    def _twist(self, s, e, dt_s):
        wanted = -np.array(sampled_gains(self.gains_per_s, dt_s)) * e
        return np.concatenate([wanted[:3] @ self.R_CgC, wanted[3:]])
