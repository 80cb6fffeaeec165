"""Followed points projected on the unit sphere: `usN`, `vsN`, `wsN`, the direction of the ray to point N.

The rotation's part of the row, [s]x, is that of a rigid turn and has the same size everywhere, where that of x and y
grows with the square of the distance from the image centre. So views near the border of a wide lens are as well
conditioned as those in the middle. Points come as normalised coordinates, so they lie before the camera.

Reference: T. Hamel, R. Mahony, "Visual servoing of an under-actuated dynamic rigid-body system: an image-based
approach", IEEE T-RA 18(2), 2002; R. Tahri, Y. Mezouar, F. Chaumette, P. Corke, "Decoupled image-based visual servoing
for cameras obeying the unified projection model", IEEE T-RO 26(4), 2010.
"""

import numpy as np

from ...ground.spatial import skew
from ..base import register_family
from ..palette import COOL, GREENS, WARM
from ..points import OfPoints, points


class _OnSphere(OfPoints):
    axis = 0

    def _ray(self, view):
        """((3,) unit vector to the point, length of (x, y, 1))."""
        x, y = view.shared(points)[self._ends(view)[0]]
        length = (x * x + y * y + 1.0) ** 0.5
        return np.array([x, y, 1.0]) / length, length

    def value(self, view):
        return float(self._ray(view)[0][self.axis])

    def row(self, view):
        s, length = self._ray(view)
        if view.inverse_depths is not None:
            over_Z = view.inverse_depths[self._ends(view)[0]]
        else:
            over_Z = float(np.dot(view.plane, s * length))
        over_r = over_Z / length  # 1 / distance of the point from the optical centre
        return np.concatenate([(over_r * (np.outer(s, s) - np.eye(3)))[self.axis], skew(s)[self.axis]])


@register_family("us")
class SphereX(_OnSphere):
    """x of the ray to a point [-]."""

    symbol, label, colour = "u_{number}", "ray to point {number} in x", COOL


@register_family("vs")
class SphereY(_OnSphere):
    """y of the ray to a point [-]."""

    symbol, label, colour = "v_{number}", "ray to point {number} in y", WARM
    axis = 1


@register_family("ws")
class SphereZ(_OnSphere):
    """z of the ray to a point [-]."""

    symbol, label, colour = "w_{number}", "ray to point {number} in z", GREENS
    axis = 2
