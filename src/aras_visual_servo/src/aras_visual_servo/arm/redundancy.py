"""From a camera twist to joint velocities: damped inverse of all six rows, and use of the null space.

An arm whose camera looks straight down has lost one twist (tilt about the horizontal axis in the arm's plane), and
the published goal is nearly stretched, so that 1 mm of height asks for 0.2 rad of the elbow (docs/theory.md T16, T17).
Both are small singular values, and only the first may be given up. Rule:

1. Rows are made comparable by a characteristic length: linear rows are divided by `length_m`, so that at the published
   goal height has sigma = 0.07 and the lost tilt sigma = 0. Columns are divided by joint weights.
2. Singular values below `threshold` are damped by one of the rules of damping.py (T40).
3. Spare motion: directions with sigma far below the threshold are free. There the arm returns to the posture it was
   taught in (gantry, J1 and J6 keep their shares; and with a goal that is not quite straight down, the lost tilt is
   right only there), and joints are pushed away from their limits and from singularities (gradient projection:
   A. Liegeois, IEEE Trans. SMC 7(12), 1977).
4. An arm without spare directions has some motion to spare as long as it is not at the goal (T41).
"""

from math import exp
from typing import Any, Sequence

import numpy as np

from .._kinematics import Inverse, Transpose, Wish
from .damping import METHODS, ROUNDING, RULES

__all__ = ["FREE", "METHODS", "Inverse", "Transpose", "TwistInverse", "Wish", "norm_part"]

#: A direction counts as free when its singular value is below this part of the threshold (with a smooth transition). A
#: free motion of u [rad/s] then moves the camera by less than FREE * threshold * u: below 1e-3 u with the default
#: threshold.
FREE = 0.05


def norm_part(size: float, lower: float, upper: float) -> float:
    """Weight of the projection onto the norm: 0 below `lower`, 1 above `upper`, a sigmoid between (T41)."""
    if not lower < size < upper:
        return float(size >= upper)
    low, high, here = [1.0 / (1.0 + exp(6.0 - 12.0 * u)) for u in (0.0, 1.0, (size - lower) / (upper - lower))]
    return (here - low) / (high - low)


class TwistInverse:
    """Makes the inverses: `inverse = twist_inverse(kinematics.jacobian(q))`."""

    def __init__(self, weights: Sequence[float], length_m: float = 0.05, threshold: float = 0.02, damping: float = 0.02,
                 method: str = "damped") -> None:
        """Set up.

        Args:
            weights: (n,) cost of moving each joint, > 0.  length_m: > 0.
            threshold: singular values below it are damped, > 0.  damping: that of a vanishing singular value, > 0.
            method: one of METHODS.
        """
        self._ease, self._rows = 1.0 / np.asarray(weights, dtype=float), np.array([1.0 / length_m] * 3 + [1.0] * 3)
        self._rule, self._threshold, self._damping2 = RULES.get(method, RULES["damped"]), threshold, damping * damping
        self._make = Transpose if method == "transpose" else Inverse

    def __call__(self, jacobian: np.ndarray) -> Any:
        """`Inverse` of J_BC_C, (6, n)."""
        inverse, threshold = self._make(self._rows, self._ease, jacobian), self._threshold
        inverse.damp(self._rule(inverse.sigmas, threshold, self._damping2), threshold, FREE * threshold, ROUNDING)
        return inverse
