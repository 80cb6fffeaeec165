"""Gain, bandwidth and delays of the joints' position or velocity loops, from commands and positions alone."""

from typing import Dict, List, Tuple

import numpy as np
from scipy.optimize import least_squares

from aras_visual_servo import ParameterError
from .advice import LEAST_SPAN
from .estimates import HALF_95, Estimate, Identified, Unknown, covariance
from .recording import FEWEST_SAMPLES, Recording

#: Longest delay of a command that is searched, and the steps of the search. [s]
LONGEST_DELAY_S, DELAY_STEP_S = 0.5, 0.02
#: Time constants from which the fit starts. [s]
STARTS_S = (0.02, 0.1, 0.5)
FASTEST_S = 1e-4
#: Rows over which residuals may be correlated.
LAGS = 3
STATE_DELAY = "joint_state_delay_s"


def identify_loops(recording: Recording) -> Identified:
    """Fits each joint's loop as a delay and a lag of first order, by the error of the simulated output.

    Position commands u: dq/dt = k (g u(t - d) + c - q). Velocity commands: dv/dt = k (g u(t - d) - v), dq/dt = v.
    The names are `JOINT.bandwidth` k [1/s], `JOINT.gain` g and `JOINT.command_delay_s` d, from the stamp of
    the command to the stamps of the joint states; and `joint_state_delay_s`, from the stamp of a joint state to its
    arrival, which needs received_s. A bandwidth whose 95 % interval reaches infinity is unknown.

    Raises: ParameterError: no commands; no joint moved.
    """
    faults = []
    if recording.commands is None:
        faults.append("commands: found none, allowed positions or velocities of all joints")
    elif np.count_nonzero(_answered(recording)) < FEWEST_SAMPLES:
        faults.append(f"commands.times_s: found {np.count_nonzero(_answered(recording))} joint states later than "
                      f"{LONGEST_DELAY_S} s after the first command, allowed at least {FEWEST_SAMPLES}")
    moved = np.ptp(recording.position, axis=0) > LEAST_SPAN
    if not np.any(moved):
        faults.append(f"position: found motions of at most {np.ptp(recording.position, axis=0).max():.2g}, allowed "
                      f"more than {LEAST_SPAN} m or rad of one joint")
    if faults or recording.commands is None:
        raise ParameterError(faults)
    estimates: Dict[str, Estimate] = {}
    unknown: List[Unknown] = []
    residual: Dict[str, float] = {}
    for j, name in enumerate(recording.joint_names):
        names = (f"{name}.command_delay_s", f"{name}.bandwidth", f"{name}.gain")
        if not moved[j] or np.ptp(recording.commands.values[:, j]) == 0.0:
            unknown += [Unknown(each, (), f"command {name} in steps of more than {LEAST_SPAN} m or rad, both ways")
                        for each in names]
            continue
        (delay, lag, gain), cov, rms = _fit(recording, j)
        residual[name] = rms
        stddev = np.sqrt(np.diag(cov))
        estimates[names[0]] = Estimate(delay, float(stddev[0]), "s")
        estimates[names[2]] = Estimate(gain, float(stddev[2]), "1")
        if lag > HALF_95 * stddev[1]:
            estimates[names[1]] = Estimate(1.0 / lag, float(stddev[1]) / lag**2, "1/s")
        else:
            unknown.append(Unknown(names[1], (), f"record {name} at a higher rate, in faster and larger steps"))
    add_state_delay(recording, estimates, unknown)
    return Identified(estimates, unknown, residual)


def add_state_delay(recording: Recording, estimates: Dict[str, Estimate], unknown: List[Unknown]) -> None:
    """Adds `joint_state_delay_s`, the mean time from the stamp of a joint state to its arrival, where that is known.
    Where they arrive before their stamp, the recorder has another clock."""
    late = None if recording.received_s is None else recording.received_s - recording.times_s
    if late is None or late.mean() < 0.0:
        unknown.append(Unknown(STATE_DELAY, (), "record when each joint state arrives, on the clock of its stamp"))
    else:
        estimates[STATE_DELAY] = Estimate(float(late.mean()), float(late.std(ddof=1) / np.sqrt(len(late))), "s")


def _answered(recording: Recording) -> np.ndarray:
    """(n,) whether the input of a sample is known whatever the delay: what acts before the first command is not."""
    assert recording.commands is not None
    used: np.ndarray = recording.times_s >= recording.commands.times_s[0] + LONGEST_DELAY_S
    return used


def _fit(recording: Recording, joint: int) -> Tuple[Tuple[float, float, float], np.ndarray, float]:
    """((delay, lag, gain), their covariance (3, 3), RMS of the residual) of one joint."""
    commands = recording.commands
    assert commands is not None
    used = _answered(recording)
    at = recording.times_s[used][0]
    times, q = recording.times_s[used] - at, recording.position[used, joint]
    stamps, values = commands.times_s - at, commands.values[:, joint]
    velocity = commands.kind == "velocity"

    def linear(delay, lag):
        """(matrix, gain and states that fit best)"""
        matrix = _basis(times, stamps + delay, values, lag, velocity)
        return matrix, np.linalg.lstsq(matrix, q, rcond=None)[0]

    def error(p):
        matrix, best = linear(*p)
        return q - matrix @ best

    grid = [(delay, lag) for lag in STARTS_S for delay in np.arange(0.0, LONGEST_DELAY_S, DELAY_STEP_S)]
    start = min(grid, key=lambda p: float(np.sum(error(p)**2)))
    bounds = ([-0.05, FASTEST_S], [LONGEST_DELAY_S, 1e3])
    found = least_squares(error, start, bounds=bounds, x_scale=(0.01, 0.01), diff_step=1e-3).x
    matrix, best = linear(*found)
    step = np.array([1e-3, max(1e-2 * found[1], FASTEST_S / 2)])
    slopes: List[np.ndarray] = []
    for i in range(2):
        high, low = found + step * (np.arange(2) == i), found - step * (np.arange(2) == i)
        ends = [_basis(times, stamps + p[0], values, p[1], velocity) @ best for p in (high, low)]
        slopes.append((ends[0] - ends[1]) / (2.0 * step[i]))
    left = np.column_stack([*slopes, matrix])
    residual = q - matrix @ best
    cov = covariance(np.linalg.pinv(left), residual, np.zeros(len(q), dtype=int), LAGS)
    return ((float(found[0]), float(found[1]), float(best[0])), cov[:3, :3],
            float(np.sqrt(np.mean(residual**2))))


def _basis(times, stamps, values, lag, velocity):
    """Columns for gain, offset, decay of the first state, and with velocity the position at the start.

    Exact for commands that hold: between two events the lag runs to its input, and its integral has a closed form.
    """
    events = np.union1d(times, stamps[(stamps > times[0]) & (stamps < times[-1])])
    held = values[np.clip(np.searchsorted(stamps, events, side="right") - 1, 0, None)]
    steps = np.diff(events)
    fade = np.exp(-steps / lag)
    state, total = np.empty(len(events)), np.empty(len(events))
    state[0], total[0] = held[0], 0.0
    x, integral = float(held[0]), 0.0
    for i, (u, dt, e) in enumerate(zip(held.tolist(), steps.tolist(), fade.tolist()), 1):
        integral += u * dt + (x - u) * lag * (1.0 - e)
        x = u + (x - u) * e
        state[i], total[i] = x, integral
    at = np.searchsorted(events, times)
    decay = np.exp(-(times - times[0]) / lag)
    response = total[at] if velocity else state[at]
    return np.column_stack([response, np.ones(len(times)), 1.0 - decay if velocity else decay])
