"""Followed points projected on the unit sphere: the rays to them, moments of the rays, and vanishing points.

`usN, vsN, wsN` are the direction of the ray to point N. The rotation's part of the row, [s]x, is that of a rigid turn
and has the same size everywhere, where that of x and y grows with the square of the distance from the image centre. So
views near the border of a wide lens are as well conditioned as those in the middle.

`ug, vg, wg` are the moments of first order, m100, m010 and m001 over the number of points: the middle of the rays.

`is` is 1 / sqrt(I), with I of (T72) an invariant of the moments of second order, which does not change while the camera
turns. It grows about in proportion to the distance. `isN` is the same of the points without point N. A pattern that is
symmetric about the ray to its middle hardly changes `is` as the camera moves aside, but it does change these, and three
or more of them hold the translation. Together with features of the rotation alone (`vxN, vyN, vzN`) they make a matrix
of two blocks: turns and translations do not disturb each other.

`vxN, vyN, vzN` are the vanishing point of opposite sides of a quadrilateral of followed points. Sides N and N + 2,
parallel on the target, meet in it, so that it says in which direction they run. It is given as that direction on the
unit sphere, of the camera frame, because in a view parallel to the target it is at infinity in the image. The direction
is that of side N, from its first point to the second. It depends on the camera's attitude alone, so that two of them,
`vxN` to `vzN` for N = 1 and 2, drive the rotation and leave the translation alone, whatever the depths are. The row is
that of a direction that is fixed in space, d_dot = -w x d.

References: docs/theory.md T72; T. Hamel, R. Mahony, "Visual servoing of an under-actuated dynamic rigid-body system: an
image-based approach", IEEE T-RA 18(2), 2002 (rays). B. Espiau, F. Chaumette, P. Rives, "A new approach to visual
servoing in robotics", IEEE T-RA 8(3), 1992 (points at infinity).
"""

import numpy as np

from ...ground.errors import DegenerateFeature
from ...palette import BLUE, COOL, GREEN, GREENS, NAVY, VERMILION, WARM
from ...spatial import skew
from ..base import View, register_each
from ..points import OfPoints, ray_rows, rays


class _Ray(OfPoints):
    """x, y or z of the ray to a point [-]."""

    def value(self, view):
        seen = view.shared(rays)
        return float(seen[self._index(len(seen)), self.index])

    def row(self, view):
        L = view.shared(ray_rows)
        return L[self._index(len(L)), self.index]


register_each(_Ray, ((f"{letter}s", f"{letter}_{{number}}", f"ray to point {{number}} in {axis}", colour)
                     for letter, axis, colour in zip("uvw", "xyz", (COOL, WARM, GREENS))), family=True)


class _FirstOrder(OfPoints):
    """Of the mean of the rays to the points (T72) [-]."""

    def value(self, view):
        return float(view.shared(rays)[:, self.index].mean())

    def row(self, view):
        return view.shared(ray_rows)[:, self.index].mean(axis=0)


register_each(_FirstOrder, ((f"{letter}g", f"{letter}_g", f"middle of the rays in {axis}", colour)
                            for letter, axis, colour in zip("uvw", "xyz", (BLUE, VERMILION, GREEN))))


class _Invariant(OfPoints):
    """1 / sqrt(I) of the points but `number`, or of all for the number 0: an invariant to rotation (T72) [-]."""

    def _chosen(self, view):
        """Indices of the points. Raises DegenerateFeature: fewer than two are left."""
        count = len(view.shared(rays))
        if self.number > count or count - (self.number > 0) < 2:
            raise DegenerateFeature(f"{self.name}: found {count} points in this view, needed at least "
                                    f"{max(self.number, 3 if self.number else 2)}")
        return [k for k in range(count) if k != self.number - 1]

    def _invariant(self, view):
        """(I, cosines (n, n), rays (n, 3)). Raises DegenerateFeature: the points are seen in one direction."""
        s = view.shared(rays)[self._chosen(view)]
        first, second = np.triu_indices(len(s), 1)
        # |a x b|^2 and not 1 - (a . b)^2: small angles would be lost in rounding
        total = float(np.sum(np.cross(s[first], s[second]) ** 2))
        if not total > 0.0:
            raise DegenerateFeature(f"{self.name}: the points are seen in one direction")
        return total, s @ s.T, s

    def value(self, view):
        return self._invariant(view)[0] ** -0.5

    def row(self, view):
        total, cosines, s = self._invariant(view)
        np.fill_diagonal(cosines, 0.0)
        L = view.shared(ray_rows)[self._chosen(view)]
        # dI = -2 sum_(a < b) c_ab d(c_ab), and d(c_ab) = s_b . ds_a + s_a . ds_b; a rotation leaves c_ab as it is
        dI = -2.0 * np.einsum("ab,bi,aij->j", cosines, s, L[:, :, :3])
        return np.concatenate([-0.5 * total**-1.5 * dI, np.zeros(3)])


register_each(_Invariant, [("is", "i_s", "rotation invariant of the rays", NAVY)])
register_each(_Invariant, [("is", "i_{number}", "rotation invariant of the rays but {number}", GREENS)], family=True)


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
