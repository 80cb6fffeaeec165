"""Law `sliding`: sliding mode with a boundary layer, for any features (docs/theory.md T31)."""

from dataclasses import dataclass
from math import copysign, exp, log
from typing import Tuple

import numpy as np

from ..config.settings import setting
from ..ground.errors import ParameterError
from .base import LawSetup, register
from .image import ImageBased


@dataclass(frozen=True)
class SlidingSettings:
    """Settings of law `sliding`, which needs them."""

    switching_per_s: float = setting(
        unit="1/s", above=0,
        help="Rate kappa of (T31): how fast the error falls outside the boundary layer, on top of the gains.")
    boundary: Tuple[float, ...] = setting(
        above=0, by="feature", not_empty=True,
        help="Half the thickness phi of the boundary layer of (T31), one number per feature, in its unit.")


@register("sliding", settings=SlidingSettings)
class Sliding(ImageBased):
    """e_dot = -lambda e - kappa phi sat(e / phi): far away a constant rate on top of the proportional one.

    What the matrix, its depths or a moving target do to e_dot, up to (lambda + kappa) phi, keeps |e| inside the layer;
    there it leaves 1 / (lambda + kappa) of it. Nothing chatters: inside the layer the law is linear, and the twist is
    the one that brings e to where this rate would have it at the next image.

    References: W. Gao, J. C. Hung, "Variable structure control of nonlinear systems: a new approach", IEEE T-IE 40(1),
    1993 (constant plus proportional rate). J.-J. Slotine, W. Li, Applied Nonlinear Control, 1991, chapter 7 (boundary
    layer). P. Zanne, G. Morel, F. Plestan, "Robust vision based 3D trajectory tracking using sliding mode control",
    ICRA 2000.
    """

    def __init__(self, gains_per_s, setup=LawSetup()):
        super().__init__(gains_per_s, setup)
        self._switching, self._boundary = self.settings.switching_per_s, self.settings.boundary
        if len(self._boundary) != len(self.features):
            raise ParameterError(f"{self.name}/boundary: found {len(self._boundary)} numbers, allowed "
                                 f"{len(self.features)}")

    def _wanted(self, e, dt_s):
        return np.array([_rate(error, gain, self._switching, boundary, dt_s)
                         for error, gain, boundary in zip(e, self.gains_per_s, self._boundary)])


def _rate(e, gain, switching, boundary, dt_s):
    """-e_dot that, held for dt_s, leaves of e what the reaching law leaves of it in that time."""
    size = abs(e)
    if dt_s <= 0.0:
        return gain * e + switching * max(-boundary, min(boundary, e))
    outside_s, left = 0.0, size
    if size > boundary:
        constant = switching * boundary / gain
        outside_s = min(dt_s, log((size + constant) / (boundary + constant)) / gain)
        left = (size + constant) * exp(-gain * outside_s) - constant
    left *= exp(-(gain + switching) * (dt_s - outside_s))
    return copysign((size - left) / dt_s, e)
