"""Overlay `moments`: the target's centroid, its axis, a circle of its area; for features of its shape, its outline."""

from typing import Sequence

import numpy as np

from aras_visual_servo import palette
from .base import Overlay, Scene, Shape, Way, circle, register_overlay

#: Half of the axis, as a part of the image's width.
AXIS = 0.11
PLACE, SIZE, TURN = {"xg", "yg", "xn", "yn"}, {"an"}, {"alpha"}


@register_overlay("moments")
def moments(scene: Scene, names: Sequence[str]) -> Overlay:
    """What the moments (area, xg, yg, alpha) of the record show."""
    raw, goal = scene.record.raw[scene.rows], scene.record.raw[scene.goal]
    shapes, others = [], set(names) - PLACE - SIZE - TURN
    if TURN & set(names):
        shapes.append(Shape("axis", palette.PURPLE, False, _axis(scene, raw), _axis(scene, goal)))
    if SIZE & set(names):
        shapes.append(Shape("circle of the same area", palette.BLUE, True, _disc(scene, raw), _disc(scene, goal)))
    if others:
        shapes += scene.outline("outline, by the true pose", palette.BLUE)
    way = Way("centroid", "", palette.VERMILION, scene.pixels(raw[:, 1:3]), scene.pixels(goal[1:3]))
    return Overlay((way,), tuple(shapes))


def _axis(scene, raw):
    """(..., 2, 2) ends of a line through the centroid along the orientation; raw: (..., 4)."""
    way = np.stack([np.cos(raw[..., 3]), np.sin(raw[..., 3])], axis=-1) * AXIS * scene.width / scene.focal_px
    return scene.pixels(np.stack([raw[..., 1:3] - way, raw[..., 1:3] + way], axis=-2))


def _disc(scene, raw):
    return scene.pixels(circle(raw[..., 1:3], np.sqrt(np.maximum(raw[..., 0], 0.0) / np.pi)))
