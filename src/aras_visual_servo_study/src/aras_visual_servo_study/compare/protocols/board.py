"""Textured boards, drawn by a seeded program: pictures with corners and edges at all scales, and perturbed copies."""

from pathlib import Path
from typing import Callable, Optional, Sequence, Tuple, Union

import numpy as np

from aras_visual_servo import ParameterError

#: Size of a board's picture [px]: a pixel is 0.53 mm of a board of 0.8 m.
WIDTH, HEIGHT = 1500, 1125
SHAPES = 900
Points = Sequence[Sequence[float]]


def draw(seed: Union[int, Sequence[int]], size_px: Tuple[int, int] = (WIDTH, HEIGHT), shapes: int = SHAPES,
         largest_px: float = 180.0) -> np.ndarray:
    """A board, (height, width, 3) uint8: rectangles, discs and triangles of many sizes and colours over each other."""
    rng, (width, height) = np.random.default_rng(seed), size_px
    # on_top: for each pixel the index of the colour that is seen there.
    colours, on_top = [rng.integers(60, 200, 3)], np.zeros((height, width), np.uint16)
    u, v = np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32)[:, None]
    # Whether (a, b) is inside a rectangle, a disc, a triangle.
    inside_of = (lambda a, b, size: np.maximum(np.abs(a), np.abs(b)) < size, lambda a, b, size: np.hypot(a, b) < size,
                 lambda a, b, size: (a > -0.5 * size) & (a + 1.7 * np.abs(b) < size))
    for size in np.sort(np.exp(rng.uniform(np.log(6.0), np.log(largest_px), shapes)))[::-1]:
        middle = rng.uniform((0, 0), (width, height))
        colours.append(rng.integers(0, 256, 3))
        kind, turn, narrow = rng.integers(3), rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.3, 1.0)
        window = tuple(slice(max(int(m - 1.5 * size), 0), int(m + 1.5 * size) + 1) for m in middle[::-1])
        du, dv = u[window[1]] - middle[0], v[window[0]] - middle[1]
        a, b = np.cos(turn) * du + np.sin(turn) * dv, (np.cos(turn) * dv - np.sin(turn) * du) / narrow
        np.copyto(on_top[window], len(colours) - 1, where=inside_of[kind](a, b, size))
    return np.array(colours, np.uint8)[on_top]


def sign(outlines_m: Sequence[np.ndarray], size_m: Tuple[float, float], grey: int = 20,
         ground: int = 250) -> np.ndarray:
    """A board of size_m, (HEIGHT, WIDTH, 3) uint8, of one grey, with outlines of another about its middle."""
    from matplotlib.path import Path  # slow to import
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH]
    x, y = ((u + 0.5) / WIDTH - 0.5) * size_m[0], (0.5 - (v + 0.5) / HEIGHT) * size_m[1]
    places, image = np.stack([x.ravel(), y.ravel()], axis=1), np.full((HEIGHT, WIDTH, 3), ground, np.uint8)
    for outline in outlines_m:
        image[Path(outline).contains_points(places).reshape(HEIGHT, WIDTH)] = grey
    return image


def perturbed(picture: np.ndarray, seed: Union[int, Sequence[int]]) -> np.ndarray:
    """A copy with the perturbations of the ViT-VS protocol, drawn here with numpy.

    With a chance of 1/2 a rectangle of 2 to 33 % of the area is black, its sides' ratio between 0.3 and 3.3. Then, in
    an order of chance, brightness is multiplied by 0.4 to 1.6 and contrast by 0.6 to 1.4 about the mean grey. Last,
    noise with a standard deviation of 5 % of the range is added. Grey levels stay within their range.

    Args: picture: (h, w, 3) uint8.
    """
    rng = np.random.default_rng(seed)
    image = picture.astype(np.float32) / 255.0
    height, width = image.shape[:2]
    if rng.random() < 0.5:
        for _ in range(10):  # as often as it takes to fit, at most so
            area, ratio = height * width * rng.uniform(0.02, 0.33), np.exp(rng.uniform(np.log(0.3), np.log(3.3)))
            h, w = int(round(np.sqrt(area * ratio))), int(round(np.sqrt(area / ratio)))
            if h < height and w < width:
                top, left = rng.integers(0, height - h + 1), rng.integers(0, width - w + 1)
                image[top:top + h, left:left + w] = 0.0
                break
    brightness, contrast = rng.uniform(0.4, 1.6), rng.uniform(0.6, 1.4)
    for kind in rng.permutation(2):
        if kind == 0:
            image = np.clip(brightness * image, 0.0, 1.0)
        else:
            grey = float((image @ np.array([0.2989, 0.587, 0.114], np.float32)).mean())
            image = np.clip(contrast * image + (1.0 - contrast) * grey, 0.0, 1.0)
    image += 0.05 * rng.standard_normal(image.shape, dtype=np.float32)
    return np.rint(255.0 * np.clip(image, 0.0, 1.0)).astype(np.uint8)


def save(path: Path, picture: np.ndarray) -> None:
    """Write a picture, (h, w, 3) uint8, to a PNG file. The same picture gives the same bytes."""
    import matplotlib.image  # slow to import
    matplotlib.image.imsave(str(path), picture, metadata={"Software": None})


def load(path: Union[str, Path]) -> np.ndarray:
    """(h, w, 3) uint8 of a picture's file, transparency left out. Raises OSError, ValueError."""
    import matplotlib.image
    picture = matplotlib.image.imread(str(path))
    if picture.dtype != np.uint8:
        picture = np.rint(255.0 * picture).astype(np.uint8)
    return np.ascontiguousarray(picture[..., :3] if picture.ndim == 3 else np.repeat(picture[..., None], 3, axis=2))


def asked_for(file: Optional[str], seed: int) -> np.ndarray:
    """The picture of a user's file, or our own of this seed where the file is None. Raises ParameterError."""
    try:
        return draw(seed) if file is None else load(file)
    except (OSError, ValueError, SyntaxError) as error:
        raise ParameterError(f"--board: found {file}, allowed the file of a picture: {error}") from error


def saved(folder: Path, file: Optional[str], seed: int) -> Path:
    """FOLDER/board.png with what is `asked_for`; a file that is there is taken."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "board.png"
    if not path.exists():
        save(path, asked_for(file, seed))
    return path


def save_mesh(path: Path, draw_picture: Callable[[], np.ndarray], size_m: Tuple[float, float]) -> Path:
    """Writes a rectangle of a size (width, height) with a picture as a mesh; a file that is there is taken.

    A mesh answers light and shadows, which a flat model of a scene does not.
    """
    if not path.with_suffix(".obj").exists():
        x, y = 0.5 * size_m[0], 0.5 * size_m[1]
        write_obj(path, draw_picture(), ((-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)),
                  ((0, 0), (1, 0), (1, 1), (0, 1)), ((0, 0, 1),), ((1, 2, 3, 1), (1, 3, 4, 1)))
    return path.with_suffix(".obj").resolve()


def write_obj(path: Path, picture: np.ndarray, vertices: Points, coordinates: Points, normals: Points,
              faces: Sequence[Tuple[int, int, int, int]]) -> None:
    """Writes PATH.obj with PATH.mtl and PATH.png. A face is three vertices and a normal, all counted from 1."""
    save(path.with_suffix(".png"), picture)
    material = f"newmtl picture\nKa 1 1 1\nKd 1 1 1\nmap_Kd {path.name}.png\n"
    path.with_suffix(".mtl").write_text(material, encoding="utf-8")
    lines = [f"mtllib {path.name}.mtl", *("v %.6g %.6g %.6g" % tuple(v) for v in vertices),
             *("vt %.6g %.6g" % tuple(c) for c in coordinates), *("vn %.6g %.6g %.6g" % tuple(n) for n in normals),
             "usemtl picture", *(f"f {a}/{a}/{n} {b}/{b}/{n} {c}/{c}/{n}" for a, b, c, n in faces), ""]
    path.with_suffix(".obj").write_text("\n".join(lines), encoding="utf-8")
