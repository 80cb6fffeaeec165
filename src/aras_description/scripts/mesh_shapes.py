"""Closed triangle shapes for make_meshes.py: every function returns triangles of shape (n, 3, 3) [m].

Vertices run counter-clockwise seen from outside. Shapes are solid one by one and may overlap in a mesh.
"""

import numpy as np

RESOLUTION_M = 1e-5  # vertices are rounded to this, so that the last bits of sin and cos do not reach the files


def loft(rings):
    """Solid through rings of equal length, each counter-clockwise seen from the far (last) end, with flat caps.

    Args: rings: sequence of arrays, each of shape (k, 3) [m].
    Returns: Triangles, shape (n, 3, 3) [m].
    """
    rings = [np.asarray(ring, dtype=float) for ring in rings]
    triangles = []
    for low, high in zip(rings[:-1], rings[1:]):
        low_next, high_next = np.roll(low, -1, axis=0), np.roll(high, -1, axis=0)
        triangles.append(np.stack([low, low_next, high_next], axis=1))
        triangles.append(np.stack([low, high_next, high], axis=1))
    for ring, outward in ((rings[0], False), (rings[-1], True)):
        centre = np.broadcast_to(ring.mean(axis=0), ring.shape)
        following = np.roll(ring, -1, axis=0)
        triangles.append(np.stack([centre, ring, following] if outward else [centre, following, ring], axis=1))
    return np.concatenate(triangles)


def circle(radius, z, segments=36, centre=(0.0, 0.0)):
    """Ring of shape (segments, 3) in the plane z."""
    angle = 2.0 * np.pi * np.arange(segments) / segments
    return np.stack(
        [centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle), np.full(segments, z)], axis=1)


def rounded_rectangle(size_x, size_y, radius, z, centre=(0.0, 0.0), corner_segments=5):
    """Ring of shape (4 (corner_segments + 1), 3) in the plane z."""
    points = []
    for quadrant, (sign_x, sign_y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        angle = np.pi / 2.0 * (quadrant + np.arange(corner_segments + 1) / corner_segments)
        points.append(np.stack([
            centre[0] + sign_x * (size_x / 2.0 - radius) + radius * np.cos(angle),
            centre[1] + sign_y * (size_y / 2.0 - radius) + radius * np.sin(angle),
            np.full(corner_segments + 1, z)], axis=1))
    return np.concatenate(points)


def lathe(profile, segments=36):
    """Solid of revolution about z through (radius, z) pairs of increasing z."""
    return loft([circle(radius, z, segments) for radius, z in profile])


def cylinder(radius, low, high, chamfer=0.002, segments=36):
    """Cylinder along z from low to high with chamfered ends."""
    return lathe(((radius - chamfer, low), (radius, low + chamfer), (radius, high - chamfer), (radius - chamfer, high)),
                 segments)


def rounded_box(size, radius, centre=(0.0, 0.0, 0.0), chamfer=0.003, corner_segments=3):
    """Box with corners rounded about z and chamfered ends."""
    x, y, z = size
    inner = max(radius - chamfer, 1e-4)
    low, high = centre[2] - z / 2.0, centre[2] + z / 2.0
    return loft([
        rounded_rectangle(x - 2 * chamfer, y - 2 * chamfer, inner, low, centre[:2], corner_segments),
        rounded_rectangle(x, y, radius, low + chamfer, centre[:2], corner_segments),
        rounded_rectangle(x, y, radius, high - chamfer, centre[:2], corner_segments),
        rounded_rectangle(x - 2 * chamfer, y - 2 * chamfer, inner, high, centre[:2], corner_segments)])


def belt(radius_a, z_a, radius_b, z_b, y_low, y_high, chamfer=0.003, segments=16):
    """Plate in the x-z plane around two circles centred at (0, z_a) and (0, z_b), z_b > z_a, from y_low to y_high."""

    def ring(y, inset):
        r_a, r_b = radius_a - inset, radius_b - inset
        lean = np.arcsin((r_a - r_b) / (z_b - z_a))
        end_b = np.linspace(lean, np.pi - lean, segments)
        end_a = np.linspace(np.pi - lean, 2.0 * np.pi + lean, segments)
        x = np.concatenate([r_b * np.cos(end_b), r_a * np.cos(end_a)])
        z = np.concatenate([z_b + r_b * np.sin(end_b), z_a + r_a * np.sin(end_a)])
        return np.stack([x, np.full(x.shape, y), z], axis=1)[::-1]

    return loft([ring(y_low, chamfer), ring(y_low + chamfer, 0.0), ring(y_high - chamfer, 0.0), ring(y_high, chamfer)])


def along_y(triangles):
    """Turns z into y (rotation about x by -90 degrees)."""
    return triangles[..., [0, 2, 1]] * np.array([1.0, 1.0, -1.0])


def along_x(triangles):
    """Turns z into x (cyclic permutation of the axes)."""
    return triangles[..., [2, 0, 1]]


def moved(triangles, x=0.0, y=0.0, z=0.0):
    """Translated triangles."""
    return triangles + np.array([x, y, z])


def mirrored_pair(triangles):
    """The shape and its mirror image at the plane y = 0."""
    mirror = triangles[:, ::-1] * np.array([1.0, -1.0, 1.0])
    return np.concatenate([triangles, mirror])


def binary_stl(triangles):
    """Bytes of a binary STL file [m]; triangles that vanish at RESOLUTION_M are left out."""
    points = np.round(np.asarray(triangles) / RESOLUTION_M) * RESOLUTION_M
    edges = points[:, 1:] - points[:, :1]
    normals = np.cross(edges[:, 0], edges[:, 1])
    length = np.linalg.norm(normals, axis=1)
    keep = length > 0.01 * RESOLUTION_M**2
    points, normals = points[keep], normals[keep] / length[keep, None]
    records = np.zeros(len(points), dtype=[("normal", "<f4", 3), ("points", "<f4", (3, 3)), ("attribute", "<u2")])
    records["normal"] = np.round(normals, 4) + 0.0
    records["points"] = points + 0.0
    return b"aras_description".ljust(80) + np.uint32(len(points)).astype("<u4").tobytes() + records.tobytes()
