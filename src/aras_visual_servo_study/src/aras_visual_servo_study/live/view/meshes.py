"""Meshes as small binary blocks that a page can draw: every vertex once, in steps of 1/65535 of the mesh's box.

A block is, little-endian: the number of vertices and of triangles (uint32 each), the lowest corner of the box and the
step along each axis (float32, 3 each), the vertices (uint16, 3 each), padding to four bytes, and the triangles (uint32,
3 each). `web/lib/meshes.js` reads it.
"""

import functools
from pathlib import Path
from typing import Union

import numpy as np

from aras_visual_servo import ModelError

STEPS = 65535


@functools.lru_cache(maxsize=128)
def mesh_block(path: str) -> bytes:
    """The block, bytes, of a mesh file. Raises ModelError: it cannot be read."""
    return as_block(triangles_of(path))


def as_block(corners: np.ndarray) -> bytes:
    """The block of triangles, float (n, 3, 3) [m]; corners that fall together become one vertex."""
    points = np.asarray(corners, dtype=float).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    step = np.maximum(high - low, 1e-9) / STEPS
    cells = np.round((points - low) / step).astype(np.uint16)
    # The three cells of a corner as one number sort ten times as fast as three numbers.
    packed, index = np.unique(cells.astype(np.uint64) @ np.array([1 << 32, 1 << 16, 1], np.uint64), return_inverse=True)
    vertices = np.stack([packed >> np.uint64(shift) & np.uint64(STEPS) for shift in (32, 16, 0)], axis=1)
    index = index.reshape(-1, 3)
    # A triangle with two corners in one cell has no area.
    index = index[(index[:, 0] != index[:, 1]) & (index[:, 1] != index[:, 2]) & (index[:, 2] != index[:, 0])]
    head = np.array([len(vertices), len(index)], "<u4").tobytes() + np.concatenate([low, step]).astype("<f4").tobytes()
    flat = vertices.astype("<u2").tobytes()
    return head + flat + bytes(-len(flat) % 4) + index.astype("<u4").tobytes()


def triangles_of(path: Union[str, Path]) -> np.ndarray:
    """Corners, float (n, 3, 3) [m], of a mesh file of any kind that the simulator reads. Raises ModelError."""
    from aras_visual_servo_sim import mesh_triangles  # C++: not needed to import this
    try:
        corners = mesh_triangles(str(path))
    except RuntimeError as error:
        raise ModelError(str(error)) from error
    if not np.isfinite(corners).all():
        raise ModelError(f"mesh '{path}': found numbers that are not finite")
    return corners
