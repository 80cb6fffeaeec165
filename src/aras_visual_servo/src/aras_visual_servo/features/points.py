"""Features of followed points: their coordinates, and the segments from each to the next (docs/theory.md T26, T27).

`xN` and `yN` are the normalised coordinates of point N = 1, 2, ... (`MomentFeatures.point_x`, `.point_y`). `points4` in
a list of features stands for x1, y1, ..., x4, y4. `xmN`, `ymN`, `lN` and `alphaN` are the middle, the length and the
direction of the segment from point N to the next one; the last point's segment ends at the first point.

The inverse depth 1/Z of a point comes from the target's plane, or from the view's `inverse_depths` where it has them:
those at the goal, or those of the depth image (`MomentFeatures.point_z`).
"""

from math import atan2, hypot
from typing import Any, List, Tuple

import numpy as np

from ..ground.errors import DegenerateFeature
from ..spatial import skew
from .base import POINT_SOURCES, Feature, View, register_each
from ..palette import COOL, GREENS, PURPLES, WARM


def points(view: View) -> List[Tuple[float, float]]:
    """[(x, y)], normalised coordinates of the followed points. Raises DegenerateFeature: the view shows none."""
    return points_seen(view.features)


def points_seen(features: Any) -> List[Tuple[float, float]]:
    """[(x, y)] of the `Features` of an image. Raises DegenerateFeature: it shows none."""
    x, y = features.point_x, features.point_y
    if not 0 < len(x) == len(y):
        raise DegenerateFeature(f"points: found {len(x)} x and {len(y)} y in this view, needed at least one of each")
    return list(zip(x, y))


def depths_in_image(features: Any) -> np.ndarray:
    """(N,) depths Z of the followed points by the depth image [m]. Raises DegenerateFeature: one is missing."""
    count, Z = len(points_seen(features)), np.array(getattr(features, "point_z", ()), dtype=float)
    if len(Z) != count:
        raise DegenerateFeature("depth image: " + (getattr(features, "depth_fault", "") or "found no depths of the "
                                "points; set vision.depth, or vision.matches.depth with source matches"))
    holes = np.flatnonzero(~(np.isfinite(Z) & (Z > 0.0)))
    if len(holes):
        raise DegenerateFeature(f"depth image: a hole at point {', '.join(str(hole + 1) for hole in holes)}")
    return Z


def point_rows(view: View) -> np.ndarray:
    """L of (x1, y1, ..., xN, yN), (2 N, 6) (T26). Raises DegenerateFeature: the goal had another number of points."""
    rows, depths = [], view.inverse_depths
    seen = view.shared(points)
    if depths is None:
        A, B, C = view.plane
        depths = [A * x + B * y + C for x, y in seen]
    elif len(depths) != len(seen):
        raise DegenerateFeature(f"points: found {len(seen)} in this view, {len(depths)} at the goal")
    for (x, y), over_Z in zip(seen, depths):
        rows.append((-over_Z, 0.0, x * over_Z, x * y, -(1.0 + x * x), y))
        rows.append((0.0, -over_Z, y * over_Z, 1.0 + y * y, -x * y, -x))
    return np.array(rows)


def rays(view: View) -> np.ndarray:
    """(N, 3) unit vectors towards the followed points, which a wide lens may see beside and behind the camera, too.

    Raises DegenerateFeature: the view shows none.
    """
    seen = getattr(view.features, "ray_x", ())
    if len(seen):
        s = np.array([seen, view.features.ray_y, view.features.ray_z]).T
        return s / np.linalg.norm(s, axis=1)[:, None]
    ahead = np.array([(x, y, 1.0) for x, y in view.shared(points)])
    return ahead / np.linalg.norm(ahead, axis=1)[:, None]


def ray_rows(view: View) -> np.ndarray:
    """L of the rays, (N, 3, 6): [-(1 - s s^T) / r, [s]x], with r the distance of the point (docs/theory.md T72)."""
    s, depths = view.shared(rays), view.inverse_depths
    over_r = s @ np.array(view.plane) if depths is None else np.array(depths) * s[:, 2]
    if len(over_r) != len(s):
        raise DegenerateFeature(f"points: found {len(s)} in this view, {len(over_r)} at the goal")
    L = np.empty((len(s), 3, 6))
    L[:, :, :3] = over_r[:, None, None] * (s[:, :, None] * s[:, None, :] - np.eye(3))
    L[:, :, 3:] = [skew(one) for one in s]
    return L


#: Attributes of a direction. Points have an order, so it is known to 2 pi.
DIRECTION = {"unit": "rad", "angle": True, "directed": True}


class OfPoints(Feature):
    sees_tilt, overlay, also_from = True, "points", POINT_SOURCES

    def _ends(self, view):
        """Indices of this point and of the next one. Raises DegenerateFeature: the view shows fewer points."""
        count = len(view.shared(points))
        return self._index(count), self.number % count

    def _index(self, count):
        """Index of this point of so many. Raises DegenerateFeature: there are fewer."""
        if self.number > count:
            raise DegenerateFeature(f"{self.name}: found {count} points in this view, needed at least {self.number}")
        return self.number - 1


class _Coordinate(OfPoints):
    """x or y of a point [-]."""

    def value(self, view):
        return view.shared(points)[self._ends(view)[0]][self.index]

    def row(self, view):
        return view.shared(point_rows)[2 * self._ends(view)[0] + self.index]


register_each(_Coordinate, (("x", "x_{number}", "point {number} in x", COOL),
                            ("y", "y_{number}", "point {number} in y", WARM)), family=True)


class _Segment(OfPoints):
    """Length of a segment [-] (index 0), or its direction, from its first point to the next [rad] (index 1)."""

    def value(self, view):
        (x, y), (x_next, y_next) = (view.shared(points)[end] for end in self._ends(view))
        dx, dy = x_next - x, y_next - y
        return atan2(dy, dx) if self.index else hypot(dx, dy)

    def row(self, view):
        here, following = self._ends(view)
        seen, L = view.shared(points), view.shared(point_rows)
        dx, dy = seen[following][0] - seen[here][0], seen[following][1] - seen[here][1]
        length = hypot(dx, dy)
        if not length > 0.0:
            raise DegenerateFeature(f"{self.name}: the segment has no length, two followed points coincide")
        cosine, sine = dx / length, dy / length
        L_dx, L_dy = L[2 * following] - L[2 * here], L[2 * following + 1] - L[2 * here + 1]
        return (cosine * L_dy - sine * L_dx) / length if self.index else cosine * L_dx + sine * L_dy


register_each(_Segment, [("l", "l_{number}", "length of segment {number}", GREENS)], family=True)
register_each(_Segment, [("alpha", "α_{number}", "direction of segment {number}", PURPLES)], 1, True, **DIRECTION)


class _Middle(OfPoints):
    """x or y of the middle of a segment [-]."""

    def value(self, view):
        seen = view.shared(points)
        return 0.5 * sum(seen[end][self.index] for end in self._ends(view))

    def row(self, view):
        here, following = self._ends(view)
        L = view.shared(point_rows)
        return 0.5 * (L[2 * here + self.index] + L[2 * following + self.index])


register_each(_Middle, (("xm", "x_m{number}", "middle of segment {number} in x", COOL),
                        ("ym", "y_m{number}", "middle of segment {number} in y", WARM)), family=True)
