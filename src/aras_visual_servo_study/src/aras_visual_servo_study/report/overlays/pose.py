"""Overlays of the camera's pose: `pose`, the target's frame as the servo measures it; `reference`, the reference point
of law `hybrid` with a ring that tells its depth."""

from typing import Sequence

import numpy as np

from aras_visual_servo import palette, spatial
from .base import Overlay, Scene, Shape, Way, circle, register_overlay

DISPLACEMENT = ("tx", "ty", "tz", "rx", "ry", "rz")
#: Length of the axes and radius of the ring, as parts of the image's width.
AXIS, RING = 0.13, 0.03


@register_overlay("pose")
def pose(scene: Scene, names: Sequence[str]) -> Overlay:
    """The target's axes: where the measured displacement puts them, or where they are if not all of it is measured."""
    now, then = scene.target
    if set(DISPLACEMENT) <= set(names):
        s = np.stack([scene.values(name)[0] for name in DISPLACEMENT], axis=-1)
        now = np.array([_displaced(one, then) for one in s])
    length = AXIS * scene.width / scene.focal_px * abs(then[2, 3])
    axes = [Shape(f"{name} of the target", colour, False, *(scene.seen_in(ends, X) for X in (now, then)))
            for name, colour, ends in zip("xyz", (palette.VERMILION, palette.GREEN, palette.BLUE),
                                          np.stack([np.zeros((3, 3)), length * np.eye(3)], axis=1))]
    middle = np.zeros((1, 3))
    way = Way("origin of the target", "", palette.PURPLE, scene.seen_in(middle, now)[:, 0],
              scene.seen_in(middle, then)[0])
    return Overlay((way,), (*axes, *scene.outline("outline, by the true pose", palette.BLUE)))


def _displaced(s, X_CgT):
    """X_CT of a displacement (6,): p_CgC, theta u of R_CgC."""
    known = np.isfinite(s).all()
    X_CgC = spatial.transform(spatial.rotation(s[3:]), s[:3])
    return spatial.inverse(X_CgC) @ X_CgT if known else np.full((4, 4), np.nan)


@register_overlay("reference")
def reference(scene: Scene, names: Sequence[str]) -> Overlay:
    """The reference point; its ring is the larger, the nearer it is, and has its size at the goal when Z = Z*."""
    if not {"xr", "yr"} <= set(names):
        return Overlay()
    (x, x_wanted), (y, y_wanted) = scene.values("xr"), scene.values("yr")
    seen, wanted = scene.pixels(np.stack([x, y], axis=-1)), scene.pixels(np.array([x_wanted, y_wanted]))
    way = Way("reference point", "", palette.PURPLE, seen, wanted)
    if "zr" not in names:
        return Overlay((way,))
    z, z_wanted = scene.values("zr")
    radius = RING * scene.width
    ring = Shape("ring: larger is nearer", palette.GREEN, True, circle(seen, radius * np.exp(-z)),
                 circle(wanted, radius * np.exp(-z_wanted)))
    return Overlay((way,), (ring,))
