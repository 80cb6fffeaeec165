"""Input and output of a law for one image, as immutable values."""

from typing import Any, NamedTuple, Optional, Tuple

import numpy as np

from ..features.base import View
from ..ground.types import Status


class Look(NamedTuple):
    """One look at the target.

    Attributes:
        view: `View` of the image. It holds the features and, for a law that `needs_plane`, the target's plane.
        dt_s: time for which the twist will be held [s]; 0 asks for the instantaneous twist.
        X_CgC: (4, 4) pose of the camera in the camera frame at the goal, by the kinematics; None unless the law
            `needs_pose`.
        applied: (6,) V_C that the arm was given after the last look, with all limits applied [m/s; rad/s]; None at the
            first look and after the arm was stopped.
        tracker: filters the features, and predicts them while the target is not seen; None: no filter. It has
            `seen`, `corrected(s, view)` and `foreseen()` (servo/feature_filter.py).
    """

    view: View
    dt_s: float = 0.0
    X_CgC: Optional[np.ndarray] = None
    applied: Optional[np.ndarray] = None
    tracker: Optional[Any] = None


class Answer(NamedTuple):
    """Result of a law for one look.

    Attributes:
        twist: V_C, (6,), [v; w] in the camera frame [m/s; rad/s].
        s, e: tuples of k, the features and their errors.
        condition: condition number of the interaction matrix that gave the twist; NaN if there is none.
        settled: False keeps the servo from ending as converged, however small e is.
        pose: (6,) displacement of the camera from the goal, [p_CgC; theta u], where the law itself knows it; None: the
            servo takes the one that e stands for.
        gains_per_s: tuple of k, the gains used [1/s]; () if the law does not tell.
    """

    twist: np.ndarray
    s: Tuple[float, ...]
    e: Tuple[float, ...]
    condition: float
    settled: bool
    pose: Optional[np.ndarray] = None
    gains_per_s: Tuple[float, ...] = ()


class Arm(NamedTuple):
    """The arm at one look, for a law that `moves_joints`. Vectors (n,) have the order of `joint_names`.

    Attributes:
        joint_names: tuple.  q: positions [m, rad].  before: velocities that were commanded last.
        X_BC: (4, 4) pose of the camera in the base.  jacobian: J_BC_C, (6, n).
        wanted: velocities for the twist, with the spare motion, before the limits of position and acceleration.
        low, high: velocities that all limits allow for this period.
        at_stop: whether it is the end of the way of a joint that makes `low` (row 0) and `high` (row 1), (2, n) bool.
        short: names of the joints that cannot brake in time at their acceleration; () in normal running.
        lower, upper, velocity, acceleration: the limits themselves; infinite where there is none.
        dt_s: time for which the answer is held [s].
    """

    joint_names: Tuple[str, ...]
    q: np.ndarray
    before: np.ndarray
    X_BC: np.ndarray
    jacobian: np.ndarray
    wanted: np.ndarray
    low: np.ndarray
    high: np.ndarray
    at_stop: np.ndarray
    short: Tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    dt_s: float


class Joints(NamedTuple):
    """The joint velocities of a law that `moves_joints`.

    Attributes:
        q_dot: (n,) [m/s, rad/s].  status: reason why the arm cannot do the twist, else None.
        text: which constraints bind, and by how much one had to be violated; "" if none.
    """

    q_dot: np.ndarray
    status: Optional[Status] = None
    text: str = ""
