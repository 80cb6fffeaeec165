"""Keeps the object in view: where the object comes too near to the image border, the camera's twist is changed.

The edges of the object in the image are its centroid +- `extent` standard deviations along x and along y. Each edge has
a distance h to the border of the view, less the margin, and may approach the border by at most rate_per_s times h per
second: L_edge V <= rate h (T43). Where the law's twist would exceed that, the camera's sideways velocity is changed by
as much as is needed. The rotation and the motion along the optical axis stay those of the law, so that the law does not
get stuck.

References:
    P. I. Corke and S. A. Hutchinson, IEEE T-RA 17(4), 2001 (repelled by the border of the image).
    A. D. Ames et al., European Control Conference, 2019 (control barrier functions).
"""

from dataclasses import dataclass
from typing import Any, Tuple

import numpy as np

from ..config.settings import setting
from ..features.base import View
from ..features.interaction import centroid
from .stage import Stage, Tick

#: The camera is moved sideways for an edge only if that moves the edge by at least this part of the centroid's motion.
LEAST_EFFECT = 0.2


@dataclass(frozen=True)
class VisibilitySettings:
    """Section `servo.visibility`: the object is kept inside a view."""

    half_width: float = setting(
        above=0,
        help="Half the width of the view in normalised image coordinates: the tangent of half the field of view.")
    half_height: float = setting(above=0, help="Half the height of the view, likewise.")
    margin: float = setting(
        0.05, at_least=0, help="Margin kept to the border of the view, in normalised image coordinates.")
    extent: float = setting(2.0, above=0, help="The object ends this many standard deviations from its centroid.")
    rate_per_s: float = setting(
        3.0, unit="1/s", above=0, help="The object uses up its room to the border at this rate at most (T43).")


class Visibility(Stage):
    """Keeps the object in view (T43)."""

    def __init__(self, config: VisibilitySettings) -> None:
        self._config = config

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with a twist that keeps a target which is seen in view."""
        if tick.features is None:
            return tick
        twist, bent = keep_in_view(self._config, tick.features, tick.twist)
        return tick.set(twist=twist, text="servoing, kept in view") if bent else tick


def keep_in_view(config: VisibilitySettings, features: Any, twist: np.ndarray) -> Tuple[np.ndarray, bool]:
    """Returns (twist, bent): V_C, (6,), with the sideways motion that keeps the object in view, and whether it has any.

    Args: features: valid `MomentFeatures` with centred moments of order 3. twist: (6,).
    The target is assumed to be parallel to the image, at the distance an.
    """
    view = View(features, np.array([0.0, 0.0, 1.0 / features.an]))
    area, L_g, L_area = features.area, centroid(view.m, view.plane), view.L_area()
    result, bent = twist, False
    sides = (config.half_width, config.half_height)
    for axis, (half, at, name) in enumerate(zip(sides, (features.xg, features.yg), ("20", "02"))):
        n = view.mu[name] / area
        if not n > 0.0:
            continue
        spread = config.extent * n**0.5
        L_n = (view.L_mu(int(name[0]), int(name[1])) - n * L_area) / area
        L_spread = L_n * (0.5 * config.extent / n**0.5)
        rooms = [half - config.margin - (side * at + spread) for side in (1.0, -1.0)]
        excess = [float((side * L_g[axis] + L_spread) @ result) - config.rate_per_s * room
                  for side, room in zip((1.0, -1.0), rooms)]
        if max(excess) <= 0.0 or min(rooms) < 0.0 > max(rooms):  # nothing to do, or an object larger than the view
            continue
        side = 0 if excess[0] >= excess[1] else 1
        effect = float(((1.0, -1.0)[side] * L_g[axis] + L_spread)[axis])
        if abs(effect) < LEAST_EFFECT / features.an:
            continue
        if not bent:
            result, bent = np.array(twist), True
        result[axis] -= excess[side] / effect
    return result, bent
