"""Changes of the features caused by displaced sides of the object (docs/theory.md T73).

A camera tells the place of a side to a part of a pixel only (`Features.edge_stddev`). Each corner or point errs by
itself, along x and along y. Moments are those of a surface; its four sides, taken as those of the rectangle with the
same area and moments of second order, err in their place and in their direction.
"""

from dataclasses import replace
from math import atan2, cos, isfinite, sin, sqrt
from typing import Any, Iterator, List, Tuple

import numpy as np

from ..ground.types import Features
from .base import FeatureSet, View

#: Displacement by which the changes are found as differences, in normalised coordinates.
STEP = 1e-5
#: Places on a side, from -1 to 1, and their weights: they integrate polynomials up to the seventh order.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


def edge_changes(features: FeatureSet, view: Features) -> np.ndarray:
    """Returns (k, n): the change of each feature with each of n independent errors, of standard deviation 1 each.

    Raises DegenerateFeature: a feature does not exist in this view.
    """
    s = features.values(View(view))
    moved = [features.error(features.values(View(other)), s, False) for other in _others(view)]
    return np.array(moved).T.reshape(len(s), -1) / STEP


def whole(view: Features) -> Features:
    """The view with `area`, `xg` and `yg` where a stored one has its moments or points only."""
    m = view.raw_moments()
    if "10" in m:
        return replace(view, area=m["00"], xg=m["10"] / m["00"], yg=m["01"] / m["00"])
    if len(view.point_x) and not isfinite(view.xg):
        return replace(view, xg=float(np.mean(view.point_x)), yg=float(np.mean(view.point_y)))
    return view


def _others(view: Features) -> Iterator[Features]:
    """The view with each of the errors."""
    for name in ("point_x", "point_y", "ray_x", "ray_y"):
        values = list(getattr(view, name))
        for k, value in enumerate(values):
            yield replace(view, **{name: (*values[:k], value + STEP, *values[k + 1:])})
    if "02" in view.moment_names and view.area > 0.0:
        for places, shifts in _sides(view):
            yield _with_side_moved(view, places, shifts)


def _sides(view: Features) -> List[Tuple[np.ndarray, np.ndarray]]:
    """Sides of the rectangle, each twice: as shifted and as turned. (4, 2) places, (4,) displaced area at each."""
    mu = view.centred_moments()
    angle = 0.5 * atan2(2.0 * mu["11"], mu["20"] - mu["02"])
    spread, difference = mu["20"] + mu["02"], sqrt((mu["20"] - mu["02"]) ** 2 + 4.0 * mu["11"] ** 2)
    half = [sqrt(max(1.5 * (spread + sign * difference) / view.area, 0.0)) for sign in (1.0, -1.0)]
    axes = np.array([[cos(angle), sin(angle)], [-sin(angle), cos(angle)]])
    sides = []
    for along, across in ((0, 1), (1, 0)):
        for sign in (1.0, -1.0):
            places = (np.array([view.xg, view.yg]) + sign * half[across] * axes[across]
                      + half[along] * _NODES[:, None] * axes[along])
            for shape in (np.ones(4), sqrt(3.0) * _NODES):
                sides.append((places, STEP * half[along] * _WEIGHTS * shape))
    return sides


def _with_side_moved(view: Features, places: np.ndarray, shifts: np.ndarray) -> Features:
    x, y = places.T
    m = {name: value + float(np.sum(x ** int(name[0]) * y ** int(name[1]) * shifts))
         for name, value in view.raw_moments().items()}
    area = m["00"]
    xg, yg = m["10"] / area, m["01"] / area
    dx, dy, u, v = xg - view.xg, yg - view.yg, x - view.xg, y - view.yg
    old = view.centred_moments()
    mu = {}
    for name, value in old.items():
        i, j = int(name[0]), int(name[1])
        mu[name] = (value + float(np.sum(u**i * v**j * shifts)) - i * old.get(f"{i - 1}{j}", 0.0) * dx
                    - j * old.get(f"{i}{j - 1}", 0.0) * dy) if i + j > 1 else value
    turn = 0.5 * (atan2(2.0 * mu["11"], mu["20"] - mu["02"]) - atan2(2.0 * old["11"], old["20"] - old["02"]))
    turn -= round(turn / np.pi) * np.pi
    an = view.an * sqrt(view.area / area)
    return replace(view, area=area, xg=xg, yg=yg, alpha=view.alpha + turn, an=an, xn=an * xg, yn=an * yg,
                   m=tuple(m.values()), mu=tuple(mu.values()), **_kernels(view, x, y, shifts))


def _kernels(view: Features, x: np.ndarray, y: np.ndarray, shifts: np.ndarray) -> Any:
    """The kernel projections of `MomentFeatures` with these displaced areas."""
    changed = {}
    for name, along, across in (("kernel_x", x, y), ("kernel_y", y, x)):
        values = list(getattr(view, name))
        if values:
            p, corner = values[:2]
            for k in range(3):
                for j in range(2):
                    values[2 + 2 * k + j] += float(np.sum((along - corner) ** -(p - 1 + k) * across**j * shifts))
            changed[name] = tuple(values)
    return changed
