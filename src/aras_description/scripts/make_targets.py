#!/usr/bin/env python3
"""Writes the planar targets to targets/*.yaml, and the pictures of two of them, photo.png and tag.png.

An outline is a simple polygon in the target's plane z = 0, counter-clockwise seen from +z (the face the camera sees),
with its area's centroid at the origin [m]. The picture is synthesised from a seed: smooth noise of many wavelengths, as
photographs have, and a few shapes. The tag's bits are those of its family's published codes, which OpenCV knows. Run
without arguments; the output is the same bytes on every run.
"""

import argparse
import pathlib
import struct
import zlib

import numpy as np

DARK_RGB = (20, 20, 20)
DECIMALS = 6  # coordinates are written to the micrometre
SMOOTH_VERTICES = 240
PHOTO_TEXELS = (400, 300)  # width, height
PHOTO_SIZE_M = (0.30, 0.225)
PHOTO_SEED = 1
#: An AprilTag: family, number, modules from edge to edge of its black square, white modules around it, pixels and
#: length of a module.
TAG_FAMILY, TAG_NUMBER, TAG_MODULES, TAG_MARGIN = "36h11", 0, 8, 1
TAG_MODULE_PX, TAG_MODULE_M = 40, 0.02


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


def smooth_noise(generator, cells, width, height):
    """Noise of (height, width) in -1 .. 1: random values on a grid of that many cells across, blended smoothly."""
    rows = max(1, round(cells * height / width))
    grid = generator.uniform(-1.0, 1.0, size=(rows + 1, cells + 1))

    def positions(count, n):
        at = (np.arange(count) + 0.5) / count * n
        whole = np.minimum(at.astype(int), n - 1)
        part = at - whole
        return whole, part * part * (3.0 - 2.0 * part)

    j, b = positions(height, rows)
    i, a = positions(width, cells)
    left = grid[:, i] * (1.0 - a) + grid[:, i + 1] * a
    return left[j] * (1.0 - b)[:, None] + left[j + 1] * b[:, None]


def photo_pixels(seed=PHOTO_SEED):
    """Grey picture, (height, width) uint8: noise whose amplitude falls with its wavelength, ellipses and bars on it."""
    width, height = PHOTO_TEXELS
    generator = np.random.RandomState(seed)  # its streams never change from one version of numpy to the next
    grey = sum(smooth_noise(generator, cells, width, height) * amplitude
               for cells, amplitude in ((3, 60.0), (6, 42.0), (12, 30.0), (25, 20.0)))
    y, x = np.mgrid[0:height, 0:width] + 0.5
    for _ in range(9):
        centre = generator.uniform((0.08 * width, 0.08 * height), (0.92 * width, 0.92 * height))
        half_x, half_y = generator.uniform(0.02, 0.11, size=2) * width
        angle, level = generator.uniform(0.0, np.pi), generator.uniform(-90.0, 90.0)
        along = ((x - centre[0]) * np.cos(angle) + (y - centre[1]) * np.sin(angle)) / half_x
        beside = ((y - centre[1]) * np.cos(angle) - (x - centre[0]) * np.sin(angle)) / half_y
        inside = along**2 + beside**2 < 1.0 if generator.uniform() < 0.6 else np.maximum(abs(along), abs(beside)) < 1.0
        grey = np.where(inside, 0.4 * grey + level, grey)
    return np.clip(np.round(128.0 + grey), 0, 255).astype(np.uint8)


def png_bytes(grey):
    """A grey picture, (height, width) uint8, as a PNG file."""

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    height, width = grey.shape
    differences = np.diff(grey.astype(np.int16), axis=1, prepend=0).astype(np.uint8)  # PNG's filter 1
    lines = np.hstack([np.ones((height, 1), dtype=np.uint8), differences])
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(lines.tobytes(), 9)) + chunk(b"IEND", b""))


def photo_yaml():
    """Content of photo.yaml."""
    return "\n".join([
        "# A picture with detail of every size, for what follows brightness and not outlines.",
        "# Made by scripts/make_targets.py. Centred at the origin, its top at +y, seen from +z.",
        "name: photo", "image:", "  file: photo.png", f"  size_m: {list(PHOTO_SIZE_M)}"]) + "\n"


def tag_pixels(family=TAG_FAMILY, number=TAG_NUMBER):
    """The tag with its margin, (n, n) uint8."""
    import cv2  # here: nothing else needs it
    codes = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_APRILTAG_{family}"))
    draw = getattr(cv2.aruco, "generateImageMarker", None) or cv2.aruco.drawMarker  # its name before OpenCV 4.7
    tag = draw(codes, number, TAG_MODULES * TAG_MODULE_PX)
    return np.pad(tag, TAG_MARGIN * TAG_MODULE_PX, constant_values=255)


def tag_yaml():
    """Content of tag.yaml."""
    side_m = round((TAG_MODULES + 2 * TAG_MARGIN) * TAG_MODULE_M, DECIMALS)
    return "\n".join([
        f"# AprilTag {TAG_NUMBER} of the family {TAG_FAMILY}; its black square is {TAG_MODULES * TAG_MODULE_M:g} m "
        "long.",
        "# Made by scripts/make_targets.py. Centred at the origin, its top at +y, seen from +z.",
        "name: tag", "image:", "  file: tag.png", f"  size_m: [{side_m}, {side_m}]"]) + "\n"


def targets():
    """File name -> content (text or bytes) of each file."""
    files = {shape.__name__ + ".yaml": yaml_text(shape) for shape in SHAPES}
    return {**files, "photo.yaml": photo_yaml(), "photo.png": png_bytes(photo_pixels()),
            "tag.yaml": tag_yaml(), "tag.png": png_bytes(tag_pixels())}


def main():
    """Writes the files."""
    default = pathlib.Path(__file__).resolve().parent.parent / "targets"
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=pathlib.Path, default=default, help="folder to write to")
    output = parser.parse_args().output
    output.mkdir(parents=True, exist_ok=True)
    for name, content in targets().items():
        (output / name).write_bytes(content if isinstance(content, bytes) else content.encode())


if __name__ == "__main__":
    main()
