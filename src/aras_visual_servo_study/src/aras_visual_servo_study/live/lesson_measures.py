"""What lessons measure in a run. All take a `RunRecord` that has servoed, and look at its servo only."""

from typing import Tuple

import numpy as np

from aras_visual_servo import RunRecord, Status

#: An error is fitted while it is between these parts of the first one: later, friction and the threshold bend it.
FITTED = (0.1, 0.8)
#: The last images of a servo, in which the arm only holds [-].
HELD_IMAGES = 200


def column(run: RunRecord, name: str) -> Tuple[np.ndarray, np.ndarray]:
    """Returns (t, e): time since the servo began [s], and the error of a feature in its own unit, (n,) each."""
    rows = run.servo_rows
    return run.t_s[rows] - run.t_s[rows[0]], run.e[rows, run.feature_names.index(name)]


def duration(run: RunRecord) -> float:
    """Returns how long the servo took [s]."""
    return float(np.ptp(run.t_s[run.servo_rows]))


def converged(run: RunRecord) -> bool:
    """Returns whether the servo converged."""
    return int(run.status[run.servo_rows[-1]]) == int(Status.CONVERGED)


def decay_rate(run: RunRecord, name: str) -> float:
    """Returns the rate of e(t) = e(0) exp(-rate t), by least squares on log |e| [1/s]; NaN with too few images."""
    t, e = column(run, name)
    part = np.abs(e / e[0])
    below = np.flatnonzero(part < FITTED[0])
    fitted = np.flatnonzero(part[:below[0] if len(below) else len(part)] < FITTED[1])
    return -float(np.polyfit(t[fitted], np.log(part[fitted]), 1)[0]) if len(fitted) > 2 else float("nan")


def overshoot(run: RunRecord) -> Tuple[float, str]:
    """Returns how far the errors go beyond zero, as a part of the first error, and the feature that goes farthest."""
    e = run.e[run.servo_rows]
    parts = np.nanmax(-e / e[0], axis=0)
    worst = int(np.argmax(parts))
    return max(0.0, float(parts[worst])), run.feature_names[worst]


def positions(run: RunRecord) -> np.ndarray:
    """Returns the true positions of the camera in the world, (n, 3) [m]."""
    return run.X_WC[run.servo_rows, :3, 3]


def detour(run: RunRecord) -> float:
    """Returns the length of the camera's path over the straight distance from its start to the goal [-]."""
    p = positions(run)
    return float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum() / np.linalg.norm(run.taught_pose[:3, 3] - p[0]))


def retreat(run: RunRecord) -> Tuple[float, float]:
    """Returns how far the camera goes away from the target and towards it, along the goal's optical axis [m]."""
    along = (positions(run) - positions(run)[0]) @ run.taught_pose[:3, 2]
    return float(max(0.0, -along.min())), float(max(0.0, along.max()))


def held_noise(run: RunRecord, name: str, averaged: int = 1) -> float:
    """Returns the standard deviation of the means of so many images of a feature, while the arm holds, in its unit."""
    e = column(run, name)[1][-HELD_IMAGES:]
    means = e[:len(e) // averaged * averaged].reshape(-1, averaged).mean(axis=1)
    return float(means.std(ddof=1))


def fastest_joint(run: RunRecord) -> Tuple[float, str]:
    """Returns the highest speed of a joint, from its measured positions [rad/s], and its name."""
    rows = run.servo_rows
    speeds = np.abs(np.diff(run.q[rows], axis=0) / np.diff(run.t_s[rows])[:, None]).max(axis=0)
    worst = int(np.argmax(speeds))
    return float(speeds[worst]), run.joint_names[worst]
