"""Meshes as small binary blocks that a page can draw: every vertex once, in steps of 1/65535 of the mesh's box.

A block is, little-endian: the number of vertices and of triangles (uint32 each), the lowest corner of the box and the
step along each axis (float32, 3 each), the vertices (uint16, 3 each), padding to four bytes, and the triangles (uint32,
3 each). `web/lib/meshes.js` reads it.
"""

import functools
from pathlib import Path

import numpy as np

from ...ground.errors import ModelError

STEPS = 65535
_STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


@functools.lru_cache(maxsize=128)
def mesh_block(path):
    """The block, bytes, of a mesh file. Raises ModelError: it cannot be read, or it is of a kind that no page draws."""
    return as_block(triangles_of(Path(path)))


def as_block(corners):
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


def triangles_of(path):
    """Corners, float (n, 3, 3), of a mesh file, in the file's unit. Raises ModelError."""
    read = {".stl": _stl, ".obj": _obj}.get(path.suffix.lower())
    if read is None:
        raise ModelError(f"mesh '{path}': found a {path.suffix or 'file without ending'}, allowed .stl, .obj")
    try:
        corners = read(path)
    except (OSError, ValueError, IndexError) as error:
        raise ModelError(f"mesh '{path}': cannot be read: {error}") from error
    if not len(corners) or not np.isfinite(corners).all():
        raise ModelError(f"mesh '{path}': found no triangle or numbers that are not finite")
    return corners


def _stl(path):
    content = path.read_bytes()
    count = int.from_bytes(content[80:84], "little")
    if len(content) == 84 + 50 * count:
        return np.frombuffer(content, _STL_TRIANGLE, count, 84)["corners"].astype(float)
    words = content.decode("ascii").split()
    numbers = [words[i + 1:i + 4] for i, word in enumerate(words) if word == "vertex"]
    return np.array(numbers, dtype=float).reshape(-1, 3, 3)


def _obj(path):
    points, corners = [], []
    for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(word.split("/")[0]) for word in words[1:]]
            face = [points[i - 1 if i > 0 else i] for i in face]
            corners += [[face[0], a, b] for a, b in zip(face[1:], face[2:])]
    return np.array(corners, dtype=float).reshape(-1, 3, 3)
