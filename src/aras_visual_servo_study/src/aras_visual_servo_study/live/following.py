"""Whether a target that has moved is followed: the servo, which has ended, begins again. In process and over ROS."""

import math
from typing import Any, Optional

import numpy as np

from aras_visual_servo import Status

#: Ends of a servo after which a target that moves is followed ...
FOLLOWED = (Status.CONVERGED, Status.SETTLED, Status.TIMED_OUT, Status.STOPPED_BY_RULE, Status.OUT_OF_REACH)
#: ... once it has moved this far since then [m], or turned this far [rad].
MOVED_M, MOVED_RAD = 2e-4, 1e-3


class Following:
    """Compares where the target is with where it was in the image with which the servo ended. After TIMED_OUT it
    compares with where the target was when the servo began, because a user may have dragged it until the time was up
    and held it still from then on."""

    def __init__(self) -> None:
        self._phase = ""
        self._begun: Optional[np.ndarray] = None
        self._known: Any = None

    def answered(self, phase: str, status: Status, X_WT: np.ndarray, follow: bool) -> bool:
        """Returns, after an answered image, whether the servo is to begin again: once for each place of a target.

        Args: X_WT: (4, 4), of the target in this image.  follow: whether a target that has moved is followed now.
        """
        if phase == "servo" and self._phase != "servo":
            self._begun = X_WT
        self._phase = phase
        if phase != "done" or status not in FOLLOWED:
            self._known = None
            return False
        if self._known is None:
            self._known = self._begun if status == Status.TIMED_OUT and self._begun is not None else X_WT
        again = follow and has_moved(self._known, X_WT)
        if again:
            self._known = X_WT
        return again

    def taught(self) -> None:
        """The view of now is the goal: where the target was before does not count any more."""
        self._begun = self._known = None


def has_moved(before: np.ndarray, now: np.ndarray) -> bool:
    """Whether a target that was followed has moved between two poses, (4, 4) each, so far that it is followed again."""
    turn = np.linalg.norm(before[:3, :3] - now[:3, :3]) / math.sqrt(2.0)
    return bool(np.linalg.norm(before[:3, 3] - now[:3, 3]) > MOVED_M or turn > MOVED_RAD)
