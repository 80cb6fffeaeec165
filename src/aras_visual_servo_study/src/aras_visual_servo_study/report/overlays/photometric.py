"""Overlay `photometric`: the image is coloured by how it differs from the goal image; a frame shows where the middle of
the goal image lies in it."""

from typing import Sequence

import numpy as np

from aras_visual_servo import palette
from .base import Overlay, Scene, Shape, Way, register_overlay

#: The frame reaches so far from the middle of the goal image to its border.
PART = 0.5


@register_overlay("photometric")
def photometric(scene: Scene, _names: Sequence[str]) -> Overlay:
    """The corners of the frame move as the target's plane does, by the true poses; without these there is none."""
    now, then = scene.target
    middle = np.array([0.5 * (scene.width - 1), 0.5 * (scene.height - 1)])
    corners = middle + PART * 0.5 * np.array([scene.width, scene.height]) * [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    rays = np.column_stack([scene.rays(corners), np.ones(4)])
    normal, p = then[:3, 2], then[:3, 3]
    on_plane = rays * (normal @ p / (rays @ normal))[:, None] - p
    points_T = on_plane @ then[:3, :3]  # R_CT^T applied to each
    seen, wanted = scene.seen_in(points_T, now), scene.seen_in(points_T, then)
    ways = tuple(Way("corner", str(i + 1), palette.PALETTE[i], seen[:, i], wanted[i]) for i in range(4))
    return Overlay(ways, (Shape("middle of the goal image", palette.PURPLE, True, seen, wanted),), difference=True)
