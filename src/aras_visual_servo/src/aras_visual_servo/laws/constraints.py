"""Hard constraints of the laws `qp` and `mpc`: visibility of the target, and walls for the camera.

Each constraint is a slack h >= 0: a distance of a point from a border of the view, or of the camera from a wall. Its
rate is a row times the camera's twist, h_dot = row V_C. A law asks for h_dot >= -rate_per_s h (control barrier
function): a positive slack shrinks no faster than this, and a violated one opens again at this rate.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Dict, NamedTuple, Optional, Tuple

import numpy as np

from ..features.base import View
from ..config.settings import setting
from ..features.points import point_rows, points
from ..ground.errors import DegenerateFeature

NOT_ZERO = ("three numbers, not all 0", lambda normal: any(normal))
BORDERS = ("left", "right", "upper", "lower")


@dataclass(frozen=True)
class WallSettings:
    """A plane that the camera stays on one side of."""

    normal: Tuple[float, ...] = setting(
        size=3, condition=NOT_ZERO, help="Direction away from the wall, in the robot's base, of any length.")
    offset_m: float = setting(
        unit="m",
        help="Distance of the wall from the base's origin along the normal; the optical centre stays beyond it.")


@dataclass(frozen=True)
class ConstraintSettings:
    """Constraints of the laws `qp` and `mpc` in addition to the joint limits."""

    half_width: Optional[float] = setting(
        None, above=0,
        help="Half the width of the view (tangent of half the field of view) for the followed points, or without "
             "points the object; none: no constraint.")
    half_height: Optional[float] = setting(None, above=0, help="Half the height of the view, likewise.")
    margin: float = setting(
        0.05, at_least=0, help="Margin to the border of the view, in normalised coordinates.")
    extent: float = setting(
        2.0, above=0, help="Without points: size of the object, in standard deviations from its centroid.")
    least_depth_m: float = setting(
        0.1, unit="m", above=0,
        help="Smallest depth of the followed points, or without points of the object's centroid.")
    walls: Dict[str, WallSettings] = setting(
        {},
        help="Planes by name, e.g. `{table: {normal: [0, 0, 1], offset_m: 0.2}}`. The camera stays on the side of the "
             "normal.")
    rate_per_s: float = setting(
        5.0, unit="1/s", above=0, help="The distance to a border or wall shrinks at this rate at most.")
    slack: bool = setting(
        True,
        help="If no motion within the joint limits keeps view and walls: `true` takes the motion that violates them "
             "least and reports by how much, `false` stands still.")
    damping: float = setting(
        0.001, above=0,
        help="Relative weight of changes of the joint velocities against the features' rates.")

    @cached_property
    def borders(self) -> Tuple[Tuple[int, float, float, str], ...]:
        """(axis, sign, half less margin, name) of each border that is kept: x (axis 0) or y (axis 1) has the room
        half less margin plus sign times itself there."""
        return tuple((axis, sign, half - self.margin, BORDERS[2 * axis + k])
                     for axis, half in enumerate((self.half_width, self.half_height)) if half is not None
                     for k, sign in enumerate((1.0, -1.0)))

    @cached_property
    def planes(self) -> Tuple[Tuple[str, ...], np.ndarray, np.ndarray]:
        """(names of the walls' rooms, their normals of length 1, (k, 3), their offsets, (k,))."""
        normals = np.array([wall.normal for wall in self.walls.values()], dtype=float)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        offsets = np.array([wall.offset_m for wall in self.walls.values()])
        return tuple(f"wall '{name}'" for name in self.walls), normals, offsets


class Rooms(NamedTuple):
    """m constraints.  names: tuple of texts.  h: (m,) distances.  rows: (m, 6), h_dot = rows V_C."""

    names: Tuple[str, ...]
    h: np.ndarray
    rows: np.ndarray


def rooms_of(settings: ConstraintSettings, view: View, X_BC: np.ndarray) -> Rooms:
    """`Rooms` of one view.

    Args: settings: `ConstraintSettings`.  view: `View` with a plane.  X_BC: (4, 4) pose of the camera in the base.
    Raises DegenerateFeature: the depth of a point is not positive, or it is unknown.
    """
    parts = []
    for axis, half in enumerate((settings.half_width, settings.half_height)):
        if half is not None:
            parts.append(_in_view(view, axis, half - settings.margin, settings.extent))
    parts.append(_deep_enough(view, settings.least_depth_m))
    if settings.walls:
        parts.append(_before_walls(settings.planes, X_BC))
    rooms = Rooms(sum((part.names for part in parts), ()), np.concatenate([part.h for part in parts]),
                  np.concatenate([part.rows for part in parts]))
    if not (np.isfinite(rooms.h).all() and np.isfinite(rooms.rows).all()):
        raise DegenerateFeature("constraints: a point of the target has no finite place or depth in this view")
    return rooms


def points_in_space(view: View, xy: np.ndarray) -> np.ndarray:
    """(3, n) places in the camera of points with the normalised coordinates xy, (n, 2) [m].

    Raises DegenerateFeature: a depth is not positive, or not known.
    """
    over_Z = view.inverse_depths
    if over_Z is None or len(over_Z) != len(xy):
        A, B, C = view.plane
        over_Z = xy @ (A, B) + C
    over_Z = np.asarray(over_Z, dtype=float)
    if not (np.isfinite(over_Z) & (over_Z > 0.0)).all():
        raise DegenerateFeature(f"constraints: found the inverse depths {over_Z} of the target, allowed > 0")
    places = np.ones((3, len(xy)))
    places[:2] = xy.T
    places /= over_Z
    return places


def _deep_enough(view, least_m):
    """Rooms of the depths of the points, or of the point of the target that the centroid shows."""
    followed = len(view.features.point_x)
    xy = np.array(view.shared(points)) if followed else np.array([[view.features.xg, view.features.yg]])
    X, Y, Z = points_in_space(view, xy)
    rows = np.zeros((len(xy), 6))
    rows[:, 2], rows[:, 3], rows[:, 4] = -1.0, -Y, X  # Z_dot of a point at rest
    return Rooms(_names(followed, "before the camera"), Z - least_m, rows)


def _in_view(view, axis, half, extent):
    """Rooms to the two borders that x (axis 0) or y (axis 1) may reach, `half` from the middle."""
    followed = len(view.features.point_x)
    if followed:
        at = np.array([point[axis] for point in view.shared(points)])
        rows = view.shared(point_rows)[axis::2]
        low, high, L_low, L_high = at, at, rows, rows
    else:
        low, high, L_low, L_high = edges(view, axis, extent)
    names = _names(followed, *(f"at the {border} border" for border in BORDERS[2 * axis:2 * axis + 2]))
    return Rooms(names, np.hstack([half + low, half - high]), np.vstack([L_low, -L_high]))


def edges(view: View, axis: int, extent: float) -> Tuple[float, float, np.ndarray, np.ndarray]:
    """(low, high, L of low, L of high), L of shape (6,): where the object begins and ends along x (axis 0) or y (1).

    Args: extent: standard deviations from its centroid to its edges.  Raises DegenerateFeature: it has no extent.
    """
    i, j = ((2, 0), (0, 2))[axis]
    area, n = view.features.area, view.mu[f"{i}{j}"] / view.features.area
    if not n > 0.0:
        raise DegenerateFeature("constraints: the object has no extent in this view")
    at, L = (view.features.xg, view.features.yg)[axis], view.L_centroid()[axis]
    spread = extent * n**0.5
    L_spread = (view.L_mu(i, j) - n * view.L_area()) / area * (0.5 * extent / n**0.5)
    return at - spread, at + spread, L - L_spread, L + L_spread


def _before_walls(planes, X_BC):
    """Rooms of the optical centre to walls. Args: planes: `ConstraintSettings.planes`."""
    names, normals, offsets = planes
    rows = np.zeros((len(normals), 6))
    rows[:, :3] = normals @ X_BC[:3, :3]
    return Rooms(names, normals @ X_BC[:3, 3] - offsets, rows)


@lru_cache(maxsize=64)
def _names(followed, *wheres):
    """Names of the rooms of so many followed points at each of these places; of the object, where none is followed."""
    things = [f"point {i + 1}" for i in range(followed)] if followed else ["the object"]
    return tuple(f"{thing} {where}" for where in wheres for thing in things)
