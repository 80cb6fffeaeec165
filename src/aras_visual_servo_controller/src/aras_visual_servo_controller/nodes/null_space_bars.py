"""How much of each joint's motion moves the camera, and how much is null-space motion: shares and a picture. No ROS."""

from math import copysign
from typing import Any, Callable, Sequence, Tuple

import cv2
import numpy as np

#: Colours of the picture, RGB.
CAMERA, NULL_SPACE = (31, 105, 190), (232, 119, 20)
_PAPER, _INK, _LINE = (250, 250, 250), (40, 40, 40), (205, 208, 212)
_WIDTH, _TOP, _ROW, _BOTTOM = 440, 90, 40, 6   # [px]
_LEFT, _RIGHT, _BAR = 74, 376, 14              # of the bars: where they begin, end, and their height [px]
_TICKS = (-100, -25, -5, 0, 5, 25, 100)        # [%]


def shares(split: Callable[..., Any], q: np.ndarray, q_dot: np.ndarray, velocity_limits: np.ndarray
           ) -> Tuple[np.ndarray, np.ndarray]:
    """Both parts of the joint velocities as shares of the joints' velocity limits.

    Args:
        split: `Servo.split`.
        q, q_dot: (n,) positions and commanded velocities, as in a record: empty or NaN where there is none.
        velocity_limits: (n,) > 0; where inf, 1 m/s or 1 rad/s takes its place.
    Returns:
        ((n,), (n,)): shares of the part that moves the camera, and of the null-space part [-]. Zeros for an arm that
        stands still or whose positions are not known.
    """
    limits = np.where(np.isfinite(velocity_limits), velocity_limits, 1.0)
    q, q_dot = np.asarray(q, dtype=float), np.asarray(q_dot, dtype=float)
    if not (q.shape == q_dot.shape == limits.shape and np.isfinite(q).all() and np.isfinite(q_dot).all()):
        return np.zeros(len(limits)), np.zeros(len(limits))
    camera, null = split(q, q_dot)
    return camera / limits, null / limits


def draw(names: Sequence[str], camera: np.ndarray, null: np.ndarray) -> np.ndarray:
    """Picture of both shares: two bars per joint from the middle, to the right for positive velocities.

    The length of a bar is the square root of the share, so that the slow motion near the goal is still visible on the
    same scale as the fast one at the start.
    Args: names: of the n joints.  camera, null: (n,) as of `shares`.
    Returns: (h, w, 3) uint8 RGB.
    """
    picture = np.full((_TOP + _ROW * len(names) + _BOTTOM, _WIDTH, 3), _PAPER, np.uint8)
    bottom, middle, half = len(picture) - _BOTTOM, (_LEFT + _RIGHT) // 2, (_RIGHT - _LEFT) // 2

    def text(words, x, y, colour=_INK, size=0.5):
        cv2.putText(picture, words, (x, y), cv2.FONT_HERSHEY_SIMPLEX, size, colour, 1, cv2.LINE_AA)

    def place(share):
        return middle + round(half * copysign(min(1.0, abs(share)) ** 0.5, share))

    text("Joint velocity, % of its limit", 12, 24, size=0.6)
    for x, colour, words in ((14, CAMERA, "moves the camera"), (214, NULL_SPACE, "null space")):
        cv2.rectangle(picture, (x, 38), (x + 14, 52), colour, cv2.FILLED)
        text(words, x + 22, 50, colour)
    for tick in _TICKS:
        x = place(tick / 100.0)
        cv2.line(picture, (x, _TOP - 8), (x, bottom), _LINE if tick else _INK, 1)
        text(str(tick), x - 4 * len(str(tick)), _TOP - 13, size=0.4)
    for row, name in enumerate(names):
        y = _TOP + _ROW * row
        text(name, 12, y + 22)
        for share, colour, top in ((camera[row], CAMERA, y), (null[row], NULL_SPACE, y + _BAR + 2)):
            end = place(share)
            cv2.rectangle(picture, (min(middle, end), top), (max(middle, end), top + _BAR), colour, cv2.FILLED)
            words = f"{100.0 * share:+.1f}"
            text("0.0" if words in ("+0.0", "-0.0") else words, _RIGHT + 12, top + 12, colour)
    return picture
