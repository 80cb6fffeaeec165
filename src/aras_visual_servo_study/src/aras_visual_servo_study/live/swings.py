"""Whether the camera swings: it goes to and fro again and again, because gains or latency are too high."""

from collections import deque
from typing import Deque, List, Optional

import numpy as np

from aras_visual_servo import ServoRecord
from .following import has_moved

#: A velocity counts from this size on: of translations [m/s] and rotations [rad/s].
LEAST = np.repeat([0.05, 0.1], 3)
#: So many reversals of one component within WINDOW_S are a swing [s] ...
REVERSALS, WINDOW_S = 4, 4.0
#: ... if they are this far apart; joints that chatter reverse from image to image [s].
APART_S = 0.09
#: A swing is named for so long after its last reversal, in a servo that goes on [s].
NAMED_S = 10.0


class Swings:
    """Counts the reversals of the camera's velocity in a servo. What was found stays after its end."""

    def __init__(self) -> None:
        self._clear()

    def _clear(self) -> None:
        self._servoing, self._now_ns = False, 0
        self._found_ns: Optional[int] = None
        self._X_WT: Optional[np.ndarray] = None
        self._signs, self._turned_ns = np.zeros(6), np.zeros(6, dtype=np.int64)
        self._reversals: List[Deque[int]] = [deque(maxlen=REVERSALS) for _ in range(6)]

    @property
    def found(self) -> bool:
        """Whether the camera swings, or swung when the servo ended."""
        return self._found_ns is not None and self._now_ns - self._found_ns < 1e9 * NAMED_S

    def take(self, record: ServoRecord, X_WT: Optional[np.ndarray]) -> None:
        """Takes in the answer to an image. Args: X_WT: (4, 4), of the target: a camera that follows one does not swing.
        """
        if record.phase != "servo":
            if record.phase != "done":
                self._clear()
            self._servoing = False
            return
        if not self._servoing:
            self._clear()
        moved = self._X_WT is not None and X_WT is not None and has_moved(self._X_WT, X_WT)
        self._servoing, self._now_ns, self._X_WT = True, record.stamp_ns, X_WT
        if moved:
            for reversals in self._reversals:
                reversals.clear()
        for i in np.flatnonzero(np.abs(record.twist) > LEAST):
            self._reverse(i, float(np.sign(record.twist[i])), record.stamp_ns)

    def _reverse(self, i: int, sign: float, stamp_ns: int) -> None:
        if sign == self._signs[i]:
            return
        apart_ns, self._signs[i] = stamp_ns - self._turned_ns[i], sign
        self._turned_ns[i] = stamp_ns
        reversals = self._reversals[i]
        if apart_ns < 1e9 * APART_S:
            reversals.clear()
            return
        reversals.append(stamp_ns)
        if len(reversals) == REVERSALS and stamp_ns - reversals[0] <= 1e9 * WINDOW_S:
            self._found_ns = stamp_ns
