"""Law `hybrid`, 2 1/2-D: half in the image, half in space (docs/theory.md T30)."""

from math import log

import numpy as np

from ..ground.errors import DegenerateFeature
from ..features.base import View
from .base import register, sampled_gains
from .pose import PoseLaw


@register("hybrid")
class Hybrid(PoseLaw):
    """Reference point (x, y, ln(Z/Z*)) straight home in the image, rotation by its angle and axis.

    The reference point is that of the target's plane which is seen at the centroid of the goal's view. Rotation and
    depth ratio come from the pose; Z only scales the translation.

    References: E. Malis, F. Chaumette, S. Boudet, "2 1/2 D visual servoing", IEEE T-RA 15(2), 1999.
    """

    works_on = ("xr", "yr", "zr", "rx", "ry", "rz")

    def reset(self, reference):
        """Chooses the reference point."""
        super().reset(reference)
        view, plane = self.taught_view(reference)
        ray = np.array([view.xg, view.yg, 1.0])
        if self._setup.target is not None:  # its own plane, as the pose has it
            plane = self._X_CgT[:3, 2] / (self._X_CgT[:3, 2] @ self._X_CgT[:3, 3])
        self._z_star_m = 1.0 / float(plane @ ray)
        self._point_T = self._X_CgT[:3, :3].T @ (self._z_star_m * ray - self._X_CgT[:3, 3])

    def _see(self, look):
        look = super()._see(look)
        X, Y, Z = (self._X_CT[:3, :3] @ self._point_T + self._X_CT[:3, 3]).tolist()
        if not Z > 0.0:
            raise DegenerateFeature("reference point: behind the camera")
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
