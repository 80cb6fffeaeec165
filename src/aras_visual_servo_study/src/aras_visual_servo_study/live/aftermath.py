"""What has changed since a servo ended, so that its status is not told of an arm that stands elsewhere by now."""

from typing import Any, Optional, Tuple

import numpy as np

from aras_visual_servo import RobotKinematics, Status
from .following import has_moved

MOVED_ARM, MOVED_TARGET, TAUGHT, THRESHOLDS = (
    "the arm was moved", "the target was moved", "another goal was taught", "the thresholds were changed")
#: A joint that is farther than this from where it came to rest was moved [m, rad].
STRAY = 0.005
#: Time in which the joints come to rest after the end [s].
RESTS_S = 1.0


class Aftermath:
    """Compares each image after the end of a servo with the end.

    Attributes:
        over: whether the servo ended with an image before the last one.
        ends: how many servos have ended.
        change: what has changed since, one of the texts above; "": nothing. It stays until the next servo.
    """

    def __init__(self, kinematics: RobotKinematics) -> None:
        self._kinematics, self._end, self.ends = kinematics, None, 0  # type: RobotKinematics, Any, int
        self._forget()

    def _forget(self) -> None:
        self.over, self.change, self._end_ns = False, "", None  # type: bool, str, Optional[int]
        self._rest: Optional[np.ndarray] = None
        self._X_WT: Optional[np.ndarray] = None
        self._thresholds: Tuple[float, ...] = ()

    def note(self, change: str) -> None:
        """Takes in what a page has asked for: one of the texts above. Before the end of a servo it means nothing."""
        if self._end_ns is not None and not self.change:
            self.change = change

    def take(self, phase: str, end: Any, stamp_ns: int, q: np.ndarray, X_WT: Optional[np.ndarray],
             thresholds: Tuple[float, ...]) -> None:
        """Takes in an answered image.

        Args: end: tells one end from another.  q: (n,) joints.  X_WT: (4, 4), of the target; None: not known.
        """
        if phase != "done":
            self._forget()
            return
        if self._end_ns is None or end != self._end:  # a servo may end with its first image
            self._forget()
            self._end, self.ends = end, self.ends + 1
            self._end_ns, self._X_WT, self._thresholds = stamp_ns, X_WT, thresholds
            return
        self.over = True
        if self._rest is None and stamp_ns - self._end_ns >= 1e9 * RESTS_S:
            self._rest = q
        if self._rest is not None and np.abs(self._kinematics.way(q, self._rest)).max() > STRAY:
            self.note(MOVED_ARM)
        if self._X_WT is not None and X_WT is not None and has_moved(self._X_WT, X_WT):
            self.note(MOVED_TARGET)
        if self._thresholds != thresholds:
            self.note(THRESHOLDS)


def last_servo(status: Status, change: str) -> str:
    """Returns how the last servo ended, by its status, and what has changed since, in words."""
    return f"the last servo: {status.name.lower().replace('_', ' ')}; {change} since"
