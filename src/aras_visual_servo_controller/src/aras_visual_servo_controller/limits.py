"""Limits of joint velocity and position: pure arithmetic, each function returns the factor it applied."""

import numpy as np


def velocity_factor(q_dot, limit):
    """Factor in (0, 1] that brings every joint within its velocity limit and keeps the direction of motion.

    Args: q_dot, limit: (n,), limit > 0 or inf [m/s or rad/s].
    """
    worst = float((np.abs(q_dot) / limit).max())
    return 1.0 if worst <= 1.0 else 1.0 / worst


def position_factor(q, q_dot, lower, upper, horizon_s):
    """Factor in [0, 1] that keeps q + q_dot * horizon_s within [lower, upper], and the joint that asks for it.

    A joint beyond its limit may only move back. Args: (n,) each, lower and upper may be infinite; horizon_s > 0 [s].
    Returns: (factor, index of the joint or None).
    """
    ahead = q + q_dot * horizon_s
    outside = (ahead > upper) & (q_dot > 0.0) | (ahead < lower) & (q_dot < 0.0)
    if not outside.any():
        return 1.0, None
    bound = np.where(q_dot > 0.0, upper, lower)
    room = np.full(len(q), 1.0)
    room[outside] = (bound - q)[outside] / (q_dot * horizon_s)[outside]
    joint = int(room.argmin())
    return max(0.0, float(room[joint])), joint
