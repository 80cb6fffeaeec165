"""Straight lines through a followed point and the next one: `lrN` and `ltN`, x cos(lt) + y sin(lt) = lr.

lt is the direction of the line's normal and lr its distance from the image centre along it, so lr may be negative. The
normal is the direction from the point to the next one, turned by a right angle from x to y: a line keeps its sign when
it passes through the image centre. The last line goes from the last point to the first.

Reference: B. Espiau, F. Chaumette, P. Rives, "A new approach to visual servoing in robotics", IEEE T-RA 8(3), 1992.
"""

from math import atan2, hypot

from ...ground.errors import DegenerateFeature
from ..base import register_family
from ...palette import GREENS, PURPLES
from ..points import OfPoints, point_rows, points


class OfLine(OfPoints):
    """Base class of features of the line through a point and the next one."""

    def line(self, view, first=None):
        """((cosine, sine) of the normal, distance, L of both: (L_distance, L_direction), (6,) each).

        Args: first: index of the first point; None: this one. Raises DegenerateFeature: the points coincide.
        """
        seen, L = view.shared(points), view.shared(point_rows) if view.plane or view.inverse_depths else None
        here, following = self._ends(view) if first is None else (first, (first + 1) % len(seen))
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


@register_family("lr")
class LineDistance(OfLine):
    """Distance of a line from the image centre, along its normal [-]."""

    symbol, label, colour = "ρ_l{number}", "distance of line {number} from the centre", GREENS

    def value(self, view):
        return self.line(view)[1]

    def row(self, view):
        return self.line(view)[2][0]


@register_family("lt")
class LineDirection(OfLine):
    """Direction of a line's normal [rad]."""

    unit, symbol, label, colour = "rad", "θ_l{number}", "direction of line {number}", PURPLES
    angle = directed = True

    def value(self, view):
        (cosine, sine), _, _ = self.line(view)
        return atan2(sine, cosine)

    def row(self, view):
        return self.line(view)[2][1]
