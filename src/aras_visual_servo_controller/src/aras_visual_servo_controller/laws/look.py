"""What a law is given for one image, and what it answers. Both are frozen values, and there is no other way between
the servo and a law."""

from typing import NamedTuple, Optional, Tuple

import numpy as np

from ..features.base import View


class Look(NamedTuple):
    """One look at the target.

    Attributes:
        view: `View` of the image. It holds the features and, for a law that `needs_plane`, the target's plane.
        dt_s: time for which the twist will be held [s]; 0 asks for the instantaneous twist.
        X_CgC: (4, 4) pose of the camera in the camera frame at the goal, by the kinematics; None unless the law
            `needs_pose`.
        applied: (6,) V_C that the arm was given after the last look, with all limits applied [m/s; rad/s]; None at the
            first look and after the arm was stopped.
    """

    view: View
    dt_s: float = 0.0
    X_CgC: Optional[np.ndarray] = None
    applied: Optional[np.ndarray] = None


class Answer(NamedTuple):
    """What a law makes of a look.

    Attributes:
        twist: V_C, (6,), [v; w] in the camera frame [m/s; rad/s].
        s, e: tuples of k, the features and their errors.
        condition: condition number of the interaction matrix that gave the twist; NaN if there is none.
        settled: False keeps the servo from ending as converged, however small e is.
        pose: (6,) displacement of the camera from the goal, [p_CgC; theta u], where the law itself knows it; None: the
            servo takes the one that e stands for.
    """

    twist: np.ndarray
    s: Tuple[float, ...]
    e: Tuple[float, ...]
    condition: float
    settled: bool
    pose: Optional[np.ndarray] = None
