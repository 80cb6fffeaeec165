"""Overlay `points`: followed points, the way of each through the image, and the lines from each to the next."""

import re
from typing import Sequence

import numpy as np

from aras_visual_servo import palette
from .base import Overlay, Scene, Shape, Way, register_overlay


@register_overlay("points")
def points(scene: Scene, names: Sequence[str]) -> Overlay:
    """Points of features xN, yN; of segments xmN, ymN, lN, alphaN their ends; of fewer features the true corners."""
    numbers = sorted({int(re.sub(r"\D", "", name)) for name in names})
    known = [n for n in numbers if {f"x{n}", f"y{n}"} <= set(names)]
    if known:
        found = [(n, *_stacked(scene, f"x{n}", f"y{n}")) for n in known]
    else:
        found = [end for n in numbers for end in _ends(scene, n, names)] or _corners(scene)
    ways = tuple(Way("point", str(n), palette.PALETTE[i % len(palette.PALETTE)], seen, wanted)
                 for i, (n, seen, wanted) in enumerate(found))
    if len(ways) < 2:
        return Overlay(ways)
    line = Shape("lines between the points", palette.BLUE, len(ways) > 2, np.stack([way.seen for way in ways], axis=1),
                 np.stack([way.wanted for way in ways]))
    return Overlay(ways, (line,))


def _stacked(scene, x, y):
    (x, x_wanted), (y, y_wanted) = scene.values(x), scene.values(y)
    return scene.pixels(np.stack([x, y], axis=-1)), scene.pixels(np.array([x_wanted, y_wanted]))


def _ends(scene, number, names):
    """[(N, seen, wanted), (N', ...)]: both ends of segment N, [] unless all four of its features are there."""
    four = [f"{part}{number}" for part in ("xm", "ym", "l", "alpha")]
    if not set(four) <= set(names):
        return []
    pairs = [scene.values(name) for name in four]

    def end(which, sign):
        x, y, length, alpha = (pair[which] for pair in pairs)
        half = 0.5 * sign * length
        return scene.pixels(np.stack([x + half * np.cos(alpha), y + half * np.sin(alpha)], axis=-1))

    return [(f"{number}{mark}", end(0, sign), end(1, sign)) for mark, sign in (("", -1.0), ("'", 1.0))]


def _corners(scene):
    [shape] = scene.outline("", palette.BLUE) or [None]
    return [] if shape is None else [(i + 1, shape.seen[:, i], shape.wanted[i]) for i in range(shape.seen.shape[1])][:8]
