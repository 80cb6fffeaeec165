"""Textured things for scenes: boxes, cans and prisms of the size of groceries, painted by a seeded program."""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Dict

import numpy as np

from . import board as boards

#: Size of a texel of the things [m], seed of the first thing's picture, shapes in a square decimetre of a picture.
TEXEL_M, SEED, SHAPES_PER_DM2, LARGEST_PX = 0.0005, 31, 120, 80.0
SIDES = 16  # of a can


@dataclass(frozen=True)
class Prop:
    """One thing: a prism of `corners` [m], counter-clockwise about its middle, and of a height, upright on z."""

    name: str
    corners: np.ndarray
    height_m: float


def _box(name, x, y, z):
    return Prop(name, 0.5 * np.array([(x, -y), (x, y), (-x, y), (-x, -y)]), z)


def _round(name, radius, z, sides=SIDES):
    angles = 2.0 * math.pi * np.arange(sides) / sides
    return Prop(name, radius * np.stack([np.cos(angles), np.sin(angles)], axis=1), z)


#: The things: lengths are those of what stands in kitchens.
PROPS = (_box("box_flat", 0.16, 0.11, 0.035), _box("box_tall", 0.07, 0.05, 0.17), _box("box_cube", 0.075, 0.075, 0.075),
         _box("box_book", 0.20, 0.14, 0.025), _box("box_bar", 0.15, 0.045, 0.03), _box("box_tea", 0.13, 0.07, 0.06),
         _round("can_soup", 0.034, 0.10), _round("can_fish", 0.043, 0.035), _round("can_large", 0.05, 0.13),
         _round("can_small", 0.027, 0.06), _round("prism_six", 0.045, 0.09, 6), _round("prism_three", 0.06, 0.11, 3))


def save_props(folder: Path) -> Dict[str, Path]:
    """Write the things, NAME.obj with .mtl and .png each; files that are there are taken. Returns {name: path}."""
    folder.mkdir(parents=True, exist_ok=True)
    for number, prop in enumerate(PROPS):
        if not (folder / f"{prop.name}.obj").exists():
            _save(folder, prop, SEED + number)
    return {prop.name: (folder / f"{prop.name}.obj").resolve() for prop in PROPS}


def _save(folder, prop, seed):
    """The sides are one strip of the picture, side by side; both ends lie beneath it."""
    points = np.asarray(prop.corners)
    ring = np.vstack([points, points[:1]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(ring, axis=0), axis=1))])
    low, extent = points.min(axis=0), np.ptp(points, axis=0)
    width_m = max(along[-1], 2.0 * extent[0])
    height_m = prop.height_m + extent[1]
    size_px = math.ceil(width_m / TEXEL_M), math.ceil(height_m / TEXEL_M)
    shapes = math.ceil(SHAPES_PER_DM2 * 100.0 * width_m * height_m)
    boards.save(folder / f"{prop.name}.png", boards.draw(seed, size_px, shapes, LARGEST_PX))
    (folder / f"{prop.name}.mtl").write_text(f"newmtl picture\nKa 1 1 1\nKd 1 1 1\nmap_Kd {prop.name}.png\n",
                                             encoding="utf-8")
    vertices, coordinates, normals, faces = [], [], [], []

    def vertex(place, coordinate):
        vertices.append(place)
        coordinates.append((coordinate[0] / width_m, 1.0 - coordinate[1] / height_m))

    def face(normal, count):
        normals.append(normal)
        first = len(vertices) - count + 1
        faces.extend([(first, first + k, first + k + 1, len(normals)) for k in range(1, count - 1)])

    half = 0.5 * prop.height_m
    for (a, b), (s, t) in zip(zip(ring[:-1], ring[1:]), zip(along[:-1], along[1:])):
        for place, coordinate in ((*a, -half), (s, prop.height_m)), ((*b, -half), (t, prop.height_m)), \
                ((*b, half), (t, 0.0)), ((*a, half), (s, 0.0)):
            vertex(place, coordinate)
        normal = np.array([b[1] - a[1], a[0] - b[0], 0.0])
        face(normal / np.linalg.norm(normal), 4)
    for up, order, shift in ((1.0, 1, 0.0), (-1.0, -1, extent[0])):
        for x, y in points[::order]:
            vertex((x, y, up * half), (shift + x - low[0], prop.height_m + y - low[1]))
        face((0.0, 0.0, up), len(points))
    lines = [f"mtllib {prop.name}.mtl", *("v %.6g %.6g %.6g" % tuple(v) for v in vertices),
             *("vt %.6g %.6g" % c for c in coordinates), *("vn %.6g %.6g %.6g" % tuple(n) for n in normals),
             "usemtl picture", *(f"f {a}/{a}/{n} {b}/{b}/{n} {c}/{c}/{n}" for a, b, c, n in faces), ""]
    (folder / f"{prop.name}.obj").write_text("\n".join(lines), encoding="utf-8")
