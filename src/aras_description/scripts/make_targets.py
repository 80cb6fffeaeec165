#!/usr/bin/env python3
"""Writes the planar targets to targets/*.yaml.

An outline is a simple polygon in the target's plane z = 0, counter-clockwise seen from +z (the face the camera sees),
with its area's centroid at the origin [m]. Run without arguments; the output is the same bytes on every run.
"""

import argparse
import pathlib

import numpy as np

DARK_RGB = (20, 20, 20)
DECIMALS = 6  # coordinates are written to the micrometre
SMOOTH_VERTICES = 240


def area_and_centroid(outline):
    """Signed area [m^2] and centroid [m], shape (2,), of a polygon of shape (n, 2)."""
    following = np.roll(outline, -1, axis=0)
    cross = outline[:, 0] * following[:, 1] - following[:, 0] * outline[:, 1]
    area = cross.sum() / 2.0
    return area, ((outline + following) * cross[:, None]).sum(axis=0) / (6.0 * area)


def centred(outline):
    """Counter-clockwise copy with the centroid at the origin, rounded as it is written."""
    outline = np.asarray(outline, dtype=float)
    area, centroid = area_and_centroid(outline)
    if area < 0.0:
        outline = outline[::-1]
    return np.round(outline - centroid, DECIMALS) + 0.0


def blob():
    """Smooth, elongated, clearly asymmetric closed curve: radius = 1 + sum a cos(k angle - phase), stretched in x."""
    angle = 2.0 * np.pi * np.arange(SMOOTH_VERTICES) / SMOOTH_VERTICES
    radius = 0.070 * (1.0 + 0.10 * np.cos(angle - 0.5) + 0.18 * np.cos(2.0 * angle - 0.3)
                      + 0.17 * np.cos(3.0 * angle - 3.6) + 0.04 * np.cos(4.0 * angle - 4.0))
    return np.stack([1.18 * radius * np.cos(angle), 0.92 * radius * np.sin(angle)], axis=1)


def l_shape():
    """L of 0.20 m x 0.14 m with arms of 0.06 m."""
    return [(0.0, 0.0), (0.20, 0.0), (0.20, 0.06), (0.06, 0.06), (0.06, 0.14), (0.0, 0.14)]


def rectangle():
    """Rectangle of 0.20 m x 0.12 m: its orientation repeats every 180 degrees."""
    return [(-0.10, -0.06), (0.10, -0.06), (0.10, 0.06), (-0.10, 0.06)]


def ellipse():
    """Ellipse of 0.20 m x 0.12 m: symmetric, no corners."""
    angle = 2.0 * np.pi * np.arange(SMOOTH_VERTICES) / SMOOTH_VERTICES
    return np.stack([0.10 * np.cos(angle), 0.06 * np.sin(angle)], axis=1)


SHAPES = (blob, l_shape, rectangle, ellipse)


def yaml_text(shape):
    """Content of the file of one shape."""
    lines = [
        f"# {shape.__doc__}",
        "# Made by scripts/make_targets.py. Outlines in metres, plane z = 0, counter-clockwise seen from +z.",
        f"name: {shape.__name__}",
        f"color_rgb: {list(DARK_RGB)}",
        "outlines_m:"]
    for index, (x, y) in enumerate(centred(shape())):
        lines.append(f"  {'- -' if index == 0 else '  -'} [{x:.{DECIMALS}f}, {y:.{DECIMALS}f}]")
    return "\n".join(lines) + "\n"


def targets():
    """File name -> text of each target."""
    return {shape.__name__ + ".yaml": yaml_text(shape) for shape in SHAPES}


def main():
    """Writes the files."""
    default = pathlib.Path(__file__).resolve().parent.parent / "targets"
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=pathlib.Path, default=default, help="folder to write to")
    output = parser.parse_args().output
    output.mkdir(parents=True, exist_ok=True)
    for name, content in targets().items():
        (output / name).write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
