"""Followed points, and the lines through them, in polar coordinates about the image centre.

`rhoN` is the distance of a point, `thetaN` its direction. A turn of the camera about its optical axis changes the
directions alone, and by the same amount, and a motion along the axis changes the distances alone. So a turn is a
straight way here, where x and y would send the camera back and forth.

`lrN` and `ltN` are the straight line through a followed point and the next one, x cos(lt) + y sin(lt) = lr. lt is the
direction of the line's normal and lr its distance from the image centre along it, so lr may be negative. The normal is
the direction from the point to the next one, turned by a right angle from x to y: a line keeps its sign when it passes
through the image centre. The last line goes from the last point to the first.

References: M. Iwatsuki, N. Okiyama, "A new formulation of visual servoing based on cylindrical coordinate system", IEEE
T-RO 21(2), 2005. P. I. Corke, F. Spindler, F. Chaumette, "Combining Cartesian and polar coordinates in IBVS", IROS
2009. B. Espiau, F. Chaumette, P. Rives, "A new approach to visual servoing in robotics", IEEE T-RA 8(3), 1992 (lines).
"""

from math import atan2, hypot

from ...ground.errors import DegenerateFeature
from ..base import register_each
from ...palette import GREENS, PURPLES
from ..points import DIRECTION, OfPoints, point_rows, points


class _Polar(OfPoints):
    """Distance of a point from the image centre [-] (index 0), or its direction, from x towards y [rad] (index 1)."""

    def _place(self, view):
        """(x, y, distance). Raises DegenerateFeature: the point is at the image centre."""
        x, y = view.shared(points)[self._ends(view)[0]]
        rho = hypot(x, y)
        if not rho > 0.0:
            raise DegenerateFeature(f"{self.name}: the point is at the image centre, where it has no direction")
        return x, y, rho

    def value(self, view):
        x, y, rho = self._place(view)
        return atan2(y, x) if self.index else rho

    def row(self, view):
        x, y, rho = self._place(view)
        here = 2 * self._ends(view)[0]
        L_x, L_y = view.shared(point_rows)[here:here + 2]
        return (x * L_y - y * L_x) / (rho * rho) if self.index else (x * L_x + y * L_y) / rho


register_each(_Polar, [("rho", "ρ_{number}", "distance of point {number} from the centre", GREENS)], family=True)
register_each(_Polar, [("theta", "θ_{number}", "direction of point {number} from the centre", PURPLES)], 1, True,
              **DIRECTION)


class _Line(OfPoints):
    """Distance of a line from the image centre, along its normal [-] (index 0), or the normal's direction [rad] (1)."""

    def _line(self, view):
        """((cosine, sine) of the normal, distance, L of both: (L_distance, L_direction), (6,) each).

        Raises DegenerateFeature: the points coincide.
        """
        seen, L = view.shared(points), view.shared(point_rows) if view.plane or view.inverse_depths else None
        here, following = self._ends(view)
        (x, y), (x_next, y_next) = seen[here], seen[following]
        dx, dy = x_next - x, y_next - y
        length = hypot(dx, dy)
        if not length > 0.0:
            raise DegenerateFeature(f"{self.name}: the line is not known, two followed points coincide")
        cosine, sine = -dy / length, dx / length
        distance = x * cosine + y * sine
        if L is None:
            return (cosine, sine), distance, None
        turn = (cosine * (L[2 * following] - L[2 * here]) + sine * (L[2 * following + 1] - L[2 * here + 1])) / length
        shift = cosine * L[2 * here] + sine * L[2 * here + 1] + (y * cosine - x * sine) * turn
        return (cosine, sine), distance, (shift, turn)

    def value(self, view):
        (cosine, sine), distance, _ = self._line(view)
        return atan2(sine, cosine) if self.index else distance

    def row(self, view):
        return self._line(view)[2][self.index]


register_each(_Line, [("lr", "ρ_l{number}", "distance of line {number} from the centre", GREENS)], family=True)
register_each(_Line, [("lt", "θ_l{number}", "direction of line {number}", PURPLES)], 1, True, **DIRECTION)
