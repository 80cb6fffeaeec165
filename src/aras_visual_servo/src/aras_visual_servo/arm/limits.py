"""Limits of joint velocity and position. Pure arithmetic; most functions return the factor by which to slow the motion.

Those that every image needs are C++. The loops of the others go over floats because, for the few joints of an arm,
they take a fifth of the time of array expressions.
"""

from math import inf
from typing import Optional, Tuple

import numpy as np

from .._kinematics import limit_factors, position_factor, velocity_factor

__all__ = ["accelerated", "end_factor", "end_speeds", "joint_bounds", "limit_factors", "position_factor",
           "velocity_factor"]


def end_speeds(q: np.ndarray, lower: np.ndarray, upper: np.ndarray, acceleration: np.ndarray, dt_s: float,
               horizon_s: float) -> np.ndarray:
    """Returns the largest speeds, (2, n) >= 0, with which each joint may move towards its lower and its upper end.

    A joint reaches the end in horizon_s at the earliest and, after the speed v has been held for dt_s, can still brake
    before it: v dt + v^2 / (2 a) <= room. A joint beyond its end may only move back.
    Args: (n,) each, lower, upper and acceleration (> 0) may be infinite.
    """
    room = np.maximum(np.array([q - lower, upper - q]), 0.0)
    speeds, most = room / horizon_s, np.broadcast_to(acceleration, room.shape)
    braked = np.isfinite(most) & np.isfinite(room)
    most, left = most[braked], room[braked]
    speeds[braked] = np.minimum(speeds[braked], most * (np.sqrt(dt_s * dt_s + 2.0 * left / most) - dt_s))
    return speeds


def end_factor(q_dot: np.ndarray, speeds: np.ndarray) -> Tuple[float, Optional[int]]:
    """Returns the factor in [0, 1] that keeps q_dot, (n,), within `end_speeds`, and the joint that asks for it."""
    factor, joint = 1.0, None
    for i, (speed, down, up) in enumerate(zip(q_dot.tolist(), *speeds.tolist())):
        allowed = up if speed > 0.0 else down
        if abs(speed) > allowed and allowed / abs(speed) < factor:
            factor, joint = allowed / abs(speed), i
    return factor, joint


def accelerated(before: np.ndarray, wanted: np.ndarray, change: np.ndarray) -> np.ndarray:
    """Joint velocities of the next period: within `change` of those before, and along the wanted ones where possible.

    All joints are slowed by one factor, the largest at which no joint changes its velocity by more than it may. So the
    direction of the motion is the wanted one. Where there is no such factor (a joint would have to reverse at once),
    all velocities change by the same part of the difference between `before` and `wanted`.
    Args: (n,) each, change >= 0, may be infinite [m/s, rad/s].
    """
    least, most = 0.0, 1.0
    for old, new, step in zip(before.tolist(), wanted.tolist(), change.tolist()):
        if new == 0.0:
            if abs(old) > step:
                least = inf
            continue
        ends = sorted(((old - step) / new, (old + step) / new))
        least, most = max(least, ends[0]), min(most, ends[1])
    if least <= most:
        return wanted if most == 1.0 else wanted * most
    way = wanted - before
    return before + way * velocity_factor(way, np.maximum(change, 1e-12))


def joint_bounds(q: np.ndarray, before: np.ndarray, lower: np.ndarray, upper: np.ndarray, velocity: np.ndarray,
                 acceleration: np.ndarray, dt_s: float,
                 horizon_s: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Velocities that all limits of the joints allow for the next dt_s: (low, high, at_stop, short).

    A joint may reach the end of its way in horizon_s at the earliest, and has to be able to brake before it. A joint
    beyond its end may only move back. Where the change of velocity that this asks for is larger than the acceleration
    allows, the acceleration counts, and `short` is True.
    Args: (n,) each, limits may be infinite.
    Returns: low, high: (n,), low <= high.  at_stop: (2, n), whether the end of the way makes low and high.
        short: (n,), bool.
    """
    reach = end_speeds(q, lower, upper, acceleration, dt_s, horizon_s)
    at_stop = np.array([reach[0] < velocity, reach[1] < velocity])
    low, high = -np.minimum(reach[0], velocity), np.minimum(reach[1], velocity)
    change = acceleration * dt_s
    least, most = before - change, before + change
    at_stop &= np.array([low >= least, high <= most])
    short = (low > most) | (high < least)
    low, high = np.maximum(low, least), np.minimum(high, most)
    with np.errstate(invalid="ignore"):  # a joint without limits is never short of room
        middle = np.clip(0.5 * (low + high), least, most)
    return np.where(short, middle, low), np.where(short, middle, high), at_stop, short
