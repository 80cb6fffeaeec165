"""Fits the simulator's own parameters of a robot, so that its simulated joints repeat a recording."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

from aras_visual_servo import Scenario
from .advice import motion_for
from .bandwidth import bandwidths
from .estimates import HALF_95, Estimate, Identified, Unknown, covariance, not_told, separable
from .fit import EXPLAINED, ROUNDS, Fit
from .loops import STATE_DELAY, add_state_delay
from .profile import Profile, profile
from .recording import Recording
from .replayed import DELAY, START, STRIBECK, ReplayedRobot
from .static_friction import with_static_friction

#: A fit has converged if the minimum that its derivatives predict is nearer than this, in standard deviations of the
#: farthest direction. Set points that jump leave ripples of about half of it.
CONVERGED = 1.0
#: And if it leaves less than EXPLAINED times the noise, or less than this part of each joint's standard deviation: no
#: model of an arm explains all but the noise of good encoders. Of the held-out part it must leave less than EXPLAINED
#: times what it leaves of the rest and what the uncertainty of the parameters predicts.
MODEL_ERROR = 0.005
#: Fits are tried so often; the next one begins where the profile of the cost found a lower one.
ATTEMPTS = 3
#: A fit that leaves more than this many times the noise begins anew, with the model's gains and the payload's mass
#: multiplied by these; the lowest cost counts. One whose first part ends no lower, by this part, goes no further.
WELL, STARTS, SAME = 1.2, ((1.0, 1.0), (3.0, 0.2), (0.3, 1.0)), 0.01
#: A joint moved both ways if the shorter way is more than this many times the noise of its positions.
BOTH_WAYS = 20.0
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
    found: List[Tuple[float, Fit, np.ndarray, List[str]]] = []
    lowest = np.inf
    with ThreadPoolExecutor(threads) as pool:
        def fit_of(speeds: Dict[str, float]) -> Fit:
            return Fit(recording, ReplayedRobot(recording, scenario, payload_link, speeds), pool, progress)
        for gains, mass in STARTS:
            fit = fit_of({})
            x = fit.begin(gains, mass)
            first = fit.first_cost(x)
            if first > (1.0 - SAME) * lowest:
                continue
            lowest = first
            fit, x, untold = with_static_friction(fit, fit.finish(x), fit_of)
            found.append((fit.cost(x), fit, x, untold))
            if found[-1][0] < WELL**2 * fit.samples:
                break
        _, fit, x, untold = min(found, key=lambda each: each[0])
        return _twin(fit, x, payload_link, untold)


def _twin(fit, x, payload_link, untold=()):
    """`Twin` of the fitted values. Args: untold: joints of whose static friction the recording tells nothing."""
    robot, rows, names = fit.robot, fit.robot.fit, fit.names
    for attempt in range(ATTEMPTS):
        weights, now, scale = fit.scaled(x)
        flat = fit.jacobian(x, rows, weights, now).reshape(-1, len(x))
        inverse, null = separable(flat)
        near = _predicted_step(fit, x, flat, now) < CONVERGED
        found = _profile(fit, x, weights, flat) if near else None
        if near and found.lower is None or attempt == ATTEMPTS - 1:
            break
        if found is not None:
            x = np.maximum(x + found.lower * fit.ranges, fit.least)
        x = fit.descend(x, rows, fit.weights, ROUNDS, 1e-4)
    q, _ = robot.replay(x, robot.used)
    measured = fit.recording.position[robot.used]
    residual, held_out = (np.sqrt(np.mean(part**2, axis=0)) for part in np.split(q - measured, [len(rows)]))
    one_way = _one_way(fit)
    repeated = (held_out < EXPLAINED * residual) | one_way
    if not np.all(repeated):
        repeated |= held_out < EXPLAINED * np.hypot(residual, _predicted(fit, x, flat, scale))
    complete = scale < EXPLAINED
    most = np.maximum(MODEL_ERROR * np.std(measured[:len(rows)], axis=0), EXPLAINED / fit.position_weights)
    explained = np.all(repeated) and (complete or np.all(residual < most))
    converged = bool(near and found.lower is None and explained)
    groups = np.repeat(np.arange(len(now)), now.shape[1])
    cov = covariance(inverse, now.ravel(), groups, fit.lags(scale))
    # The simulator delays commands by whole periods.
    cov[fit.delay, fit.delay] += (robot.period_s / fit.ranges[fit.delay])**2 / 12.0
    stddev = np.sqrt(np.diag(cov))
    sides = _sides(found, cov) if converged and complete else HALF_95 * np.stack([stddev, stddev])
    unknown = _unknown(fit, x, flat, null, sides.max(axis=0))
    for name in (joint for joint, only in zip(robot.names, one_way) if only and f"{joint}.friction" in names):
        unknown[f"{name}.friction"] = (name + START,)
    if not converged:
        sides[:] = stddev[:] = cov[:] = np.inf
    cov *= np.outer(fit.ranges, fit.ranges)
    ends = x + np.stack([-sides[0], sides[1]]) * fit.ranges
    mine = [name for name in names if not name.endswith(START)]
    estimates = {each.name: Estimate(float(x[i]), float(stddev[i] * each.range), each.unit,
                                     (float(ends[0, i]), float(ends[1, i])))
                 for i, each in enumerate(robot.parameters) if each.name in mine and each.name not in unknown}
    rest = [Unknown(name, tuple(others), motion_for(name, payload_link)) for name, others in unknown.items()
            if name in mine]
    rest += [Unknown(name + STRIBECK, (), motion_for(name + STRIBECK)) for name in untold]
    add_state_delay(fit.recording, estimates, rest)
    # Unknown ones stay as fitted: only together with the others do they repeat the motion.
    values = {name: float(value) for name, value in zip(names, x)}
    section = robot.overlay(values)
    section["sim"][DELAY] = round(max(values[DELAY], 0.0), 6)
    if STATE_DELAY in estimates:
        section["time"] = {STATE_DELAY: round(max(estimates[STATE_DELAY].value, 0.0), 6)}
    return Twin(Identified(estimates, rest, dict(zip(robot.names, residual.tolist()))), tuple(names), cov,
                converged, float(scale), bandwidths(robot, x, cov, measured.mean(axis=0)), section, robot.names,
                fit.recording.times_s[robot.used] - robot.start_s, measured, q, len(rows))


def _predicted_step(fit, x, flat, now):
    """The step that the derivatives predict, in standard deviations. A parameter at its bound cannot follow, and a
    delay at its kink, a whole number of periods, does not."""
    free = x > fit.least
    return min(float(np.linalg.norm(flat[:, moving] @ (separable(flat[:, moving])[0] @ now.ravel())))
               for moving in (free, free & fit.others))


def _one_way(fit):
    """(m,) whether a joint moved one way only in the fitted part, towards a set point that began where no message
    tells: its friction and this place are one, and the motion back shows it."""
    q = fit.recording.position[fit.robot.fit]
    ways = [np.max(np.maximum.accumulate(side * q, axis=0) - side * q, axis=0) for side in (-1.0, 1.0)]
    starts = np.array([name + START in fit.names for name in fit.robot.names])
    return starts & (np.min(ways, axis=0) * fit.position_weights < BOTH_WAYS)


def _predicted(fit, x, flat, scale):
    """(m,) error of the positions in the held-out part that the uncertainty of the parameters predicts: what the
    fitted part tells badly may show there."""
    robot = fit.robot
    weights = fit.position_weights / scale
    now = robot.residual(x, robot.used, weights)
    J = fit.jacobian(x, robot.used, weights, now)[:, len(robot.fit):]
    return np.sqrt(np.mean(np.einsum("cni,ij,cnj->cn", J, fit.spread(flat), J), axis=1)) / weights


def _profile(fit, x, weights, flat):
    def residual(way):
        moved = np.maximum(x + way * fit.ranges, fit.least)
        return fit.robot.residual(moved, fit.robot.fit, weights).ravel()
    return profile(residual, flat, fit.pool)


def _unknown(fit, x, flat, null, half):
    """Name -> those it cannot be told from, of each parameter that the recording does not tell.

    half: (parameters,) half-widths of the intervals in ranges.
    """
    names = fit.names
    unknown = not_told(null, names)
    # The full covariance tells of directions that the recording tells badly, and which parameters share them.
    H = flat.T @ flat + 1e-12 * np.eye(len(x)) * np.trace(flat.T @ flat) / len(x)
    full = np.linalg.inv(H)
    spread = np.sqrt(np.diag(full))
    correlation = full / np.outer(spread, spread)
    for i, each in enumerate(fit.robot.parameters):
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
