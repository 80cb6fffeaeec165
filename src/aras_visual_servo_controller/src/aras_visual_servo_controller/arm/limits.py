"""Limits of joint velocity and position. Pure arithmetic; most functions return the factor by which to slow the motion.

The two that every image needs are C++. The loops of the others go over floats because, for the few joints of an arm,
they take a fifth of the time of array expressions.
"""

from math import inf, sqrt

import numpy as np

from .._kinematics import position_factor, velocity_factor

__all__ = ["accelerated", "braking_factor", "position_factor", "velocity_factor"]


def braking_factor(q, q_dot, lower, upper, acceleration, dt_s):
    """Factor in [0, 1] with which every joint, after q_dot has been held for dt_s, can still brake before its limit.

    v dt + v^2 / (2 a) <= room, solved for v. Args: (n,) each, lower, upper and acceleration (> 0) may be infinite.
    """
    factor = 1.0
    limits = zip(q.tolist(), q_dot.tolist(), lower.tolist(), upper.tolist(), acceleration.tolist())
    for here, speed, low, high, most in limits:
        room = high - here if speed > 0.0 else here - low
        if speed == 0.0 or room == inf or most == inf:
            continue
        allowed = most * (sqrt(dt_s * dt_s + 2.0 * max(0.0, room) / most) - dt_s)
        factor = min(factor, allowed / abs(speed))
    return factor


def accelerated(before, wanted, change):
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
