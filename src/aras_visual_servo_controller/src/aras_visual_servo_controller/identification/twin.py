"""Fits the simulator's own parameters of a robot, so that its simulated joints repeat a recording.

The output error of the whole simulation is minimised (Ljung, System Identification, 2nd edition, 1999, section 7.4):
noise of the joint states does not bias the parameters, as it does where differences of positions are regressors. The
loops keep the errors bounded, so that one simulation goes from the first command to the last.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Callable, Dict, Iterable, List, Optional, Set, Tuple

import numpy as np

from aras_visual_servo import Scenario
from .advice import motion_for
from .bandwidth import bandwidths
from .estimates import HALF_95, Estimate, Identified, Unknown, covariance, not_told, separable
from .loops import STATE_DELAY, add_state_delay
from .profile import Profile, profile
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
#: Residuals are taken to be at least this part of the noise.
LEAST_SCALE = 0.1
#: A fit has converged if the minimum that its derivatives predict is nearer than this, in standard deviations of the
#: farthest direction. Set points that jump leave ripples of about half of it.
CONVERGED = 1.0
#: And if it leaves less than this many times the noise, and of the held-out part less than this many times what it
#: leaves of the rest and what the uncertainty of the parameters predicts: otherwise the model is wrong, or the minimum.
EXPLAINED = 3.0
#: Or less than this part of the standard deviation of each joint's positions: no model of an arm explains all but the
#: noise of good encoders. Residuals are then correlated over this time. [s]
MODEL_ERROR, MODEL_LAG_S = 0.005, 0.5
#: Fits are tried so often; the next one begins where the profile of the cost found a lower one.
ATTEMPTS = 3
#: Static friction is looked for with these parts of the joint's highest speed as the one over which it fades, and with
#: this difference for its derivative, in ranges.
FADING_PARTS, STRIBECK_STEP = (0.02, 0.1), 0.02
#: It is fitted if the cost would fall by more than this in the score test of a joint, and kept if it falls by more for
#: each of them: the likelihood ratio of two parameters has less in 999 of 1000 cases.
SEEN, KEPT = 20.0, 13.8
#: And if it is more than this many of its standard deviations.
SIGNIFICANT = 4.0
#: Static friction is not told where its interval is wider than Coulomb friction and than this part of its range.
STRIBECK_TOLD = 0.1
#: A fit that leaves more than EXPLAINED times the noise begins anew, with the model's gains and the payload's mass
#: multiplied by these; the lowest cost counts. One that was found twice, within this part, is the minimum.
STARTS, SAME = ((1.0, 1.0), (3.0, 0.2), (0.3, 1.0)), 0.01
#: A joint moved both ways if the shorter way is more than this many times the noise of its positions.
BOTH_WAYS = 20.0
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
        by_noise: root mean square residual of the fitted part by the noise; about 1 where the model is complete.
        bandwidth: of each joint's loop, by joint [Hz].
        overlay: the part of a scenario that makes it this robot.
        times_s: (k,) stamps of the joint states that were compared, from the first command on.
        measured, simulated: (k, m) positions [m or rad].  fitted: number of samples that were fitted; the others are
        held out.  joint_names: m names.
    """

    identified: Identified
    names: Tuple[str, ...]
    covariance: np.ndarray
    converged: bool
    by_noise: float
    bandwidth: Dict[str, Estimate]
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
                  threads: int = 2, progress: Optional[Callable[[float, float], None]] = None) -> Twin:
    """Returns the robot of a scenario as a recording has it.

    The names are `JOINT.damping`, `JOINT.friction` and gains `JOINT.p`, `.i`, `.d` of each joint with a PID loop,
    `gravity_scale`, `command_delay_s`, and with a payload_link `payload.mass` [kg] and `payload.first_x`, y, z [kg m]:
    mass times position of a point mass in the frame of that link. A joint of the model with static friction, and one
    whose static friction the recording shows, has `JOINT.stribeck`, static minus Coulomb friction, and
    `JOINT.stribeck_velocity`.

    Args: scenario: with the model of the robot and its controllers.  threads: that simulate at the same time.
    progress: called after each iteration with (seconds of the recording that it fits, root mean square error by the
    noise), or None.
    Raises: ParameterError: no commands, too short, other joints than the robot's, no PID loop, no motion.
    """
    found: List[Tuple[float, _Fit, np.ndarray, List[str]]] = []
    with ThreadPoolExecutor(threads) as pool:
        for gains, mass in STARTS:
            fit, x, untold = _fitted(recording, scenario, payload_link, pool, gains, mass, progress)
            cost = fit.cost(x)
            found.append((cost, fit, x, untold))
            costs = sorted(each[0] for each in found)
            if costs[0] < EXPLAINED**2 * fit.samples or costs[1:] and costs[1] < (1.0 + SAME) * costs[0]:
                break
        _, fit, x, untold = min(found, key=lambda each: each[0])
        return fit.twin(x, payload_link, untold)


def _fitted(recording: Recording, scenario: Scenario, payload_link: Optional[str], pool: ThreadPoolExecutor,
            gains: float, mass: float, progress: Optional[Callable[[float, float], None]]
            ) -> Tuple["_Fit", np.ndarray, List[str]]:
    """(fit, values that fit best, joints of whose static friction the recording tells nothing) from one start."""
    speeds: Dict[str, float] = {}

    def fit_of(more: Dict[str, float]) -> _Fit:
        return _Fit(recording, ReplayedRobot(recording, scenario, payload_link, {**speeds, **more}), pool, progress)
    fit = fit_of({})
    x = fit.minimum(gains, mass)
    while True:
        # That of one joint may hide that of another.
        seen, untold = fit.static_friction(x, fit_of)
        wider, lower, weak = fit, x, set(seen)
        while weak and seen:
            wider = fit_of(seen)
            lower = wider.from_other(fit, x)
            weak = wider.weak(lower, seen)
            seen = {name: speed for name, speed in seen.items() if name not in weak}
        if not seen:
            return fit, x, untold
        # The minima of both models are compared, not a minimum with the place at which a fit has stopped.
        x = min(x, fit.from_other(wider, lower), key=fit.cost)
        if wider.falls_by_chance(lower, fit, x, len(seen)):
            return fit, x, untold
        fit, x, speeds = wider, lower, {**speeds, **seen}


class _Fit:
    def __init__(self, recording, robot, pool, progress):
        self._recording, self._robot, self._pool, self._progress = recording, robot, pool, progress
        self._start, self._ranges, self._least = (np.array([getattr(each, key) for each in robot.parameters])
                                                  for key in ("start", "range", "least"))
        self._names = [each.name for each in robot.parameters]
        self._delay = self._names.index(DELAY)
        self._loops = [(self._names.index(f"{joint}.p"), [
            i for i, name in enumerate(self._names)
            if name.rpartition(".")[0] == joint and not name.endswith((START, FADES))])
            for joint in robot.names if f"{joint}.p" in self._names]
        # Of the noise, not of the residual: a joint that fits badly would lose its weight, and stay so.
        measured = (recording.position,) if recording.velocity is None else (recording.position, recording.velocity)
        self._weights = 1.0 / np.concatenate([_noise(each[robot.used]) for each in measured])

    def minimum(self, gains: float, mass: float) -> np.ndarray:
        """Values that fit best. Args: gains, mass: factors on the model's gains and on the payload's mass at the start.

        First of positions alone: far from the solution velocities ripple between two set points, and have many minima.
        At first the joints weigh by their residuals, which is fast. That may end where one joint fits badly.
        """
        joints = len(self._robot.names)
        x = self._start.copy()
        x[[i for _, group in self._loops for i in group if self._names[i].rpartition(".")[2] in PID]] *= gains
        x[[i for i, name in enumerate(self._names) if name == PAYLOAD[0]]] *= mass
        x[self._delay] = self._first_delay(x)
        x = self._descend(x, self._robot.first, None, FIRST_ROUNDS, 1e-2)
        x = self._descend(x, self._robot.first, self._weights[:joints], FIRST_ROUNDS, 1e-4)
        return self._descend(x, self._robot.fit, self._weights, ROUNDS, 1e-6)

    @property
    def samples(self) -> int:
        """Number of residuals."""
        return len(self._weights) * len(self._robot.fit)

    def cost(self, x: np.ndarray) -> float:
        """Sum of the squares of the residuals, by the noise."""
        return float(np.sum(self._robot.residual(x, self._robot.fit, self._weights)**2))

    def _scaled(self, x):
        """(weights, residual by them, scale): the residual has the variance 1, or less where it is far below the noise;
        the scale is that of the residual by the noise, and 1 if the model explains all but the noise."""
        now = self._robot.residual(x, self._robot.fit, self._weights)
        scale = max(float(np.sqrt(np.mean(now**2))), LEAST_SCALE)
        return self._weights / scale, now / scale, scale

    def from_other(self, other: "_Fit", x: np.ndarray) -> np.ndarray:
        """Values that fit best, from those of a fit with other parameters."""
        theirs = dict(zip(other._names, x))
        begin = np.array([theirs.get(name, value) for name, value in zip(self._names, self._start)])
        new = [i for i, name in enumerate(self._names) if name.endswith(STRIBECK) and name not in theirs]
        begin[new] = STRIBECK_STEP * self._ranges[new]
        return self._descend(begin, self._robot.fit, self._weights, ROUNDS, 1e-4)

    def static_friction(self, x: np.ndarray, fit_of: Callable[[Dict[str, float]], "_Fit"]
                        ) -> Tuple[Dict[str, float], List[str]]:
        """(speeds by name of the joints whose static friction the recording shows, joints of which it cannot tell).

        The score test (Rao, Proc. Cambridge Philosophical Society 44(1), 1948): the fall of the cost that the
        derivatives by static friction predict beside those by all other parameters.
        """
        robot, rows = self._robot, self._robot.fit
        weights, now, scale = self._scaled(x)
        inflation = self._inflation(now, scale)
        fitted = np.linalg.qr(self.jacobian(x, rows, weights, now).reshape(-1, len(x)))[0]
        position = self._recording.position[robot.used]
        top = np.max(np.abs(np.gradient(position, self._recording.period_s, axis=0)), axis=0)
        asked = {name: float(speed) for name, speed in zip(robot.names, top)
                 if name + ".p" in self._names and name + STRIBECK not in self._names and speed > 0.0}
        seen: Dict[str, Tuple[float, float]] = {}
        told: Set[str] = set()
        for part in FADING_PARTS:
            speeds = {name: part * speed for name, speed in asked.items()}
            wider = fit_of(speeds)
            begin = wider._start.copy()
            begin[[wider._names.index(name) for name in self._names]] = x
            begin[[wider._names.index(name + STRIBECK) for name in asked]] = 0.0

            def column(name: str) -> np.ndarray:
                moved = begin.copy()
                i = wider._names.index(name + STRIBECK)
                moved[i] += STRIBECK_STEP * wider._ranges[i]
                change: np.ndarray = (wider._robot.residual(moved, rows, weights) - now).ravel() / STRIBECK_STEP
                return change - fitted @ (fitted.T @ change)
            for name, alone in zip(asked, self._pool.map(column, asked)):
                size, friction = float(np.linalg.norm(alone)), self._names.index(f"{name}.friction")
                most = max(x[friction] / self._ranges[friction], STRIBECK_TOLD)
                if size * most > HALF_95:
                    told.add(name)
                fall = -float(alone @ now.ravel()) / max(size, 1e-12)
                if fall > 0.0 and fall**2 > max(SEEN * inflation, seen.get(name, (0.0, 0.0))[0]):
                    seen[name] = (fall**2, speeds[name])
        return {name: speed for name, (_, speed) in seen.items()}, [name for name in asked if name not in told]

    def weak(self, x: np.ndarray, joints: Iterable[str]) -> Set[str]:
        """Those of the joints whose static friction is not told from none."""
        weights, now, scale = self._scaled(x)
        J = self.jacobian(x, self._robot.fit, weights, now).reshape(-1, len(x))
        stddev = np.sqrt(np.diag(np.linalg.inv(J.T @ J + np.eye(len(x)) / PRIOR_RANGES**2))) * self._ranges
        at = {name: self._names.index(name + STRIBECK) for name in joints}
        most = SIGNIFICANT * np.sqrt(self._inflation(now, scale))
        return {name for name, i in at.items() if x[i] < most * stddev[i]}

    def falls_by_chance(self, x: np.ndarray, other: "_Fit", other_x: np.ndarray, joints: int) -> bool:
        """Whether the cost is below that of a fit without the static friction of so many joints by no more than by
        chance (KEPT)."""
        _, now, scale = other._scaled(other_x)
        cost = float(np.sum(now**2)) * scale**2
        return cost - self.cost(x) < KEPT * joints * other._inflation(now, scale) * cost / other.samples

    def _inflation(self, now, scale):
        """By how much the correlation of the residuals over time inflates the variance of their sums, >= 1.

        Args: now, scale: of `_scaled`.
        """
        lags = self._lags(scale)
        both = [float(np.sum(now[:, lag:] * now[:, :-lag])) * (1.0 - lag / (lags + 1.0)) for lag in range(1, lags + 1)]
        return max(1.0, 1.0 + 2.0 * sum(both) / max(float(np.sum(now**2)), 1e-12))

    def _lags(self, scale):
        """Samples over which residuals may be correlated. Args: scale: of the residuals by the noise."""
        return LAGS if scale < EXPLAINED else round(MODEL_LAG_S / self._recording.period_s)

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
            if self._progress is not None:
                by_noise = now * (self._weights[:len(weights)] / weights)[:, None]
                self._progress(len(rows) * self._recording.period_s, float(np.sqrt(np.mean(by_noise**2))))
            if follow:
                rms = np.sqrt(np.mean(now**2, axis=1))
                change = 1.0 / np.maximum(rms, 1e-9 * rms.max())
                weights, now = weights * change, now * change[:, None]
            prior, along = self._prior(x), self._along(x)
            J = self.jacobian(x, rows, weights, now).reshape(-1, len(x)) @ along
            H = J.T @ J + along.T @ along / PRIOR_RANGES**2
            g = J.T @ now.ravel() + along.T @ prior / PRIOR_RANGES
            cost = float(np.sum(now**2) + prior @ prior)
            held = (x <= self._least) & (g > 0.0)  # at a bound, and the cost falls beyond it
            for _ in range(TRIALS):
                part = H + damping * np.diag(np.diag(H))
                step = np.zeros(len(x))
                step[~held] = -np.linalg.solve(part[~held][:, ~held], g[~held])
                step = np.clip(step, -MOST_STEP, MOST_STEP)
                trial = self._moved(x, step)
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

    def _along(self, x):
        """(k, k) derivatives of the parameters in ranges by the steps of `_moved`."""
        along = np.eye(len(x))
        for p, group in self._loops:
            along[group, p] = x[group] / self._ranges[group]
        return along

    def _moved(self, x, step):
        """Values after a step: that of a gain p is one of its logarithm, and scales the joint's other gains and its
        friction, too. A light joint tells little but their ratios, and the valley of the cost is straight then."""
        moved = x + step * self._ranges
        for p, group in self._loops:
            moved[p] = x[p]
            moved[group] *= np.exp(np.clip(step[p], -MOST_SCALING, MOST_SCALING))
        return np.maximum(moved, self._least)

    def _prior(self, x):
        return (x - self._start) / self._ranges / PRIOR_RANGES

    def twin(self, x, payload_link, untold=()):
        """`Twin` of the fitted values. Args: untold: joints of whose static friction the recording tells nothing."""
        robot, rows, names = self._robot, self._robot.fit, self._names
        for attempt in range(ATTEMPTS):
            weights, now, scale = self._scaled(x)
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
        one_way = self._one_way()
        repeated = (held_out < EXPLAINED * residual) | one_way
        if not np.all(repeated):
            repeated |= held_out < EXPLAINED * np.hypot(residual, self._predicted(x, flat, scale))
        complete = scale < EXPLAINED
        most = np.maximum(MODEL_ERROR * np.std(measured[:len(rows)], axis=0), EXPLAINED / self._weights[:len(residual)])
        explained = np.all(repeated) and (complete or np.all(residual < most))
        converged = bool(near and found.lower is None and explained)
        groups = np.repeat(np.arange(len(now)), now.shape[1])
        cov = covariance(inverse, now.ravel(), groups, self._lags(scale))
        # The simulator delays commands by whole periods.
        cov[self._delay, self._delay] += (robot.period_s / self._ranges[self._delay])**2 / 12.0
        stddev = np.sqrt(np.diag(cov))
        sides = _sides(found, cov) if converged and complete else HALF_95 * np.stack([stddev, stddev])
        unknown = self._unknown(x, flat, null, sides.max(axis=0))
        for name in (joint for joint, only in zip(robot.names, one_way) if only and f"{joint}.friction" in names):
            unknown[f"{name}.friction"] = (name + START,)
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
        rest += [Unknown(name + STRIBECK, (), motion_for(name + STRIBECK)) for name in untold]
        add_state_delay(self._recording, estimates, rest)
        # Unknown ones stay as fitted: only together with the others do they repeat the motion.
        values = {name: float(value) for name, value in zip(names, x)}
        section = robot.overlay(values)
        section["sim"][DELAY] = round(max(values[DELAY], 0.0), 6)
        if STATE_DELAY in estimates:
            section["time"] = {STATE_DELAY: round(max(estimates[STATE_DELAY].value, 0.0), 6)}
        return Twin(Identified(estimates, rest, dict(zip(robot.names, residual.tolist()))), tuple(names), cov,
                    converged, float(scale), bandwidths(robot, x, cov, measured.mean(axis=0)), section, robot.names,
                    self._recording.times_s[robot.used] - robot.start_s, measured, q, len(rows))

    def _one_way(self):
        """(m,) whether a joint moved one way only in the fitted part, towards a set point that began where no message
        tells: its friction and this place are one, and the motion back shows it."""
        q = self._recording.position[self._robot.fit]
        ways = [np.max(np.maximum.accumulate(side * q, axis=0) - side * q, axis=0) for side in (-1.0, 1.0)]
        starts = np.array([name + START in self._names for name in self._robot.names])
        return starts & (np.min(ways, axis=0) * self._weights[:q.shape[1]] < BOTH_WAYS)

    def _predicted(self, x, flat, scale):
        """(m,) error of the positions in the held-out part that the uncertainty of the parameters predicts: what the
        fitted part tells badly may show there."""
        robot = self._robot
        weights = self._weights[:len(robot.names)] / scale
        now = robot.residual(x, robot.used, weights)
        J = self.jacobian(x, robot.used, weights, now)[:, len(robot.fit):]
        cov = np.linalg.inv(flat.T @ flat + np.eye(len(x)) / PRIOR_RANGES**2)
        return np.sqrt(np.mean(np.einsum("cni,ij,cnj->cn", J, cov, J), axis=1)) / weights

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
    return np.maximum(noise, max(LEAST_NOISE * float(np.median(noise)), FINEST))
