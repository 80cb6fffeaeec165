"""Laws on the displacement of the camera from the goal, by the pose of the target (docs/theory.md T24, T25)."""

import numpy as np

from .errors import DegenerateFeature, ParameterError
from .features import View
from .laws import Law, LawSetup, register, sampled_gains
from .target_pose import MAX_FOLLOWED, inverse, measures_of, rotation_vector
from .types import Reference


@register("pbvs")
class PoseBased(Law):
    """Straight home: v = -R_CgC^T Lambda t, w = -Lambda theta u, for the pose of a known planar target (T24, T25).

    The pose is followed from image to image: what the joints say the camera has moved, then one Gauss-Newton step.
    """

    works_on, needs_pose = ("tx", "ty", "tz", "rx", "ry", "rz"), True

    def __init__(self, gains_per_s, setup=LawSetup()):
        super().__init__(gains_per_s, setup)
        if setup.target is None:
            raise ParameterError(f"target_model: found nothing, law '{self.name}' needs the file of the known target")
        self._X_CgT = self._X_CT = self._X_CgC_then = self._R = None

    def reset(self, reference):
        """Finds the pose of the target in the taught view."""
        super().reset(reference)
        if not isinstance(reference, Reference) or reference.view is None:
            raise ParameterError(f"law '{self.name}': the reference holds no view with its moments: teach it again")
        self._X_CgT = self._X_CT = self._setup.target.find(reference.view, self._setup.target_normal_C)
        self._X_CgC_then = np.eye(4)

    def _look(self, features, plane):
        X_CT = inverse(self.X_CgC) @ self._X_CgC_then @ self._X_CT
        X_CT, residual, condition = self._setup.target.follow(X_CT, measures_of(features))
        if not residual < MAX_FOLLOWED:
            raise DegenerateFeature(f"pose of the target: {residual:.2g} of its measures unexplained")
        self._X_CT, self._X_CgC_then, self.condition = X_CT, self.X_CgC, condition
        X_CgC = self._X_CgT @ inverse(X_CT)
        self._R = X_CgC[:3, :3]
        return View(features, plane, np.concatenate([X_CgC[:3, 3], rotation_vector(self._R)]))

    def _twist(self, s, e, dt_s):
        wanted = -np.array(sampled_gains(self.gains_per_s, dt_s)) * e
        return np.concatenate([wanted[:3] @ self._R, wanted[3:]])
