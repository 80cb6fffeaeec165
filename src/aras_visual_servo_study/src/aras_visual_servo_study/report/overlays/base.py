"""Overlays: what a run's features show in the camera's image, as points that move and lines that change, in pixels.

    @register_overlay("mine")
    def mine(scene, names):
        return Overlay(ways=(Way("middle", "", VERMILION, scene.pixels(...), scene.pixels(...)),))

A feature of the class attribute `overlay = "mine"` is then drawn so in the report and in the video.
"""

import functools
from dataclasses import dataclass
from typing import Optional, Tuple

import numpy as np

from aras_visual_servo import (ArasError, Feature, Outline, Registry, RunRecord, feature_class, scenario_from_dict,
                               spatial)
from ...live.view.projection import project

#: An outline of more corners is drawn through so many of them.
MOST_CORNERS = 32
#: Kind of overlay -> function of a `Scene` and the names of the features of this kind, which makes an `Overlay`.
OVERLAYS = Registry("overlay", __package__)
register_overlay = OVERLAYS.register


@dataclass(frozen=True)
class Way:
    """A point that moves through the image.

    Attributes:
        name, subscript: of the point.  colour: "#rrggbb".
        seen: (n, 2) u, v at each image of the servo phase, NaN where unknown [px].
        wanted: (2,) where it is at the goal, NaN where unknown [px].
    """

    name: str
    subscript: str
    colour: str
    seen: np.ndarray
    wanted: np.ndarray


@dataclass(frozen=True)
class Shape:
    """A line of k points that changes with the image.

    Attributes:
        name, colour.  closed: whether the last point is joined to the first.
        seen: (n, k, 2) at each image of the servo phase [px].  wanted: (k, 2) at the goal [px], or None: it has none.
    """

    name: str
    colour: str
    closed: bool
    seen: np.ndarray
    wanted: np.ndarray


@dataclass(frozen=True)
class Overlay:
    """What is drawn into an image: ways and shapes. difference: the image is coloured by its difference from the goal
    image, because the features are its grey levels."""

    ways: tuple = ()
    shapes: tuple = ()
    difference: bool = False


def overlay_of(record: RunRecord) -> Optional[Overlay]:
    """`Overlay` of a RunRecord's features; None for a record without camera_info or servo phase."""
    if not record.camera_info or not len(record.servo_rows) or not len(record.rows("teach")):
        return None
    kinds = {}
    for name in record.feature_names:
        kinds.setdefault((feature_class(name) or Feature).overlay, []).append(name)
    scene = Scene(record)
    parts = [OVERLAYS[kind](scene, names) for kind, names in kinds.items() if kind in OVERLAYS]
    ways = {way.name + way.subscript: way for part in parts for way in part.ways if np.isfinite(way.seen).any()}
    shapes = {shape.name: shape for part in parts for shape in part.shapes if np.isfinite(shape.seen).any()}
    return Overlay(tuple(ways.values()), tuple(shapes.values()), any(part.difference for part in parts))


class Scene:
    """A run as overlays see it: the features of its servo phase, and where the target truly was.

    Attributes: record.  rows: of the servo phase, n.  goal: row of the taught view.  width, height: of the image [px].
    """

    def __init__(self, record: RunRecord):
        self.record, self.rows, self.goal = record, record.servo_rows, record.taught_row
        self.width, self.height = int(record.camera_info["width"]), int(record.camera_info["height"])
        self.focal_px = float(record.camera_info["K"][0])

    def pixels(self, xy: np.ndarray) -> np.ndarray:
        """(..., 2) pixels of normalised image coordinates (..., 2); NaN stays NaN."""
        xy = np.asarray(xy, dtype=float)
        return project(xy.reshape(-1, 2), self.record.camera_info).reshape(xy.shape)

    def rays(self, pixels: np.ndarray) -> np.ndarray:
        """(k, 2) normalised image coordinates of pixels (k, 2), for a camera without a lens."""
        K = np.array(self.record.camera_info["K"], dtype=float).reshape(3, 3)
        return (np.asarray(pixels, dtype=float) - K[:2, 2]) / K[[0, 1], [0, 1]]

    def values(self, name: str) -> Tuple[np.ndarray, float]:
        """((n,) values of a feature, its value at the goal)."""
        column = self.record.feature_names.index(name)
        wanted = self.record.s_star[self.rows, column]
        wanted = wanted[np.isfinite(wanted)]
        return self.record.s[self.rows, column], wanted[-1] if len(wanted) else np.nan

    @functools.cached_property
    def target(self) -> Tuple[np.ndarray, np.ndarray]:
        """((n, 4, 4) true pose of the target in the camera, (4, 4) at the goal), NaN where unknown."""
        record, rows = self.record, np.append(self.rows, self.goal)
        if record.X_WT is None and record.target_poses is None:
            return np.full((len(self.rows), 4, 4), np.nan), np.full((4, 4), np.nan)
        X_WT = [record.X_WT if record.target_poses is None else record.target_poses[row] for row in rows]
        found = [spatial.inverse(record.X_WC[row]) @ X for row, X in zip(rows, X_WT)]
        return np.array(found[:-1]), found[-1]

    def seen_in(self, points_T: np.ndarray, X_CT: np.ndarray) -> np.ndarray:
        """(..., k, 2) pixels of points (k, 3) of the target's frame from X_CT (..., 4, 4); NaN behind the camera."""
        points = np.einsum("...ij,kj->...ki", X_CT[..., :3, :3], points_T) + X_CT[..., None, :3, 3]
        depth = np.where(points[..., 2:] > 1e-6, points[..., 2:], np.nan)
        return self.pixels(points[..., :2] / depth)

    def outline(self, name: str, colour: str) -> Tuple[Shape, ...]:
        """Shapes, none or one: the target's outline as its true pose shows it."""
        corners = self.corners
        if corners is None:
            return ()
        shown = corners[np.unique(np.linspace(0, len(corners) - 1, min(MOST_CORNERS, len(corners))).astype(int))]
        now, then = self.target
        return (Shape(name, colour, True, self.seen_in(shown, now), self.seen_in(shown, then)),)

    @functools.cached_property
    def corners(self) -> Optional[np.ndarray]:
        """(k, 3) of the target's first outline in its frame [m], None where it is unknown."""
        try:
            outline = Outline.of(scenario_from_dict(self.record.settings))
        except (ArasError, RuntimeError, KeyError, TypeError, AttributeError, IndexError):  # a record of another place
            return None
        return None if outline is None else outline.points_T


def circle(middle: np.ndarray, radius: np.ndarray, points: int = 24) -> np.ndarray:
    """(..., points, 2) of circles about (..., 2) of radius (...)."""
    angle = np.linspace(0.0, 2.0 * np.pi, points, endpoint=False)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    return np.asarray(middle)[..., None, :] + np.asarray(radius)[..., None, None] * way
