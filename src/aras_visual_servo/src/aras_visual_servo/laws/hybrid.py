"""Law `hybrid`, which is 2 1/2-D visual servoing: translation by a point of the image, rotation by the pose (T30)."""

from math import log

import numpy as np

from ..ground.errors import DegenerateFeature
from ..features.base import View
from .base import register_law, sampled_gains
from .pose import PoseLaw


@register_law("hybrid")
class Hybrid(PoseLaw):
    """Brings a reference point (x, y, ln(Z/Z*)) straight to its goal in the image, and turns about one fixed axis.

    The reference point is the point of the target's plane that the goal's view shows at its centroid. The rotation and
    the ratio of depths Z/Z* come from the pose of the target. An error of Z* itself only makes the translation faster
    or slower.

    References: E. Malis, F. Chaumette, S. Boudet, "2 1/2 D visual servoing", IEEE T-RA 15(2), 1999.
    """

    works_on = ("xr", "yr", "zr", "rx", "ry", "rz")

    def _reset(self, reference):
        super()._reset(reference)
        view, plane = self.taught_view(reference)
        ray = np.array([view.xg, view.yg, 1.0])
        if self._setup.target is not None:  # the plane of the known target, which its pose gives
            plane = self._X_CgT[:3, 2] / (self._X_CgT[:3, 2] @ self._X_CgT[:3, 3])
        self._z_star_m = 1.0 / float(plane @ ray)
        self._point_T = self._X_CgT[:3, :3].T @ (self._z_star_m * ray - self._X_CgT[:3, 3])

    def _see(self, look):
        look = super()._see(look)
        X, Y, Z = (self._X_CT[:3, :3] @ self._point_T + self._X_CT[:3, 3]).tolist()
        if not Z > 0.0:
            raise DegenerateFeature(f"law '{self.name}': the pose found puts the reference point at depth {Z:.3g} m, "
                                    "allowed > 0 (in front of the camera)")
        view, point = look.view, (X / Z, Y / Z, log(Z / self._z_star_m))
        return look._replace(view=View(view.features, view.plane, view.displacement, reference_point=point))

    def _twist(self, look, s, e):
        gains = sampled_gains(self.gains_per_s, look.dt_s)
        wx, wy, wz = (-gain * angle for gain, angle in zip(gains[3:], e[3:]))
        x, y = s[0], s[1]
        Z = self._z_star_m * np.exp(s[2])
        vz = Z * (gains[2] * e[2] - y * wx + x * wy)
        vx = Z * (gains[0] * e[0] + x * y * wx - (1.0 + x * x) * wy + y * wz) + x * vz
        vy = Z * (gains[1] * e[1] + (1.0 + y * y) * wx - x * y * wy - x * wz) + y * vz
        return np.array([vx, vy, vz, wx, wy, wz])
