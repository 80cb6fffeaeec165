"""Kernel projections as features: kx and ky are the integrals of X^-p and Y^-q over the object (docs/theory.md T47).

The camera computes them if the scenario has `vision.kernel: {p: , q: }`. They control two motions; depth and rotation
need other features beside them, for example `features: [kx, ky, an, alpha]`.
"""

from typing import Sequence

import numpy as np

from ...ground.errors import DegenerateFeature
from ..base import Feature, register_each
from ...palette import BLUE, VERMILION


def kernel_row(sums: Sequence[float], exponent: float, origin: float, plane: Sequence[float]) -> np.ndarray:
    """Row (6,), [v; w], of the integral of X^-p over the object, with X = x - x0 (T47).

    Args:
        sums: six integrals [-]; that of X^-(p - 1 + k) y^j is at index 2 k + j, for k = 0, 1, 2 and j = 0, 1.
        exponent, origin: p and x0.  plane: (A, B, C) of the target in the camera frame [1/m].
    """
    A, B, C = plane
    p, x0 = exponent, origin

    def slope(i, j):
        """Integral of d(X^-p)/dx x^i y^j, with x^i = (X + x0)^i expanded in powers of X; i <= 2, j <= 1."""
        total = 0.0
        for n, share in enumerate(((1.0,), (x0, 1.0), (x0 * x0, 2.0 * x0, 1.0))[i]):  # coefficient of X^n in x^i
            total += share * sums[2 * (2 - n) + j]
        return -p * total

    def kernel(i, j):
        """Integral of X^-p x^i y^j; i <= 1, j <= 1."""
        return sums[2 + j] if i == 0 else sums[j] + x0 * sums[2 + j]

    f, fx, fy = kernel(0, 0), kernel(1, 0), kernel(0, 1)
    return np.array([
        -(A * slope(1, 0) + B * slope(0, 1) + C * slope(0, 0)) - A * f,
        -B * f,
        A * slope(2, 0) + B * slope(1, 1) + C * slope(1, 0) + 3.0 * (A * fx + B * fy) + 2.0 * C * f,
        slope(1, 1) + 3.0 * fy,
        -slope(0, 0) - slope(2, 0) - 3.0 * fx,
        slope(0, 1),
    ])


class _Kernel(Feature):
    """Integral of X^-p or Y^-q over the object (T47) [-]; ky is kx of the view with its axes swapped."""

    overlay = "kernel"

    def value(self, view):
        return self._sums(view)[4]

    def row(self, view):
        exponent, origin, *integrals = self._sums(view)
        A, B, C = view.plane
        if self.index == 0:
            return kernel_row(integrals, exponent, origin, view.plane)
        vy, vx, vz, wy, wx, wz = kernel_row(integrals, exponent, origin, (B, A, C))
        return np.array([vx, vy, vz, -wx, -wy, -wz])

    def _sums(self, view):
        """Eight numbers: p, x0 and the six integrals of `kernel_row`. Raises DegenerateFeature: the view has none."""
        sums = getattr(view.features, "kernel_" + "xy"[self.index], ())
        if len(sums) != 8:
            raise DegenerateFeature(f"{self.name}: the camera computed no kernel projections, set vision.kernel")
        return sums


register_each(_Kernel, (("kx", "k_x", "kernel projection in x", BLUE),
                        ("ky", "k_y", "kernel projection in y", VERMILION)))
