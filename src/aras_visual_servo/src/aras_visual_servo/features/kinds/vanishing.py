"""Vanishing points of opposite sides of a quadrilateral of followed points: `vxN`, `vyN`, `vzN`.

Sides N and N + 2, parallel on the target, meet in a vanishing point, which says in which direction they run. It is
given as that direction on the unit sphere, of the camera frame, because in a view parallel to the target it is at
infinity in the image. The direction is that of side N, from its first point to the second. It depends on the camera's
attitude alone, so that two of them, `vxN` to `vzN` for N = 1 and 2, drive the rotation and leave the translation alone,
whatever the depths are.

The row is that of a direction that is fixed in space, d_dot = -w x d; B. Espiau, F. Chaumette, P. Rives, "A new
approach to visual servoing in robotics", IEEE T-RA 8(3), 1992, has it for points at infinity.
"""

import numpy as np

from ...ground.errors import DegenerateFeature
from ...spatial import skew
from ..base import View, register_each
from ...palette import COOL, GREENS, WARM
from ..points import OfPoints, rays


def direction(view: View, first: int) -> np.ndarray:
    """(3,) unit vector of sides `first` and `first + 2`. Raises DegenerateFeature: not four points, or one line."""
    seen = view.shared(rays)
    if len(seen) != 4:
        raise DegenerateFeature(f"vanishing points: found {len(seen)} points in this view, needed 4")
    corners = np.roll(seen, -first, axis=0)
    planes = np.cross(corners[0], corners[1]), np.cross(corners[2], corners[3])
    d = np.cross(*planes)
    size = float(np.linalg.norm(d))
    if not size > 1e-12 * float(np.linalg.norm(planes[0]) * np.linalg.norm(planes[1])):
        raise DegenerateFeature("vanishing points: the four points lie on one line")
    # Along side N the ray turns from its first corner towards the second, on the side where d is before the camera.
    return d / (size if d @ np.cross(planes[0], corners[0]) > 0.0 else -size)


class _Vanishing(OfPoints):
    """x, y or z of the direction of a pair of sides [-]."""

    def _direction(self, view):
        return view.shared(direction, self._index(len(view.shared(rays))))

    def value(self, view):
        return float(self._direction(view)[self.index])

    def row(self, view):
        return np.concatenate([np.zeros(3), skew(self._direction(view))[self.index]])


register_each(_Vanishing, ((f"v{axis}", f"v_{axis}{{number}}", f"vanishing point of side {{number}} in {axis}", colour)
                           for axis, colour in zip("xyz", (COOL, WARM, GREENS))), family=True)
