"""Law `sliding`: sliding mode with a boundary layer, for any features (docs/theory.md T31)."""

from dataclasses import dataclass
from math import copysign, exp, log
from typing import Tuple

import numpy as np

from ..config.settings import setting
from ..ground.errors import ParameterError
from .base import register_law
from .image import ImageBased


@dataclass(frozen=True)
class SlidingSettings:
    """Settings of law `sliding`; they have no defaults."""

    switching_per_s: float = setting(
        unit="1/s", above=0,
        help="Rate kappa of (T31): outside the boundary layer the error falls faster by kappa times `boundary`.")
    boundary: Tuple[float, ...] = setting(
        above=0, by="feature", not_empty=True,
        help="Half-thickness phi of the boundary layer of (T31) for each feature, in its unit.")


@register_law("sliding", settings=SlidingSettings)
class Sliding(ImageBased):
    """e_dot = -lambda e - kappa phi sat(e / phi) (T31).

    A disturbance of e_dot (a wrong matrix, wrong depths, a moving target) smaller than (lambda + kappa) phi cannot push
    |e| out of the boundary layer. The command does not chatter, because the law is linear inside the layer and because
    each twist is the one that brings e to where the continuous law would have it at the next image.

    References: T31, and P. Zanne, G. Morel, F. Plestan, "Robust vision based 3D trajectory tracking using sliding mode
    control", ICRA 2000.
    """

    def _prepare(self):
        super()._prepare()
        self._switching, self._boundary = self.settings.switching_per_s, self.settings.boundary
        if len(self._boundary) != len(self.features):
            raise ParameterError(f"{self.name}.boundary: found {len(self._boundary)} numbers, allowed "
                                 f"{len(self.features)}")

    def _wanted(self, e, dt_s):
        return np.array([_rate(error, gain, self._switching, boundary, dt_s)
                         for error, gain, boundary in zip(e, self.gains_per_s, self._boundary)])


def _rate(e, gain, switching, boundary, dt_s):
    """The constant rate of fall, -e_dot, that takes e in dt_s to where the law (T31) would take it in that time."""
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
