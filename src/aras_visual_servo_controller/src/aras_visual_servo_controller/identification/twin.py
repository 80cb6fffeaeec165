"""Fits the simulator's own parameters of a robot, so that its simulated joints repeat a recording.

The output error of the whole simulation is minimised (Ljung, System Identification, 2nd edition, 1999, section 7.4):
noise of the joint states does not bias the parameters, as it does where differences of positions are regressors. The
loops keep the errors bounded, so that one simulation goes from the first command to the last.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Dict, Optional, Tuple

import numpy as np

from aras_visual_servo import Scenario
from .advice import motion_for
from .estimates import HALF_95, Estimate, Identified, Unknown, covariance, not_told, separable
from .loops import add_state_delay
from .profile import Profile, profile
from .recording import Recording
from .replayed import DELAY, START, ReplayedRobot

#: Longest delay of a command that is searched, and the steps of the search. [s]
LONGEST_DELAY_S, DELAY_STEP_S = 0.4, 0.004
#: Steps of the delay that are tried in every round. [s]
DELAY_STEPS_S = (-0.01, -0.003, -0.001, 0.001, 0.003, 0.01)
#: Differences of parameters for derivatives, as parts of their ranges.
STEP = 1e-3
#: The fit is held near the model by a prior of this many ranges; it matters only where the recording tells nothing.
PRIOR_RANGES = 10.0
#: Most iterations with a first part of the recording, and with all of it.
FIRST_ROUNDS, ROUNDS = 20, 12
#: Longest step of a parameter in ranges, and trials of shorter ones.
MOST_STEP, TRIALS = 2.0, 8
#: Iterations end when the cost, a sum of squares of variance 1, falls by less than this; with the first part of the
#: recording, by less than this for each sample.
SETTLED, ENOUGH = 0.1, 0.01
#: The noise of a joint is at least this part of that of the median one.
LEAST_NOISE = 0.2
#: A fit has converged if the minimum that its derivatives predict is nearer than this, in standard deviations of the
#: farthest direction. Set points that jump leave ripples of about half of it.
CONVERGED = 1.0
#: And if it leaves less than this many times the noise, and of the held-out part less than this many times what it
#: leaves of the rest: otherwise the model is wrong, or the minimum.
EXPLAINED = 3.0
#: Fits are tried so often; the next one begins where the profile of the cost found a lower one.
ATTEMPTS = 3
#: Residuals may be correlated over this many samples.
LAGS = 3
#: Parameters that correlate more than this cannot be told apart.
MOST_CORRELATION = 0.97


@dataclass(frozen=True)
class Twin:
    """A robot as a recording has it.

    Attributes:
        identified: estimates, unknown ones, and the residual of the positions by joint in the fitted part [m or rad].
        names: k parameters that were fitted.  covariance: (k, k) of these, in their units.
        converged: whether the fit reached a minimum that explains the recording. If not, the standard deviations are
        infinite.
        overlay: the part of a scenario that makes it this robot.
        times_s: (k,) stamps of the joint states that were compared, from the first command on.
        measured, simulated: (k, m) positions [m or rad].  fitted: number of samples that were fitted; the others are
        held out.  joint_names: m names.
    """

    identified: Identified
    names: Tuple[str, ...]
    covariance: np.ndarray
    converged: bool
    overlay: Dict[str, Any]
    joint_names: Tuple[str, ...]
    times_s: np.ndarray
    measured: np.ndarray
    simulated: np.ndarray
    fitted: int

    @property
    def held_out(self) -> Dict[str, float]:
        """Root mean square error of the positions by joint in the part that was not fitted [m or rad]."""
        error = (self.simulated - self.measured)[self.fitted:]
        return dict(zip(self.joint_names, np.sqrt(np.mean(error**2, axis=0)).tolist()))


def identify_twin(recording: Recording, scenario: Scenario, payload_link: Optional[str] = None,
                  threads: int = 2) -> Twin:
    """Returns the robot of a scenario as a recording has it.

    The names are `JOINT.damping`, `JOINT.friction` and gains `JOINT.p`, `.i`, `.d` of each joint with a PID loop,
    `gravity_scale`, `command_delay_s`, and with a payload_link `payload.mass` [kg] and `payload.first_x`, y, z [kg m]:
    mass times position of a point mass in the frame of that link.

    Args: scenario: with the model of the robot and its controllers.  threads: that simulate at the same time.
    Raises: ParameterError: no commands, too short, other joints than the robot's, no PID loop, no motion.
    """
    with ThreadPoolExecutor(threads) as pool:
        fit = _Fit(recording, ReplayedRobot(recording, scenario, payload_link), pool)
        return fit.twin(fit.minimum(), payload_link)


class _Fit:
    def __init__(self, recording, robot, pool):
        self._recording, self._robot, self._pool = recording, robot, pool
        self._start, self._ranges, self._least = (np.array([getattr(each, key) for each in robot.parameters])
                                                  for key in ("start", "range", "least"))
        self._names = [each.name for each in robot.parameters]
        self._delay = self._names.index(DELAY)
        # Of the noise, not of the residual: a joint that fits badly would lose its weight, and stay so.
        measured = (recording.position,) if recording.velocity is None else (recording.position, recording.velocity)
        self._weights = 1.0 / np.concatenate([_noise(each[robot.used]) for each in measured])

    def minimum(self):
        """Values that fit best.

        First of positions alone: far from the solution velocities ripple between two set points, and have many minima.
        At first the joints weigh by their residuals, which is fast. That may end where one joint fits badly.
        """
        joints = len(self._robot.names)
        x = self._start.copy()
        x[self._delay] = self._first_delay(x)
        x = self._descend(x, self._robot.first, None, FIRST_ROUNDS, 1e-2)
        x = self._descend(x, self._robot.first, self._weights[:joints], FIRST_ROUNDS, 1e-4)
        return self._descend(x, self._robot.fit, self._weights, ROUNDS, 1e-6)

    def jacobian(self, x, rows, weights, now):
        """(channels, n, parameters) of derivatives of the residual by parameters in units of their ranges."""
        def column(i):
            moved = x.copy()
            moved[i] += STEP * self._ranges[i]
            return (self._robot.residual(moved, rows, weights) - now) / STEP
        return np.stack(list(self._pool.map(column, range(len(x)))), axis=-1)

    def _first_delay(self, x):
        """Delay with which the model's positions fit best."""
        rows = self._robot.first
        times, (q, _) = self._recording.times_s[rows], self._robot.replay(x, rows)
        measured = self._recording.position[rows]

        def error(delay):
            late = np.column_stack([np.interp(times - delay, times, column) for column in q.T])
            apart = (late - measured)[times > times[0] + LONGEST_DELAY_S]
            return float(np.sum((apart - apart.mean(axis=0))**2 / np.var(measured, axis=0).clip(1e-12)))
        return min(np.arange(0.0, LONGEST_DELAY_S, DELAY_STEP_S).tolist(), key=error)

    def _descend(self, x, rows, weights, rounds, damping):
        """Levenberg and Marquardt's method. The number of weights chooses positions alone or velocities too; None: of
        positions alone, by their residuals."""
        follow = weights is None
        if follow:
            weights = np.ones(len(self._robot.names))
        now = self._robot.residual(x, rows, weights)
        enough = ENOUGH * now.size if follow or len(weights) < len(self._weights) else SETTLED
        for _ in range(rounds):
            x, now = self._delayed(x, now, rows, weights)
            if follow:
                rms = np.sqrt(np.mean(now**2, axis=1))
                change = 1.0 / np.maximum(rms, 1e-9 * rms.max())
                weights, now = weights * change, now * change[:, None]
            prior = self._prior(x)
            J = self.jacobian(x, rows, weights, now).reshape(-1, len(x))
            H = J.T @ J + np.eye(len(x)) / PRIOR_RANGES**2
            g = J.T @ now.ravel() + prior / PRIOR_RANGES
            cost = float(np.sum(now**2) + prior @ prior)
            held = (x <= self._least) & (g > 0.0)  # at a bound, and the cost falls beyond it
            for _ in range(TRIALS):
                part = H + damping * np.diag(np.diag(H))
                step = np.zeros(len(x))
                step[~held] = -np.linalg.solve(part[~held][:, ~held], g[~held])
                step = np.clip(step, -MOST_STEP, MOST_STEP)
                trial = np.maximum(x + step * self._ranges, self._least)
                new, prior = self._robot.residual(trial, rows, weights), self._prior(trial)
                if float(np.sum(new**2) + prior @ prior) < cost:
                    break
                damping *= 5.0
            else:
                return x
            x, now, damping = trial, new, max(damping / 10.0, 1e-9)
            if min(-g @ step, cost - float(np.sum(now**2) + prior @ prior)) < enough:
                break
        return x

    def _prior(self, x):
        return (x - self._start) / self._ranges / PRIOR_RANGES

    def _delayed(self, x, now, rows, weights):
        """(x, residual) of the best delay nearby: set points that jump make its derivative hold for a period only."""
        trials = [x + step * (np.arange(len(x)) == self._delay) for step in DELAY_STEPS_S]
        found = list(self._pool.map(lambda trial: self._robot.residual(trial, rows, weights), trials))
        costs = [float(np.sum(each**2)) for each in (now, *found)]
        best = int(np.argmin(costs))
        return (x, now) if best == 0 else (trials[best - 1], found[best - 1])

    def twin(self, x, payload_link):
        """`Twin` of the fitted values."""
        robot, rows, names = self._robot, self._robot.fit, self._names
        for attempt in range(ATTEMPTS):
            now = robot.residual(x, rows, self._weights)
            scale = np.sqrt(np.mean(now**2))  # 1 if the model explains all but the noise
            weights, now = self._weights / scale, now / scale
            flat = self.jacobian(x, rows, weights, now).reshape(-1, len(x))
            inverse, null = separable(flat)
            # The predicted step, in standard deviations; a parameter at its bound cannot follow.
            free = x > self._least
            near = np.linalg.norm(flat[:, free] @ (separable(flat[:, free])[0] @ now.ravel())) < CONVERGED
            found = self._profile(x, weights, flat) if near else None
            if near and found.lower is None or attempt == ATTEMPTS - 1:
                break
            if found is not None:
                x = np.maximum(x + found.lower * self._ranges, self._least)
            x = self._descend(x, rows, self._weights, ROUNDS, 1e-4)
        q, _ = robot.replay(x, robot.used)
        measured = self._recording.position[robot.used]
        residual, held_out = (np.sqrt(np.mean(part**2, axis=0)) for part in np.split(q - measured, [len(rows)]))
        explained = scale < EXPLAINED and np.all(held_out < EXPLAINED * residual)
        converged = bool(near and found.lower is None and explained)
        groups = np.repeat(np.arange(len(now)), now.shape[1])
        cov = covariance(inverse, now.ravel(), groups, LAGS)
        # The simulator delays commands by whole periods.
        cov[self._delay, self._delay] += (robot.period_s / self._ranges[self._delay])**2 / 12.0
        stddev = np.sqrt(np.diag(cov))
        sides = _sides(found, cov) if converged else HALF_95 * np.stack([stddev, stddev])
        unknown = self._unknown(x, flat, null, sides.max(axis=0))
        if not converged:
            sides[:] = stddev[:] = cov[:] = np.inf
        cov *= np.outer(self._ranges, self._ranges)
        ends = x + np.stack([-sides[0], sides[1]]) * self._ranges
        mine = [name for name in names if not name.endswith(START)]
        estimates = {each.name: Estimate(float(x[i]), float(stddev[i] * each.range), each.unit,
                                         (float(ends[0, i]), float(ends[1, i])))
                     for i, each in enumerate(robot.parameters) if each.name in mine and each.name not in unknown}
        rest = [Unknown(name, tuple(others), motion_for(name, payload_link)) for name, others in unknown.items()
                if name in mine]
        add_state_delay(self._recording, estimates, rest)
        # Unknown ones stay as fitted: only together with the others do they repeat the motion.
        values = {name: float(value) for name, value in zip(names, x)}
        section = robot.overlay(values)
        section["sim"][DELAY] = round(max(values[DELAY], 0.0), 6)
        return Twin(Identified(estimates, rest, dict(zip(robot.names, residual.tolist()))), tuple(names), cov,
                    converged, section, robot.names, self._recording.times_s[robot.used] - robot.start_s, measured, q,
                    len(rows))

    def _profile(self, x, weights, flat):
        def residual(way):
            moved = np.maximum(x + way * self._ranges, self._least)
            return self._robot.residual(moved, self._robot.fit, weights).ravel()
        return profile(residual, flat, self._pool)

    def _unknown(self, x, flat, null, half):
        """Name -> those it cannot be told from, of each parameter that the recording does not tell.

        half: (parameters,) half-widths of the intervals in ranges.
        """
        names = self._names
        unknown = not_told(null, names)
        # The full covariance tells of directions that the recording tells badly, and which parameters share them.
        H = flat.T @ flat + 1e-12 * np.eye(len(x)) * np.trace(flat.T @ flat) / len(x)
        full = np.linalg.inv(H)
        spread = np.sqrt(np.diag(full))
        correlation = full / np.outer(spread, spread)
        for i, each in enumerate(self._robot.parameters):
            if max(half[i], HALF_95 * spread[i] if each.name in unknown else 0.0) * each.range > max(
                    each.range, abs(x[i] - each.least) if np.isfinite(each.least) else 0.0):
                unknown.setdefault(each.name, tuple(names[j] for j in range(len(names)) if j != i
                                                    and abs(correlation[i, j]) > MOST_CORRELATION))
        return unknown


def _sides(found: Profile, cov: np.ndarray) -> np.ndarray:
    """(2, k) ways to both ends of the 95 % intervals: of the directions with a profile, and of the others."""
    straight = np.eye(len(cov)) - found.directions @ found.directions.T
    symmetric = HALF_95**2 * np.diag(straight @ cov @ straight)
    return np.sqrt(np.stack([symmetric + np.sum(np.maximum(side * found.ends, 0.0).max(axis=1)**2, axis=0)
                             for side in (-1.0, 1.0)]))


def _noise(values: np.ndarray) -> np.ndarray:
    """Standard deviation of white noise on columns that are smooth otherwise, (m,), by their third differences."""
    noise = np.sqrt(np.mean(np.diff(values, 3, axis=0)**2, axis=0) / 20.0)
    # A joint that rests between two steps of its encoder shows none.
    return np.maximum(noise, max(LEAST_NOISE * float(np.median(noise)), 1e-9))
