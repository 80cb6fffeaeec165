"""From a camera twist to joint velocities: damped inverse of all six rows, and what the spare motion is used for.

An arm whose camera looks straight down has lost one twist (tilt about the horizontal axis in the arm's plane), and
the published goal is nearly stretched, so that 1 mm of height asks for 0.2 rad of the elbow. Both are small singular
values, and only the first may be given up. Rule:

1. Rows are made comparable by a characteristic length: linear rows are divided by `length_m`, so that at the published
   goal height has sigma = 0.07 and the lost tilt sigma = 0 (order of the tilt [rad] when not quite straight down).
   Columns are divided by joint weights (cost of moving a joint).
2. Each singular value below `threshold` is inverted as sigma / (sigma^2 + lambda^2) with
   lambda^2 = (1 - (sigma / threshold)^2) damping^2; the others exactly. A lost direction (sigma -> 0) gets no motion,
   a weak but needed one above the threshold is not slowed at all, and nothing jumps in between.
   This is rule `damped`; the published ones are in damping.py.
3. Spare motion: directions with sigma far below the threshold are free. There the arm returns to the posture it was
   taught in (gantry, J1 and J6 keep their shares; and with a goal that is not quite straight down, the lost tilt is
   right only there), and joints are pushed away from their limits and from singularities.
4. An arm without spare directions has some motion to spare as long as it is not at the goal: only the rate at which the
   distance to it shrinks has to be kept, not the direction of the way (projection onto the norm, T41).

References:
    Y. Nakamura and H. Hanafusa, ASME J. Dyn. Syst. Meas. Control 108(3), 1986 (variable damping).
    S. Chiaverini, B. Siciliano, O. Egeland, IEEE Trans. Control Syst. Technol. 2(2), 1994 (damping by
    sigma / threshold, applied to the weak singular vectors only).
    A. Liegeois, IEEE Trans. SMC 7(12), 1977 (gradient projection).
    M. Marey and F. Chaumette, A new large projection operator for the redundancy framework, ICRA 2010.
    W. A. Wolovich and H. Elliott, CDC 1984 (transpose of the Jacobian).
"""

from math import exp, inf

import numpy as np

from .damping import ROUNDING, RULES

#: A direction counts as free when its singular value is below this part of the threshold (with a smooth transition). A
#: free motion of u [rad/s] then moves the camera by less than FREE * threshold * u: below 1e-3 u with the default
#: threshold.
FREE = 0.05


class Inverse:
    """Damped inverse of one Jacobian, made by `TwistInverse`.

    Attributes:
        manipulability: smallest singular value of the scaled Jacobian, without a tilt direction below the threshold.
    """

    def __init__(self, scale, rows, ease, rule, threshold, damping2, jacobian):
        """Args: see `TwistInverse`."""
        self._rows, self._ease = rows, ease
        U, self._sigmas, self._Vt = np.linalg.svd(jacobian * scale)
        sigmas = self._sigmas.tolist()
        gains, kept, free = [0.0] * len(self._Vt), [0.0] * 6, [1.0] * len(self._Vt)
        free_below = FREE * threshold
        self.manipulability = inf
        for i, (sigma, lambda2) in enumerate(zip(sigmas, rule(sigmas, threshold, damping2))):
            if lambda2 == 0.0 and sigma > ROUNDING:
                gains[i], kept[i], free[i] = 1.0 / sigma, 1.0, 0.0
            else:
                gains[i] = sigma / (sigma * sigma + lambda2) if lambda2 > 0.0 else 0.0
                kept[i] = gains[i] * sigma
                free[i] = 0.0 if sigma >= free_below else (1.0 - (sigma / free_below) ** 2) ** 2
            if sigma >= threshold:
                self.manipulability = sigma
            elif U[3, i] ** 2 + U[4, i] ** 2 < 0.5:
                self.manipulability = min(self.manipulability, sigma)
        self._U, self._kept, self._free = U, np.array(kept), np.array(free)
        m = len(sigmas)
        self._gains, self._U_used, self._Vt_used = np.array(gains[:m]), U[:, :m], self._Vt[:m]

    def joint_velocity(self, twist):
        """(n,) joint velocities of a twist V_C, (6,), [v; w]."""
        return self._ease * ((self._gains * ((self._rows * twist) @ self._U_used)) @ self._Vt_used)

    def achieved(self, twist):
        """(6,) the part of the twist that `joint_velocity` achieves."""
        return (self._U @ (self._kept * ((self._rows * twist) @ self._U))) / self._rows

    def lost(self, twist):
        """Norm of the part of the twist that is not achieved, its linear part divided by length_m [rad/s]."""
        missed = (1.0 - self._kept) * ((self._rows * twist) @ self._U)
        return float(missed @ missed) ** 0.5

    def free(self, wish):
        """(n,) the part of the joint velocities `wish` that does not move the camera."""
        return self._ease * ((self._free * (self._Vt @ (wish / self._ease))) @ self._Vt)

    def null_part(self, q_dot):
        """(n,) the part of joint velocities q_dot along the directions that count as free (`FREE`): the null space."""
        return self._ease * (((self._free > 0.0) * (self._Vt @ (q_dot / self._ease))) @ self._Vt)

    def free_of_norm(self, wish, twist):
        """(n,) the part of `wish` that does not change how fast the distance to the goal shrinks (T41).

        The law's twist is the remaining displacement times the gain, so the part of `wish` along J^T twist is removed.
        J_e of the paper is here the scaled Jacobian.
        """
        wish = wish / self._ease
        m = len(self._sigmas)
        along = (self._sigmas * ((self._rows * twist) @ self._U[:, :m])) @ self._Vt[:m]  # J^T e
        size2 = float(along @ along)
        return self._ease * (wish - along * (float(along @ wish) / size2) if size2 > 0.0 else wish)

    def size(self, twist):
        """Norm of a twist, linear part divided by length_m [rad/s]."""
        scaled = self._rows * twist
        return float(scaled @ scaled) ** 0.5


class Transpose(Inverse):
    """q_dot = alpha J^T V, with the alpha that fits this V best. It is never unbounded, but the camera moves along V
    only where J is well-conditioned."""

    def _joints(self, twist):
        m = len(self._sigmas)
        y = (self._rows * twist) @ self._U[:, :m]
        z = self._sigmas * self._sigmas * y
        size2 = float(z @ z)
        return (float(z @ y) / size2 if size2 > 0.0 else 0.0) * self._sigmas * y

    def joint_velocity(self, twist):
        """(n,) joint velocities of a twist V_C, (6,), [v; w]."""
        return self._ease * (self._joints(twist) @ self._Vt[:len(self._sigmas)])

    def achieved(self, twist):
        """(6,) the twist that `joint_velocity` makes of it."""
        return (self._U[:, :len(self._sigmas)] @ (self._sigmas * self._joints(twist))) / self._rows

    def lost(self, twist):
        """Norm of the difference, linear part divided by length_m [rad/s]."""
        return self.size(twist - self.achieved(twist))


#: Values of servo/inverse/method.
METHODS = (*RULES, "transpose")


def norm_part(size, lower, upper):
    """Weight of the projection onto the norm: 0 below `lower`, 1 above `upper`, a sigmoid between (T41)."""
    if not lower < size < upper:
        return float(size >= upper)
    low, high, here = [1.0 / (1.0 + exp(6.0 - 12.0 * u)) for u in (0.0, 1.0, (size - lower) / (upper - lower))]
    return (here - low) / (high - low)


class TwistInverse:
    """Makes the inverses: `inverse = twist_inverse(kinematics.jacobian(q))`."""

    def __init__(self, weights, length_m=0.05, threshold=0.02, damping=0.02, method="damped"):
        """Set up.

        Args:
            weights: (n,) cost of moving each joint, > 0.  length_m: > 0.
            threshold: singular values below it are damped, > 0.  damping: that of a vanishing singular value, > 0.
            method: one of METHODS.
        """
        ease = 1.0 / np.asarray(weights, dtype=float)
        rows = np.array([1.0 / length_m] * 3 + [1.0] * 3)
        rule = RULES.get(method, RULES["damped"])
        self._setup = (np.outer(rows, ease), rows, ease, rule, threshold, damping * damping)
        self._make = Transpose if method == "transpose" else Inverse

    def __call__(self, jacobian):
        """`Inverse` of J_BC_C, (6, n)."""
        return self._make(*self._setup, jacobian)


class Wish:
    """Joint velocities wanted where the twist leaves a choice: back to a posture, and away from joint limits."""

    def __init__(self, lower, upper, posture_gain_per_s, joint_limit_gain_per_s, max_speed):
        """Set up.

        Args:
            lower, upper: (n,) limits, may be infinite.
            posture_gain_per_s: rate of return to the posture, >= 0.
            joint_limit_gain_per_s: rate at a limit, falling with the cube of the distance from the middle, >= 0.
            max_speed: of any joint, > 0 [m/s, rad/s].
        """
        limited = np.isfinite(lower) & np.isfinite(upper)
        self._middle = np.where(limited, 0.5 * (np.where(limited, lower, 0.0) + np.where(limited, upper, 0.0)), 0.0)
        half = np.where(limited, 0.5 * (upper - lower), 1.0)
        self._limit_gain = np.where(limited, joint_limit_gain_per_s / (half * half), 0.0)
        self._posture_gain, self._max_speed = posture_gain_per_s, max_speed

    def __call__(self, q, posture=None, more=None):
        """(n,) wanted velocities at joint positions q; posture: (n,) or None; more: (n,) added to them, or None."""
        off = q - self._middle
        wish = -self._limit_gain * (off * off * off)
        if posture is not None:
            wish += self._posture_gain * (posture - q)
        if more is not None:
            wish += more
        fastest = max(map(abs, wish.tolist()))
        return wish if fastest <= self._max_speed else wish * (self._max_speed / fastest)
