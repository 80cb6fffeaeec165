"""Bandwidth of the joints' identified loops.

The bandwidth is the frequency at which the gain from set point to joint has fallen by 3 dB, a factor of sqrt(1/2), from
that at frequency zero (Åström and Murray, Feedback Systems, 2008, section 6.3).
"""

from typing import Dict

import numpy as np

from aras_visual_servo import ModelError
from .dynamics import TreeDynamics
from .estimates import HALF_95, Estimate
from .replayed import PID, START, ReplayedRobot

#: Frequencies at which the gain is computed. [Hz]
HERTZ = np.geomspace(1e-3, 1e4, 1401)
FALLEN = np.sqrt(0.5)
#: Difference of a parameter for derivatives, in ranges.
STEP = 1e-4


def bandwidth(gains: Dict[str, float], damping: float, inertia: float, velocity: bool) -> float:
    """Returns the bandwidth [Hz] of a joint with a PID, dry friction and the other joints' motion left out; nan for a
    gain that does not fall.

    With C = p + i / s + d s, position: C / (M s^2 + b s + C); velocity: C / (M s + b + C).

    Args: gains: p, i and d.  damping: b [N s/m or N m s/rad].  inertia: M [kg or kg m^2].  velocity: whether the loop
    controls velocity.
    """
    s = 2.0j * np.pi * HERTZ
    C = gains["p"] + gains["i"] / s + gains["d"] * s
    plant = inertia * s + damping
    gain = np.abs(C / ((plant if velocity else plant * s) + C))
    still = gains["p"] / (gains["p"] + damping) if velocity and gains["i"] == 0.0 else 1.0
    below = np.nonzero(gain < FALLEN * still)[0]
    if len(below) == 0 or below[0] == 0:
        return float("nan")
    ends = slice(below[0] - 1, below[0] + 1)
    return float(np.exp(np.interp(-FALLEN * still, -gain[ends], np.log(HERTZ[ends]))))


def bandwidths(robot: ReplayedRobot, x: np.ndarray, covariance: np.ndarray, q: np.ndarray) -> Dict[str, Estimate]:
    """Returns the bandwidth of each joint with a loop [Hz], with the standard deviation that the parameters' gives it.

    A joint whose bandwidth the recording does not tell is left out, and so are all of a robot with mimic joints.

    Args: x: values of the robot's parameters.  covariance: of them.  q: (m,) posture.
    """
    def at(values: np.ndarray) -> np.ndarray:
        inertia = dict(zip(robot.names, _inertia(robot, values, q)))
        by_name = {each.name: float(value) for each, value in zip(robot.parameters, values)}
        return np.array([bandwidth({key: by_name.get(f"{name}.{key}", 0.0) for key in PID}, by_name[f"{name}.damping"],
                                   inertia[name], name in robot.velocity_loops) for name in joints])

    joints = [name for name in robot.names if any(each.name == f"{name}.p" for each in robot.parameters)]
    try:
        value = at(x)
    except ModelError:
        return {}
    slopes = np.zeros((len(joints), len(x)))
    for i, each in enumerate(robot.parameters):
        if not each.name.endswith(START):
            step = STEP * each.range * (np.arange(len(x)) == i)
            slopes[:, i] = (at(x + step) - value) / (STEP * each.range)
    stddev = np.sqrt(np.einsum("ji,ik,jk->j", slopes, covariance, slopes)) if np.all(np.isfinite(covariance)) \
        else np.full(len(joints), np.inf)
    return {name: Estimate(float(v), float(s), "Hz") for name, v, s in zip(joints, value, stddev)
            if np.isfinite(v) and (np.isinf(s) or HALF_95 * s < v)}


def _inertia(robot, values, q):
    """(m,) inertia of each joint of a recording while the others rest."""
    tree = TreeDynamics(robot.as_scenario(values).urdf_xml())
    m = len(tree.joint_names)
    posture = np.zeros(m)
    for name, position in zip(robot.names, q):
        posture[tree.joint_names.index(name)] = position
    motion = (np.tile(posture, (m, 1)), np.zeros((m, m)), np.eye(m))
    M = tree.efforts([tree.inertias], motion, (0.0, 0.0, 0.0))[0]
    return [M[i, i] for i in (tree.joint_names.index(name) for name in robot.names)]
