"""Minimises the output error of a simulated robot over a recording.

The output error of the whole simulation is minimised (Ljung, System Identification, 2nd edition, 1999, section 7.4):
noise of the joint states does not bias the parameters, as it does where differences of positions are regressors. The
loops keep the errors bounded, so that one simulation goes from the first command to the last.
"""

from concurrent.futures import ThreadPoolExecutor
from typing import Callable, Optional, Tuple

import numpy as np

from .recording import Recording
from .replayed import DELAY, FADES, PAYLOAD, PID, START, STRIBECK, ReplayedRobot

#: Longest delay of a command that is searched, and the steps of the search. [s]
LONGEST_DELAY_S, DELAY_STEP_S = 0.4, 0.004
#: Differences of parameters for derivatives, as parts of their ranges.
STEP = 1e-3
#: The fit is held near the model by a prior of this many ranges; it matters only where the recording tells nothing.
PRIOR_RANGES = 10.0
#: Most iterations with a first part of the recording, and with all of it.
FIRST_ROUNDS, ROUNDS = 20, 20
#: Longest step of a parameter in ranges, and trials of shorter ones.
MOST_STEP, TRIALS = 2.0, 8
#: Longest step of the logarithm of a gain.
MOST_SCALING = 1.0
#: Iterations end when the cost, a sum of squares of variance 1, falls by less than this; with the first part of the
#: recording, by less than this for each sample.
SETTLED, ENOUGH = 0.1, 0.01
#: The noise of a joint is at least this part of that of the median one, and this: no encoder is finer, and recordings
#: of a simulator have none. [m, rad or per s]
LEAST_NOISE, FINEST = 0.2, 1e-5
#: Joint states that are farther apart than this many times their median distance have lost one between them.
MOST_STEP_PART = 1.5
#: Residuals are taken to be at least this part of the noise.
LEAST_SCALE = 0.1
#: A model that leaves more than this many times the noise does not explain the recording.
EXPLAINED = 3.0
#: Residuals may be correlated over this many samples.
LAGS = 3
#: Residuals of a fit that leaves more than that are correlated over this time. [s]
MODEL_LAG_S = 0.5
#: Static friction begins with this part of its range, which is the difference for its derivative, too.
STRIBECK_STEP = 0.02


class Fit:
    """A simulated robot beside a recording of it.

    Attributes:
        recording: of n joint states.  robot: with k parameters.  names: of these.  start, ranges, least: (k,) values of
        the model, ranges and bounds of the parameters.  delay: index of the delay.  others: (k,) whether a parameter is
        another.  weights: one by the noise of each joint's positions and, if recorded, velocities.
        position_weights: those of the positions.  pool: that simulates.
    Args: progress: as `identify_twin` says.
    """

    def __init__(self, recording: Recording, robot: ReplayedRobot, pool: ThreadPoolExecutor,
                 progress: Optional[Callable[[float, float], None]]) -> None:
        self.recording, self.robot, self.pool, self._progress = recording, robot, pool, progress
        self.start, self.ranges, self.least = (np.array([getattr(each, key) for each in robot.parameters])
                                               for key in ("start", "range", "least"))
        self.names = [each.name for each in robot.parameters]
        self.delay = self.names.index(DELAY)
        self.others = np.arange(len(self.names)) != self.delay
        self._loops = [(self.names.index(f"{joint}.p"), [
            i for i, name in enumerate(self.names)
            if name.rpartition(".")[0] == joint and not name.endswith((START, FADES))])
            for joint in robot.names if f"{joint}.p" in self.names]
        # Of the noise, not of the residual: a joint that fits badly would lose its weight, and stay so.
        measured = (recording.position,) if recording.velocity is None else (recording.position, recording.velocity)
        times_s = recording.times_s[robot.used]
        self.weights = 1.0 / np.concatenate([_noise(times_s, each[robot.used]) for each in measured])
        self.position_weights = self.weights[:len(robot.names)]

    def begin(self, gains: float, mass: float) -> np.ndarray:
        """Values that fit the positions of the first part best. Args: gains, mass: factors on the model's gains and on
        the payload's mass at the start.

        Of positions alone: far from the solution velocities ripple between two set points, and have many minima.
        At first the joints weigh by their residuals, which is fast. That may end where one joint fits badly.
        """
        x = self.start.copy()
        x[[i for _, group in self._loops for i in group if self.names[i].rpartition(".")[2] in PID]] *= gains
        x[[i for i, name in enumerate(self.names) if name == PAYLOAD[0]]] *= mass
        x[self.delay] = self._first_delay(x)
        x = self.descend(x, self.robot.first, None, FIRST_ROUNDS, 1e-2)
        return self.descend(x, self.robot.first, self.position_weights, FIRST_ROUNDS, 1e-4)

    def first_cost(self, x: np.ndarray) -> float:
        """Sum of the squares of the residuals of `begin`, by the noise."""
        return float(np.sum(self.robot.residual(x, self.robot.first, self.position_weights)**2))

    def finish(self, x: np.ndarray) -> np.ndarray:
        """Values that fit best, from those of `begin`."""
        return self.descend(x, self.robot.fit, self.weights, ROUNDS, 1e-6)

    @property
    def samples(self) -> int:
        """Number of residuals."""
        return len(self.weights) * len(self.robot.fit)

    def cost(self, x: np.ndarray) -> float:
        """Sum of the squares of the residuals, by the noise."""
        return float(np.sum(self.robot.residual(x, self.robot.fit, self.weights)**2))

    def scaled(self, x: np.ndarray) -> Tuple[np.ndarray, np.ndarray, float]:
        """(weights, residual by them, scale): the residual has the variance 1, or less where it is far below the noise;
        the scale is that of the residual by the noise, and 1 if the model explains all but the noise."""
        now = self.robot.residual(x, self.robot.fit, self.weights)
        scale = max(float(np.sqrt(np.mean(now**2))), LEAST_SCALE)
        return self.weights / scale, now / scale, scale

    def from_other(self, other: "Fit", x: np.ndarray) -> np.ndarray:
        """Values that fit best, from those of a fit with other parameters."""
        theirs = dict(zip(other.names, x))
        begin = np.array([theirs.get(name, value) for name, value in zip(self.names, self.start)])
        new = [i for i, name in enumerate(self.names) if name.endswith(STRIBECK) and name not in theirs]
        begin[new] = STRIBECK_STEP * self.ranges[new]
        return self.descend(begin, self.robot.fit, self.weights, ROUNDS, 1e-4)

    def jacobian(self, x: np.ndarray, rows: np.ndarray, weights: np.ndarray, now: np.ndarray) -> np.ndarray:
        """(channels, n, parameters) of derivatives of the residual by parameters in units of their ranges.

        The residual has a kink where the delay is a whole number of periods: the difference stays on one side of it.
        """
        def column(i):
            moved, step = x.copy(), STEP
            moved[i] += step * self.ranges[i]
            if i == self.delay and np.floor(moved[i] / self.robot.period_s) > np.floor(x[i] / self.robot.period_s):
                step = -STEP
                moved[i] = x[i] + step * self.ranges[i]
            return (self.robot.residual(moved, rows, weights) - now) / step
        return np.stack(list(self.pool.map(column, range(len(x)))), axis=-1)

    def spread(self, flat: np.ndarray) -> np.ndarray:
        """(k, k) covariance in ranges for white residuals of variance 1, with the prior. Args: flat: (n, k) of
        `jacobian`."""
        found: np.ndarray = np.linalg.inv(flat.T @ flat + np.eye(flat.shape[1]) / PRIOR_RANGES**2)
        return found

    def inflation(self, now: np.ndarray, scale: float) -> float:
        """By how much the correlation of the residuals over time inflates the variance of their sums, >= 1.

        Args: now, scale: of `scaled`.
        """
        lags = self.lags(scale)
        both = [float(np.sum(now[:, lag:] * now[:, :-lag])) * (1.0 - lag / (lags + 1.0)) for lag in range(1, lags + 1)]
        return max(1.0, 1.0 + 2.0 * sum(both) / max(float(np.sum(now**2)), 1e-12))

    def lags(self, scale: float) -> int:
        """Samples over which residuals may be correlated. Args: scale: of the residuals by the noise."""
        return LAGS if scale < EXPLAINED else round(MODEL_LAG_S / self.recording.period_s)

    def descend(self, x: np.ndarray, rows: np.ndarray, given: Optional[np.ndarray], rounds: int, damping: float
                ) -> np.ndarray:
        """Values of a minimum near x by Levenberg and Marquardt's method.

        Args: rows: of the recording.  given: weights of each joint's positions, or of velocities too; None: of
        positions alone, by their residuals.  rounds: most iterations.  damping: of the first one.
        """
        follow = given is None
        weights = np.ones(len(self.robot.names)) if given is None else given
        now = self.robot.residual(x, rows, weights)
        enough = ENOUGH * now.size if follow or len(weights) < len(self.weights) else SETTLED
        for _ in range(rounds):
            if self._progress is not None:
                by_noise = now * (self.weights[:len(weights)] / weights)[:, None]
                self._progress(len(rows) * self.recording.period_s, float(np.sqrt(np.mean(by_noise**2))))
            if follow:
                rms = np.sqrt(np.mean(now**2, axis=1))
                change = 1.0 / np.maximum(rms, 1e-9 * rms.max())
                weights, now = weights * change, now * change[:, None]
            prior, along = self._prior(x), self._along(x)
            J = self.jacobian(x, rows, weights, now).reshape(-1, len(x)) @ along
            H = J.T @ J + along.T @ along / PRIOR_RANGES**2
            g = J.T @ now.ravel() + along.T @ prior / PRIOR_RANGES
            cost = float(np.sum(now**2) + prior @ prior)
            free = (x > self.least) | (g < 0.0)  # or at a bound, and the cost falls beyond it
            found = self._lower(x, H, g, free, damping, cost, rows, weights)
            if found is None or found[-1] < enough:
                # The delay may be at its kink, where it stops the others.
                held = self._lower(x, H, g, free & self.others, damping, cost, rows, weights)
                found = max(filter(None, (found, held)), key=lambda each: each[-1], default=None)
            if found is None:
                break
            x, now, damping, fall = found
            if fall < enough:
                break
        return x

    def _lower(self, x, H, g, moving, damping, cost, rows, weights):
        """(values of a lower cost, their residual, damping of the next step, by how much the cost falls), or None. The
        fall counts up to what the derivatives predict.

        Args: H, g: second and first derivatives of the cost.  moving: (k,) whether a parameter moves.
        """
        for _ in range(TRIALS):
            part, step = H + damping * np.diag(np.diag(H)), np.zeros(len(x))
            step[moving] = -np.linalg.solve(part[moving][:, moving], g[moving])
            step = np.clip(step, -MOST_STEP, MOST_STEP)
            trial = self._moved(x, step)
            new, prior = self.robot.residual(trial, rows, weights), self._prior(trial)
            lower = float(np.sum(new**2) + prior @ prior)
            if lower < cost:
                return trial, new, max(damping / 10.0, 1e-9), min(float(-g @ step), cost - lower)
            damping *= 5.0
        return None

    def _first_delay(self, x):
        """Delay with which the model's positions fit best."""
        rows = self.robot.first
        times, (q, _) = self.recording.times_s[rows], self.robot.replay(x, rows)
        measured = self.recording.position[rows]

        def error(delay):
            late = np.column_stack([np.interp(times - delay, times, column) for column in q.T])
            apart = (late - measured)[times > times[0] + LONGEST_DELAY_S]
            return float(np.sum((apart - apart.mean(axis=0))**2 / np.var(measured, axis=0).clip(1e-12)))
        return min(np.arange(0.0, LONGEST_DELAY_S, DELAY_STEP_S).tolist(), key=error)

    def _along(self, x):
        """(k, k) derivatives of the parameters in ranges by the steps of `_moved`."""
        along = np.eye(len(x))
        for p, group in self._loops:
            along[group, p] = x[group] / self.ranges[group]
        return along

    def _moved(self, x, step):
        """Values after a step: that of a gain p is one of its logarithm, and scales the joint's other gains and its
        friction, too. A light joint tells little but their ratios, and the valley of the cost is straight then."""
        moved = x + step * self.ranges
        for p, group in self._loops:
            moved[p] = x[p]
            moved[group] *= np.exp(np.clip(step[p], -MOST_SCALING, MOST_SCALING))
        return np.maximum(moved, self.least)

    def _prior(self, x):
        return (x - self.start) / self.ranges / PRIOR_RANGES


def _noise(times_s: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Standard deviation of white noise on columns that are smooth otherwise, (m,), by their third differences."""
    steps = np.diff(times_s)
    whole = steps < MOST_STEP_PART * np.median(steps)  # a gap looks like noise
    whole = whole[2:] & whole[1:-1] & whole[:-2]
    thirds = np.diff(values, 3, axis=0)
    noise = np.sqrt(np.mean(thirds[whole if np.any(whole) else slice(None)]**2, axis=0) / 20.0)
    # A joint that rests between two steps of its encoder shows none.
    return np.maximum(noise, max(LEAST_NOISE * float(np.median(noise)), FINEST))
