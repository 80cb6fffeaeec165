"""Adds static friction to a fit where the recording shows it.

Friction falls from static to Coulomb friction over the Stribeck velocity (Armstrong-Helouvry, Dupont and Canudas de
Wit, Automatica 30(7), 1994).
"""

from typing import Callable, Dict, Iterable, List, Set, Tuple

import numpy as np

from .estimates import HALF_95
from .fit import STRIBECK_STEP, Fit
from .replayed import STRIBECK

#: Static friction is looked for with these parts of the joint's highest speed as the one over which it fades.
FADING_PARTS = (0.02, 0.1)
#: It is fitted if the cost would fall by more than this in the score test of a joint, and kept if it falls by more for
#: each of them: the likelihood ratio of two parameters has less in 999 of 1000 cases.
SEEN, KEPT = 20.0, 13.8
#: And if it is more than this many of its standard deviations.
SIGNIFICANT = 4.0
#: Static friction is not told where its interval is wider than Coulomb friction and than this part of its range.
STRIBECK_TOLD = 0.1


def with_static_friction(fit: Fit, x: np.ndarray, with_speeds: Callable[[Dict[str, float]], Fit]
                         ) -> Tuple[Fit, np.ndarray, List[str]]:
    """Returns (fit, values that fit best, joints of whose static friction the recording tells nothing).

    Args: x: values that fit best without.  with_speeds: the fit with static friction that fades over these speeds
    [m/s or rad/s] by joint.
    """
    speeds: Dict[str, float] = {}

    def fit_of(more: Dict[str, float]) -> Fit:
        return with_speeds({**speeds, **more})
    while True:
        # That of one joint may hide that of another.
        seen, untold = _shown(fit, x, fit_of)
        wider, lower, weak = fit, x, set(seen)
        while weak and seen:
            wider = fit_of(seen)
            lower = wider.from_other(fit, x)
            weak = _weak(wider, lower, seen)
            seen = {name: speed for name, speed in seen.items() if name not in weak}
        if not seen:
            return fit, x, untold
        # The minima of both models are compared, not a minimum with the place at which a fit has stopped.
        x = min(x, fit.from_other(wider, lower), key=fit.cost)
        if _falls_by_chance(wider, lower, fit, x, len(seen)):
            return fit, x, untold
        fit, x, speeds = wider, lower, {**speeds, **seen}


def _shown(fit: Fit, x: np.ndarray, fit_of: Callable[[Dict[str, float]], Fit]
           ) -> Tuple[Dict[str, float], List[str]]:
    """(speeds by name of the joints whose static friction the recording shows, joints of which it cannot tell).

    The score test (Rao, Proc. Cambridge Philosophical Society 44(1), 1948): the fall of the cost that the
    derivatives by static friction predict beside those by all other parameters.
    """
    robot, rows = fit.robot, fit.robot.fit
    weights, now, scale = fit.scaled(x)
    inflation = fit.inflation(now, scale)
    fitted = np.linalg.qr(fit.jacobian(x, rows, weights, now).reshape(-1, len(x)))[0]
    position = fit.recording.position[robot.used]
    top = np.max(np.abs(np.gradient(position, fit.recording.period_s, axis=0)), axis=0)
    asked = {name: float(speed) for name, speed in zip(robot.names, top)
             if name + ".p" in fit.names and name + STRIBECK not in fit.names and speed > 0.0}
    seen: Dict[str, Tuple[float, float]] = {}
    told: Set[str] = set()
    for part in FADING_PARTS:
        speeds = {name: part * speed for name, speed in asked.items()}
        wider = fit_of(speeds)
        begin = wider.start.copy()
        begin[[wider.names.index(name) for name in fit.names]] = x
        begin[[wider.names.index(name + STRIBECK) for name in asked]] = 0.0

        def column(name: str) -> np.ndarray:
            moved = begin.copy()
            i = wider.names.index(name + STRIBECK)
            moved[i] += STRIBECK_STEP * wider.ranges[i]
            change: np.ndarray = (wider.robot.residual(moved, rows, weights) - now).ravel() / STRIBECK_STEP
            return change - fitted @ (fitted.T @ change)
        for name, alone in zip(asked, fit.pool.map(column, asked)):
            size, friction = float(np.linalg.norm(alone)), fit.names.index(f"{name}.friction")
            most = max(x[friction] / fit.ranges[friction], STRIBECK_TOLD)
            if size * most > HALF_95:
                told.add(name)
            fall = -float(alone @ now.ravel()) / max(size, 1e-12)
            if fall > 0.0 and fall**2 > max(SEEN * inflation, seen.get(name, (0.0, 0.0))[0]):
                seen[name] = (fall**2, speeds[name])
    return {name: speed for name, (_, speed) in seen.items()}, [name for name in asked if name not in told]


def _weak(fit: Fit, x: np.ndarray, joints: Iterable[str]) -> Set[str]:
    """Those of the joints whose static friction is not told from none."""
    weights, now, scale = fit.scaled(x)
    J = fit.jacobian(x, fit.robot.fit, weights, now).reshape(-1, len(x))
    stddev = np.sqrt(np.diag(fit.spread(J))) * fit.ranges
    at = {name: fit.names.index(name + STRIBECK) for name in joints}
    most = SIGNIFICANT * np.sqrt(fit.inflation(now, scale))
    return {name for name, i in at.items() if x[i] < most * stddev[i]}


def _falls_by_chance(fit: Fit, x: np.ndarray, other: Fit, other_x: np.ndarray, joints: int) -> bool:
    """Whether the cost is below that of a fit without the static friction of so many joints by no more than by
    chance (KEPT)."""
    _, now, scale = other.scaled(other_x)
    cost = float(np.sum(now**2)) * scale**2
    return cost - fit.cost(x) < KEPT * joints * other.inflation(now, scale) * cost / other.samples
