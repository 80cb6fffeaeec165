"""Followed points in polar coordinates about the image centre: `rhoN`, the distance, and `thetaN`, the direction.

A turn of the camera about its optical axis changes the directions alone, and by the same amount, and a motion along the
axis changes the distances alone. So a turn is a straight way here, where x and y would send the camera back and forth.

References: M. Iwatsuki, N. Okiyama, "A new formulation of visual servoing based on cylindrical coordinate system", IEEE
T-RO 21(2), 2005. P. I. Corke, F. Spindler, F. Chaumette, "Combining Cartesian and polar coordinates in IBVS", IROS
2009.
"""

from math import atan2, hypot

from ...ground.errors import DegenerateFeature
from ..base import register_family
from ...palette import GREENS, PURPLES
from ..points import OfPoints, point_rows, points


class _Polar(OfPoints):
    """Base class: the point, its distance from the image centre, and its rows."""

    def _place(self, view):
        """(x, y, distance). Raises DegenerateFeature: the point is at the image centre."""
        x, y = view.shared(points)[self._ends(view)[0]]
        rho = hypot(x, y)
        if not rho > 0.0:
            raise DegenerateFeature(f"{self.name}: the point is at the image centre, where it has no direction")
        return x, y, rho

    def _rows(self, view):
        here = 2 * self._ends(view)[0]
        return view.shared(point_rows)[here:here + 2]


@register_family("rho")
class PointDistance(_Polar):
    """Distance of a point from the image centre [-]."""

    symbol, label, colour = "ρ_{number}", "distance of point {number} from the centre", GREENS

    def value(self, view):
        return self._place(view)[2]

    def row(self, view):
        x, y, rho = self._place(view)
        L_x, L_y = self._rows(view)
        return (x * L_x + y * L_y) / rho


@register_family("theta")
class PointDirection(_Polar):
    """Direction of a point from the image centre, from x towards y [rad]."""

    unit, symbol, label, colour = "rad", "θ_{number}", "direction of point {number} from the centre", PURPLES
    angle = directed = True

    def value(self, view):
        x, y, _ = self._place(view)
        return atan2(y, x)

    def row(self, view):
        x, y, rho = self._place(view)
        L_x, L_y = self._rows(view)
        return (x * L_y - y * L_x) / (rho * rho)
