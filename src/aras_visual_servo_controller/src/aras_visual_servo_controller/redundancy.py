"""From a camera twist to joint velocities: damped inverse of all six rows, and what the spare motion is used for.

An arm whose camera looks straight down has lost one twist (tilt about the horizontal axis in the arm's plane), and the
published goal is nearly stretched, so that 1 mm of height asks for 0.1 rad of the elbow. Both are small singular values,
and only the first may be given up. Rule:

1. Rows are made comparable by a characteristic length: linear rows are divided by `length_m`, so that at the published
   goal height has sigma = 0.07 and the lost tilt sigma = 0 (order of the tilt [rad] when not quite straight down).
   Columns are divided by joint weights (cost of moving a joint).
2. Each singular value below `threshold` is inverted as sigma / (sigma^2 + lambda^2) with
   lambda^2 = (1 - (sigma / threshold)^2) damping^2; the others exactly. A lost direction (sigma -> 0) gets no motion,
   a weak but needed one above the threshold is not slowed at all, and nothing jumps in between.
3. Spare motion: directions with sigma far below the threshold are free. Joints with limits are drawn to the middle of
   their range there, as far as the free directions allow.

References:
    Y. Nakamura and H. Hanafusa, ASME J. Dyn. Syst. Meas. Control 108(3), 1986 (variable damping).
    S. Chiaverini, B. Siciliano, O. Egeland, IEEE Trans. Control Syst. Technol. 2(2), 1994 (damping by sigma / threshold,
    applied to the weak singular vectors only).
    A. Liegeois, IEEE Trans. SMC 7(12), 1977 (gradient projection).
"""

from dataclasses import dataclass

import numpy as np

#: Directions count as free below this part of the threshold, smoothly: a free motion of u [rad/s] then moves the camera
#: by less than FREE * threshold * u, below 1e-3 of it with the default threshold.
FREE = 0.05


@dataclass
class Inverse:
    """Result of `TwistInverse.solve`.

    Attributes:
        q_dot: (n,) joint velocities of the task.  null: (n,) free motion, to be added.
        lost: norm of the part of the twist that q_dot does not achieve, linear part divided by length_m [rad/s].
        manipulability: smallest singular value, a tilt direction below the threshold left out.
    """

    q_dot: np.ndarray
    null: np.ndarray
    lost: float
    manipulability: float


class TwistInverse:
    """Inverse of the camera Jacobian."""

    def __init__(self, weights, length_m=0.05, threshold=0.02, damping=0.02):
        """Set up.

        Args:
            weights: (n,) cost of moving each joint, > 0.  length_m: > 0.
            threshold: singular values below are damped, > 0.  damping: of a vanishing one, > 0.
        """
        self._ease = 1.0 / np.asarray(weights, dtype=float)
        rows = np.array([1.0 / length_m] * 3 + [1.0] * 3)
        self._scale = np.outer(rows, self._ease)
        self._rows = rows
        self._threshold = threshold
        self._damping2 = damping * damping

    def solve(self, jacobian, twist, wish):
        """Invert.

        Args:
            jacobian: J_BC_C, (6, n).  twist: V_C, (6,), [v; w].
            wish: (n,) joint velocities wanted where the twist leaves a choice.
        """
        U, sigmas, Vt = np.linalg.svd(jacobian * self._scale)
        wanted = self._rows * twist
        parts = wanted @ U
        x_parts = [0.0] * len(Vt)
        free = [1.0] * len(Vt)
        lost2 = float(wanted @ wanted) if len(sigmas) < 6 else 0.0
        manipulability = np.inf
        threshold, free_below = self._threshold, FREE * self._threshold
        for i, (sigma, part) in enumerate(zip(sigmas.tolist(), parts.tolist())):
            free[i] = 0.0 if sigma >= free_below else (1.0 - (sigma / free_below) ** 2) ** 2
            if sigma >= threshold:
                gain = 1.0 / sigma
                manipulability = sigma
            else:
                gain = sigma / (sigma * sigma + (1.0 - (sigma / threshold) ** 2) * self._damping2)
                if U[3, i] ** 2 + U[4, i] ** 2 < 0.5:
                    manipulability = min(manipulability, sigma)
            x_parts[i] = gain * part
            missed = (1.0 - gain * sigma) * part
            lost2 += missed * missed - (part * part if len(sigmas) < 6 else 0.0)
        q_dot = self._ease * (x_parts @ Vt)
        null = self._ease * ((free * (Vt @ (wish / self._ease))) @ Vt)
        return Inverse(q_dot, null, max(0.0, lost2) ** 0.5, manipulability)


class Centring:
    """Wish of the null space: joints with limits go to the middle of their range, the others rest."""

    def __init__(self, lower, upper, gain_per_s, max_speed):
        """Args: lower, upper: (n,), may be infinite.  gain_per_s: >= 0.  max_speed: of any joint, > 0 [m/s, rad/s]."""
        limited = np.isfinite(lower) & np.isfinite(upper)
        self._middle = np.where(limited, 0.5 * (np.where(limited, lower, 0.0) + np.where(limited, upper, 0.0)), 0.0)
        self._gain = np.where(limited, gain_per_s, 0.0)
        self._max_speed = max_speed

    def __call__(self, q):
        """Wanted joint velocities, (n,)."""
        wish = self._gain * (self._middle - q)
        fastest = float(np.abs(wish).max())
        return wish if fastest <= self._max_speed else wish * (self._max_speed / fastest)
