"""Laws that measure the camera's displacement from the goal by the target's pose (docs/theory.md T24, T25, T29)."""

from typing import Any

import numpy as np

from ..ground.errors import DegenerateFeature, ParameterError
from ..features.base import View
from .base import Law, register_law, sampled_gains
from ..features.target.points_pose import PlanarPoints, find_corners
from ..features.target.solid_points import SolidPoints
from ..spatial import inverse, rotation, rotation_vector, transform


class PoseLaw(Law):
    """Base class of the laws that follow the pose of the target from image to image.

    For each image the joint positions predict the pose, and the image corrects it. With `pose_from: moments` the pose
    is that of the known target (T24). With `pose_from: points` it is that of the target's corners or, if no target is
    known, of points that lie in the taught plane where the goal's view shows them (T29). With `pose_from: depth` it is
    that of the same points, but the depth image says how far each of them is, here and in the goal's view (T75).

    `_twist` of a subclass finds the camera's pose X_CgC, (4, 4), as the image gives it in `look.X_CgC`, and the pose of
    the target's frame T in the camera in `self._X_CT`. Without a known target T is the camera frame at the goal.
    """

    needs_pose, foresees = True, False

    def _prepare(self):
        setup = self._setup
        if setup.target is None and setup.pose_from == "moments":
            raise ParameterError(f"target_model: found nothing, law '{self.name}' needs the file of the known target, "
                                 "or pose_from: points or depth")
        if setup.target is not None and setup.pose_from != "moments" and len(setup.target.outlines_m) != 1:
            raise ParameterError(f"target_model: found {len(setup.target.outlines_m)} outlines, allowed one "
                                 f"with pose_from: {setup.pose_from}")
        self._seen = setup.target
        self._X_CgT: Any = None
        self._X_CT = self._X_CgC_then = self._X_CgT

    def _reset(self, reference):
        """Finds the pose of the target in the taught view. Raises DegenerateFeature: no pose explains the view."""
        view, plane = self.taught_view(reference)
        if self._setup.pose_from == "moments":
            self._X_CgT = self._seen.find(view, self._setup.target_normal_C)
        elif self._setup.pose_from == "depth":
            self._seen, self._X_CgT = self._solid_points(view)
        else:
            self._seen, self._X_CgT = self._taught_points(PlanarPoints.measured(view), plane)
        self._X_CT, self._X_CgC_then = self._X_CgT, np.eye(4)

    def _taught_points(self, xy, plane):
        """(`PlanarPoints`, X_CgT): the known corners and their pose, or the taught points in the taught plane and 1.

        Args: xy: (N, 2) normalised coordinates in the taught view.  plane: (A, B, C), (3,) [1/m].
        """
        if self._setup.target is not None:
            return find_corners(self._setup.target.outlines_m[0], xy)
        rays = np.concatenate([xy, np.ones((len(xy), 1))], axis=1)
        return PlanarPoints(rays / (rays @ plane)[:, None]), np.eye(4)

    def _solid_points(self, view):
        """(`SolidPoints`, X_CgT): the known corners and their pose, or the points seen at the goal and 1."""
        points_Cg = SolidPoints.measured(view)
        if self._setup.target is None:
            return SolidPoints(points_Cg), np.eye(4)
        corners, _ = find_corners(self._setup.target.outlines_m[0], PlanarPoints.measured(view))
        seen = SolidPoints(corners.points_T)
        return seen, seen.find(points_Cg)

    def _see(self, look):
        seen, features = self._seen, look.view.features
        X_CT = inverse(look.X_CgC) @ self._X_CgC_then @ self._X_CT
        X_CT, residual, condition = seen.follow(X_CT, seen.measured(features))
        if not residual < seen.max_followed:
            raise DegenerateFeature(f"pose of the target: the best pose leaves a residual of {residual:.2g}, allowed < "
                                    f"{seen.max_followed:g}: the view does not show the target that is known")
        self._X_CT, self._X_CgC_then, self._condition = X_CT, look.X_CgC, condition
        X_CgC = self._X_CgT @ inverse(X_CT)
        displacement = np.concatenate([X_CgC[:3, 3], rotation_vector(X_CgC[:3, :3])])
        return look._replace(view=View(features, look.view.plane, displacement), X_CgC=X_CgC)


@register_law("pbvs")
class PoseBased(PoseLaw):
    """Pose-based visual servoing: v = -R_CgC^T Lambda t, w = -Lambda theta u; the camera goes straight home (T25)."""

    works_on, foresees = ("tx", "ty", "tz", "rx", "ry", "rz"), True

    def _foresee(self, look, s):
        displacement = np.array(s)
        X_CgC = transform(rotation(displacement[3:]), displacement[:3])
        self._X_CT, self._X_CgC_then = inverse(X_CgC) @ self._X_CgT, look.X_CgC
        return look._replace(view=View(look.view.features, look.view.plane, displacement), X_CgC=X_CgC)

    def _twist(self, look, s, e):
        wanted = -np.array(sampled_gains(self.gains_per_s, look.dt_s)) * e
        return np.concatenate([wanted[:3] @ look.X_CgC[:3, :3], wanted[3:]])
