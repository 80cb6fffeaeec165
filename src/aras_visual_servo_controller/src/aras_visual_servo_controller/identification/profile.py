"""Intervals where the cost is no parabola: its profile along the directions that the data tell badly.

A short recording tells an arm's gains, friction and payload up to a common factor, and the sensitivity to this factor
changes with it. The covariance at the minimum then describes one side too narrow and the other too wide. The profile
of the likelihood describes both (Venzon and Moolgavkar, Applied Statistics 37(1), 1988).
"""

from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Callable, Optional

import numpy as np

from .estimates import HALF_95

#: So many of the weakest directions are looked at.
WEAKEST = 6
#: A direction is straight if the cost at both ends of its interval rises as predicted, within this part.
STRAIGHT = 0.2
#: The rise of the cost at an end is met within this part, in so many steps outwards with so many corrections each.
MET, OUTWARDS, CORRECTIONS = 0.1, 8, 8
#: An end is followed to so many times the predicted way; an interval as wide as that tells nothing anyway.
FARTHEST = 6.0
RISE = HALF_95**2


@dataclass(frozen=True)
class Profile:
    """Attributes:
        directions: (k, r) unit vectors that are not straight.
        ends: (r, 2, k) displacements at both ends of the 95 % interval of each.
        lower: displacement (k,) of a point with a lower cost, or None.
    """

    directions: np.ndarray
    ends: np.ndarray
    lower: Optional[np.ndarray]


def profile(residual: Callable[[np.ndarray], np.ndarray], jacobian: np.ndarray, pool: Executor) -> Profile:
    """Returns the profile of the sum of squares about its minimum.

    Args:
        residual: displacement (k,) -> (n,) of variance 1; raises no error nearby.
        jacobian: (n, k) at the minimum, of full rank.
    """
    k = jacobian.shape[1]
    values, vectors = np.linalg.eigh(jacobian.T @ jacobian)
    least = float(np.sum(residual(np.zeros(k))**2))
    reach = HALF_95 / np.sqrt(np.maximum(values, 1e-12 * values[-1]))

    def rise(displacement):
        return float(np.sum(residual(displacement)**2)) - least

    looked = [(i, side) for i in range(min(WEAKEST, k)) for side in (-1.0, 1.0)]
    found = list(pool.map(lambda each: rise(each[1] * reach[each[0]] * vectors[:, each[0]]), looked))
    bent = sorted({i for (i, _), value in zip(looked, found) if abs(value / RISE - 1.0) > STRAIGHT})

    def end(each):
        i, side = each
        rest = np.delete(vectors, i, axis=1)
        solve = np.linalg.pinv(jacobian @ rest)
        way, part, best = np.zeros(k), 1.0, (0.0, 0.0)
        for _ in range(OUTWARDS):
            wanted = side * part * reach[i]
            way = way * min(part / best[0], 2.0) if best[0] else way
            way = way + (wanted - way @ vectors[:, i]) * vectors[:, i]
            error = residual(way)
            cost = float(np.sum(error**2))
            for _ in range(CORRECTIONS):
                step = rest @ (solve @ error)
                for factor in (1.0, 0.4, 0.1):
                    trial = way - factor * step
                    new = residual(trial)
                    if float(np.sum(new**2)) < cost:
                        break
                else:
                    break
                gain, way, error, cost = cost - float(np.sum(new**2)), trial, new, float(np.sum(new**2))
                if gain < 0.1 * MET * RISE:
                    break
            rose = cost - least
            if rose < -MET * RISE:
                return way, True
            if abs(rose / RISE - 1.0) < MET:
                break
            best = (part, rose)
            part *= float(np.clip(np.sqrt(RISE / max(rose, 1e-9)), 0.4, 2.0))
            if part > FARTHEST:
                break
        return way, False

    results = list(pool.map(end, [(i, side) for i in bent for side in (-1.0, 1.0)]))
    lower = next((way for way, below in results if below), None)
    ends = np.array([way for way, _ in results]).reshape(len(bent), 2, k)
    return Profile(vectors[:, bent], ends, lower)
