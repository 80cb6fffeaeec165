"""Keeps the object in view: where the object comes too near to the image border, the camera's twist is changed.

Each edge of the object, `extent` standard deviations from its centroid, may approach the border of the view by at most
rate_per_s times its distance per second (docs/theory.md T43). Where the law's twist would exceed that, the camera's
sideways velocity is changed by as much as is needed. The rotation and the motion along the optical axis stay those of
the law, so that the law does not get stuck.

References: T43, and P. I. Corke and S. A. Hutchinson, IEEE T-RA 17(4), 2001 (repelled by the border of the image).
"""

from dataclasses import dataclass
from typing import Any, Tuple

import numpy as np

from ..config.settings import setting
from ..features.base import View
from ..laws.constraints import edges
from .stage import Stage, Tick

#: The camera is moved sideways for an edge only if that moves the edge by at least this part of the centroid's motion.
LEAST_EFFECT = 0.2


@dataclass(frozen=True)
class VisibilitySettings:
    """Section `servo.visibility`: the object is kept inside a view."""

    half_width: float = setting(
        above=0,
        help="Half the width of the view: tangent of half the field of view.")
    half_height: float = setting(above=0, help="Half the height of the view, likewise.")
    margin: float = setting(
        0.05, at_least=0, help="Margin to the border of the view, in normalised coordinates.")
    extent: float = setting(2.0, above=0, help="Size of the object: standard deviations from its centroid.")
    rate_per_s: float = setting(
        3.0, unit="1/s", above=0, help="The distance to the border shrinks at this rate at most (T43).")


@dataclass(eq=False)
class Visibility(Stage):
    """Keeps the object in view (T43)."""

    config: VisibilitySettings

    def apply(self, tick: Tick) -> Tick:
        if tick.features is None:
            return tick
        twist, bent = keep_in_view(self.config, tick.features, tick.twist)
        return tick.set(twist=twist, text="servoing, kept in view", held="kept in view") if bent else tick


def keep_in_view(config: VisibilitySettings, features: Any, twist: np.ndarray) -> Tuple[np.ndarray, bool]:
    """Returns (twist, bent): V_C, (6,), with the sideways motion that keeps the object in view, and whether it has any.

    Args: features: valid `MomentFeatures` with centred moments of order 3. twist: (6,).
    The target is assumed to be parallel to the image, at the distance an.
    """
    view = View(features, np.array([0.0, 0.0, 1.0 / features.an]))
    result, bent = twist, False
    for axis, half in enumerate((config.half_width, config.half_height)):
        if not view.mu[("20", "02")[axis]] > 0.0:
            continue
        low, high, L_low, L_high = edges(view, axis, config.extent)
        rooms, rows = (half - config.margin - high, half - config.margin + low), (L_high, -L_low)
        excess = [float(row @ result) - config.rate_per_s * room for row, room in zip(rows, rooms)]
        if max(excess) <= 0.0 or min(rooms) < 0.0 > max(rooms):  # nothing to do, or an object larger than the view
            continue
        side = 0 if excess[0] >= excess[1] else 1
        effect = float(rows[side][axis])
        if abs(effect) < LEAST_EFFECT / features.an:
            continue
        if not bent:
            result, bent = np.array(twist), True
        result[axis] -= excess[side] / effect
    return result, bent
