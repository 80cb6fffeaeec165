"""Followed points projected on the unit sphere: `usN`, `vsN`, `wsN`, the direction of the ray to point N.

The rotation's part of the row, [s]x, is that of a rigid turn and has the same size everywhere, where that of x and y
grows with the square of the distance from the image centre. So views near the border of a wide lens are as well
conditioned as those in the middle.

Reference: T. Hamel, R. Mahony, "Visual servoing of an under-actuated dynamic rigid-body system: an image-based
approach", IEEE T-RA 18(2), 2002; R. Tahri, Y. Mezouar, F. Chaumette, P. Corke, "Decoupled image-based visual servoing
for cameras obeying the unified projection model", IEEE T-RO 26(4), 2010.
"""

from ..base import register_each
from ...palette import COOL, GREENS, WARM
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
