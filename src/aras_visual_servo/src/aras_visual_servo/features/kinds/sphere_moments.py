"""Moments of the followed points on the unit sphere: `ug, vg, wg`, and the invariants to rotation `is`, `isN`.

`ug, vg, wg` are the moments of first order, m100, m010 and m001 over the number of points: the middle of the rays.

Of the moments of second order, I = m200 m020 + m200 m002 + m020 m002 - m110^2 - m101^2 - m011^2 does not change while
the camera turns, because a turn turns all rays rigidly. On the unit sphere it is the sum of sin^2 of the angles between
the points, over all pairs (docs/theory.md T72). `is` is 1 / sqrt(I), which grows about in proportion to the distance.
`isN` is the same of the points without point N. A pattern that is symmetric about the ray to its middle hardly changes
`is` as the camera moves aside, but it does change these, and three or more of them hold the translation. Together
with features of the rotation alone (`vxN, vyN, vzN`) they make a matrix of two blocks: turns and translations do not
disturb each other.

Reference: R. Tahri, Y. Mezouar, F. Chaumette, P. Corke, "Decoupled image-based visual servoing for cameras obeying the
unified projection model", IEEE T-RO 26(4), 2010.
"""

import numpy as np

from ...ground.errors import DegenerateFeature
from ..base import register_each
from ...palette import BLUE, GREEN, GREENS, NAVY, VERMILION
from ..points import OfPoints, ray_rows, rays


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
