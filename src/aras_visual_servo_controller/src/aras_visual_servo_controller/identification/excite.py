"""Designs a motion that tells an arm's parameters: Fourier series with a small condition number, within limits.

Series and criterion: Swevers, Ganseman, Tuekel, De Schutter and Van Brussel, IEEE T-RA 13(5), 1997. The search is an
evolution with one parent: the limits are kept by scaling, so that no constraint is left to the search.
"""

from dataclasses import dataclass
from typing import Dict, Tuple
from xml.etree import ElementTree

import numpy as np
import yaml

from aras_visual_servo import ParameterError, Scenario
from .dynamics import Inertia, TreeDynamics

#: Frequencies of the series [Hz], as an arm follows them, and the time in which the motion begins and ends. [s]
HERTZ, RAMP_S = (0.1, 0.2, 0.3, 0.4, 0.5), 2.0
#: Parts of the limits that the motion takes, and the farthest that a joint goes from home. [m or rad]
POSITION_PART, SPEED_PART, MOST_WAY = 0.9, 0.4, 0.8
#: The arm is given this time to come home first. [s]
APPROACH_S = 3.0
#: Between two points of the file. [s]
STEP_S = 0.05
TRIALS, WIDTH = 150, 0.3
SHORTEST_S = 10.0


@dataclass(frozen=True)
class Excitation:
    """Attributes:
        joint_names: m names.  times_s: (n,).  position, velocity: (n, m) [m, rad; m/s, rad/s].
        condition: of the regressor, columns scaled to length 1.
    """

    joint_names: Tuple[str, ...]
    times_s: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    condition: float


def design(scenario: Scenario, seconds: float = 20.0, seed: int = 0) -> Excitation:
    """Returns a motion about the scenario's goal posture that begins and ends at rest.

    It knows the limits of the URDF. It knows nothing of the table, the cables and the arm itself: look at it in the
    simulator first.

    Raises: ParameterError: too short.  ModelError: of the URDF.
    """
    if not seconds >= SHORTEST_S:
        raise ParameterError(f"--seconds: found {seconds:g}, allowed >= {SHORTEST_S:g}")
    kinematics = scenario.kinematics(calibrated=False)
    tree, home = TreeDynamics(scenario.urdf_xml()), scenario.goal_posture(kinematics)
    names = tuple(kinematics.joint_names)
    room = np.minimum(POSITION_PART * np.minimum(kinematics.upper - home, home - kinematics.lower), MOST_WAY)
    speeds = SPEED_PART * np.array([_speed_limit(scenario, name) for name in names])
    times = np.arange(0.0, seconds + 0.5 * STEP_S, STEP_S)
    random = np.random.default_rng(seed)

    def motion(series):
        """(positions, velocities, accelerations), (n, m) each, of coefficients (frequencies, 2, m)."""
        phase = 2.0 * np.pi * np.outer(times, HERTZ)
        way = np.einsum("nf,fm->nm", np.sin(phase), series[:, 0]) + np.einsum("nf,fm->nm", np.cos(phase), series[:, 1])
        way *= _ramp(times, seconds)[:, None]
        speed = np.gradient(way, STEP_S, axis=0)
        scale = np.minimum(room / np.abs(way).max(axis=0), speeds / np.abs(speed).max(axis=0))
        return home + way * scale, speed * scale, np.gradient(speed * scale, STEP_S, axis=0)

    def condition(series):
        return _condition(tree, names, motion(series), scenario.robot["tip_link"])

    best = random.normal(size=(len(HERTZ), 2, len(names)))
    least = condition(best)
    for _ in range(TRIALS):
        trial = best + WIDTH * random.normal(size=best.shape)
        found = condition(trial)
        if found < least:
            best, least = trial, found
    q, v, _ = motion(best)
    return Excitation(names, times + APPROACH_S, q, v, float(least))


def trajectory_yaml(motion: Excitation) -> str:
    """Returns the motion as a trajectory_msgs/JointTrajectory, for `rostopic pub -1 -f FILE CONTROLLER/command ...`."""
    def time(t: float) -> Dict[str, int]:
        return {"secs": int(t), "nsecs": int(round((t - int(t)) * 1e9))}
    rows = zip(motion.times_s.tolist(), motion.position.tolist(), motion.velocity.tolist())
    points = [{"positions": [round(x, 6) for x in q], "velocities": [round(x, 6) for x in v],
               "time_from_start": time(t)} for t, q, v in rows]
    return yaml.safe_dump({"joint_names": list(motion.joint_names), "points": points}, default_flow_style=None,
                          sort_keys=False, width=200)


def _speed_limit(scenario, name):
    joints = ElementTree.fromstring(scenario.urdf_xml()).findall("joint")
    joint = next(each for each in joints if each.get("name") == name)
    limit = joint.find("limit")
    return float(limit.get("velocity", 0.0)) or 1.0 if limit is not None else 1.0


def _ramp(times, seconds):
    """0 at both ends with slope 0, 1 between."""
    part = np.clip(np.minimum(times, seconds - times) / RAMP_S, 0.0, 1.0)
    return part**2 * (3.0 - 2.0 * part)


def _condition(tree, names, motion, tip_link):
    """Condition number of the efforts by damping, friction, gravity and a payload at the tip; joints count by the size
    of their efforts."""
    order = [names.index(name) if name in names else None for name in tree.joint_names]
    whole = [np.column_stack([np.zeros(len(each)) if k is None else each[:, k] for k in order]) for each in motion]
    unit = [Inertia(float(i == 0), np.eye(4)[i][1:], np.zeros((3, 3))) for i in range(4)]
    gravity = (0.0, 0.0, -9.81)
    still = (whole[0], 0.0 * whole[0], 0.0 * whole[0])
    load = tree.efforts([{tip_link: each} for each in unit], whole, gravity)
    rest = tree.efforts([tree.inertias], still, gravity)[0]
    total = tree.efforts([tree.inertias], whole, gravity)[0]
    scale = np.sqrt(np.mean(total**2, axis=0)) + 1e-3 * np.sqrt(np.mean(total**2))
    kept = [k for k, each in enumerate(order) if each is not None]
    columns = []
    for k in kept:
        for values in (whole[1][:, k], np.tanh(whole[1][:, k] / 0.02)):
            column = np.zeros_like(total)
            column[:, k] = values
            columns.append(column)
    matrix = np.column_stack([(each / scale)[:, kept].ravel() for each in (*columns, rest, total, *load)])
    return float(np.linalg.cond(matrix / np.maximum(np.linalg.norm(matrix, axis=0), 1e-12)))
