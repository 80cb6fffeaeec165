"""Values with uncertainty, what a recording leaves open, and the least squares that tell them apart."""

from dataclasses import dataclass
from typing import Dict, List, Optional, Sequence, Tuple

import numpy as np

#: Half-width of a 95 % interval of the normal distribution in standard deviations.
HALF_95 = 1.959964
#: Singular values of the columns, each of length 1, below this part of the largest one tell nothing.
LEAST_PART = 1e-3
#: A parameter with more than this part in a direction that tells nothing is not known.
MOST_SHARE = 1e-2


@dataclass(frozen=True)
class Estimate:
    """Attributes: value, stddev: in `unit`.  bounds: of the 95 % interval, where it is not symmetric."""

    value: float
    stddev: float
    unit: str
    bounds: Optional[Tuple[float, float]] = None

    @property
    def interval(self) -> Tuple[float, float]:
        """Bounds of the 95 % interval."""
        if self.bounds is not None:
            return self.bounds
        return self.value - HALF_95 * self.stddev, self.value + HALF_95 * self.stddev


@dataclass(frozen=True)
class Unknown:
    """What the recording cannot tell.

    Attributes:
        name: of the parameter.  not_apart_from: parameters that have the same effect in this recording.
        motion: that would tell it.
    """

    name: str
    not_apart_from: Tuple[str, ...]
    motion: str


@dataclass(frozen=True)
class Identified:
    """Attributes:
        estimates: by name of the parameter.
        unknown: what the recording cannot tell.
        residual: by joint, root mean square of what the model leaves unexplained, in the unit of what was fitted.
    """

    estimates: Dict[str, Estimate]
    unknown: List[Unknown]
    residual: Dict[str, float]


def separable(matrix: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Returns (inverse, null): the pseudoinverse (k, n) of a matrix (n, k), and (k, r) directions that it cannot tell.

    Columns are scaled to length 1 first. A column of zeros is a direction of its own.
    """
    length = np.linalg.norm(matrix, axis=0)
    scale = np.where(length > 0.0, length, 1.0)
    u, s, vt = np.linalg.svd(matrix / scale, full_matrices=False)
    kept = s > LEAST_PART * s[0]
    inverse = (vt[kept].T / s[kept]) @ u[:, kept].T / scale[:, None]
    return inverse, vt[~kept].T


def not_told(null: np.ndarray, names: Sequence[str]) -> Dict[str, Tuple[str, ...]]:
    """Returns each parameter that the null directions (k, r) contain, with those it cannot be told from."""
    share = null @ null.T  # projection onto the null space
    found = [i for i in range(len(names)) if share[i, i] > MOST_SHARE]
    return {names[i]: tuple(names[j] for j in found if j != i and abs(share[i, j]) > MOST_SHARE) for i in found}


def covariance(inverse: np.ndarray, residual: np.ndarray, groups: np.ndarray, lags: int) -> np.ndarray:
    """Returns the (k, k) covariance of least squares whose residuals are correlated over `lags` rows of one group.

    The estimator of Newey and West (Econometrica 55, 1987) with Bartlett's weights, and the correction n / (n - k).

    Args: inverse: (k, n).  residual: (n,).  groups: (n,) of whole numbers; rows of a group are in the order of time.
    """
    total = np.zeros((len(inverse), len(inverse)))
    for group in np.unique(groups):
        score = (inverse * residual)[:, groups == group]
        total += score @ score.T
        for lag in range(1, min(lags, score.shape[1] - 1) + 1):
            part = score[:, lag:] @ score[:, :-lag].T
            total += (1.0 - lag / (lags + 1.0)) * (part + part.T)
    n, k = len(residual), len(inverse)
    return total * n / max(n - k, 1)
