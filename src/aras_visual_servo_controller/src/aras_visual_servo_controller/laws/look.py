"""What a law is given of one image, and what it answers. Both are values: nothing is set or read in between."""

from typing import NamedTuple, Optional, Tuple

import numpy as np

from ..features.base import View


class Look(NamedTuple):
    """One look at the target.

    Attributes:
        view: `View` of the image: its features and, where the law `needs_plane`, the target's plane.
        dt_s: time the twist will be held [s]; 0 asks for the instantaneous twist.
        X_CgC: (4, 4) pose of the camera in that of the goal, by the kinematics, where the law `needs_pose`.
        applied: (6,) twist that was carried out since the last look, after all limits; None: none, or the arm was
            stopped in between.
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
        condition: number of the interaction matrix that the twist rests on, NaN without one.
        settled: the law asks for no motion worth mentioning; if not, the servo is not done, however small e is.
    """

    twist: np.ndarray
    s: Tuple[float, ...]
    e: Tuple[float, ...]
    condition: float
    settled: bool
