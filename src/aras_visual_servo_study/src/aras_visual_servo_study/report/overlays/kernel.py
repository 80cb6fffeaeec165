"""Overlay `kernel`: the centroid, and lines along which the kernels weigh the object alike."""

from typing import Sequence

import numpy as np

from aras_visual_servo import palette
from .base import Overlay, Scene, Shape, register_overlay
from .moments import moments

#: Weights of the lines; in the middle of the image the weight is 1.
WEIGHTS = (2.0, 1.5, 1.0, 0.75, 0.6)
POINTS = 9  # of a line, which a lens bends


@register_overlay("kernel")
def kernel(scene: Scene, names: Sequence[str]) -> Overlay:
    """Lines of equal x^-p and y^-q, which begin one pixel outside the image (docs/theory.md T47)."""
    settings = scene.record.settings.get("vision", {}).get("kernel") or {}
    size = np.array([scene.width, scene.height])
    (x0, y0), (x1, y1) = scene.rays([-np.ones(2), size])
    shapes = []
    for name, key, low, high, across, colour in (("kx", "p", x0, x1, (y0, y1), palette.BLUE),
                                                 ("ky", "q", y0, y1, (x0, x1), palette.GREEN)):
        if name not in names or not settings.get(key):
            continue
        along = np.linspace(*across, POINTS)
        for weight in WEIGHTS:
            at = low + 0.5 * (high - low) * weight ** (-1.0 / settings[key])
            line = np.column_stack([np.full(POINTS, at), along][::1 if name == "kx" else -1])
            seen = np.broadcast_to(scene.pixels(line), (len(scene.rows), POINTS, 2))
            shapes.append(Shape(f"weight {weight:g} of {name}", colour, False, seen, None))
    found = moments(scene, ["xg", "yg"])
    return Overlay(found.ways, tuple(shapes))
