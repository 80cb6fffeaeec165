"""Limits of joint velocity and position: pure arithmetic, each function returns the factor it applies.

Loops over floats: for the few joints of an arm they take a fifth of the time of array expressions.
"""


def velocity_factor(q_dot, limit):
    """Factor in (0, 1] that brings every joint within its velocity limit and keeps the direction of motion.

    Args: q_dot, limit: (n,), limit > 0 or inf [m/s or rad/s].
    """
    worst = max(abs(speed) / most for speed, most in zip(q_dot.tolist(), limit.tolist()))
    return 1.0 if worst <= 1.0 else 1.0 / worst


def position_factor(q, q_dot, lower, upper, horizon_s):
    """Factor in [0, 1] that keeps q + q_dot * horizon_s within [lower, upper], and the joint that asks for it.

    A joint beyond its limit may only move back. Args: (n,) each, lower and upper may be infinite; horizon_s > 0 [s].
    Returns: (factor, index of the joint or None).
    """
    factor, joint = 1.0, None
    limits = zip(q.tolist(), q_dot.tolist(), lower.tolist(), upper.tolist())
    for i, (here, speed, low, high) in enumerate(limits):
        way = speed * horizon_s
        if way > 0.0 and here + way > high:
            room = (high - here) / way
        elif way < 0.0 and here + way < low:
            room = (low - here) / way
        else:
            continue
        if room < factor:
            factor, joint = max(0.0, room), i
    return factor, joint
