"""The feature errors of a run as a picture that is drawn anew while they come, for viewers that show images only.

Each error is drawn in parts of its threshold, on a logarithmic scale: below the line at 1 it counts as small enough.
"""

from collections import deque
from math import floor, isfinite, log10
from typing import Any, Sequence

import cv2
import numpy as np

from aras_visual_servo import styles
from aras_visual_servo.palette import rgb

#: The seconds that the picture shows.
SHOWN_S = 20.0
#: Errors between 10 to the power of these are told apart, in parts of the threshold.
LOWEST, HIGHEST = -2, 4
_WIDTH, _HEIGHT = 560, 300  # [px]
_LEFT, _TOP, _RIGHT, _BOTTOM = 58, 34, 12, 34
_PAPER, _INK, _LINE = (250, 250, 250), (40, 40, 40), (218, 221, 225)


class ErrorPlot:
    """Keeps the errors of the last `SHOWN_S` and draws them.

    Args: names: of the features.  thresholds: (k,) > 0, in the features' units.
    """

    def __init__(self, names: Sequence[str], thresholds: Any):
        self._styles, self._thresholds = styles(names), np.array(thresholds, dtype=float)
        self._colours = [rgb(style.colour) for style in self._styles]
        self._t, self._parts = deque(), deque()

    def add(self, t_s: float, e: Sequence[float]) -> None:
        """The errors e, (k,), of the image of this time; NaN or another length: there are none. Time that goes back
        begins the picture anew."""
        if self._t and t_s <= self._t[-1]:
            self._t.clear()
            self._parts.clear()
        e = np.asarray(e, dtype=float)
        self._t.append(t_s)
        self._parts.append(np.abs(e) / self._thresholds if e.shape == self._thresholds.shape
                           else np.full(len(self._thresholds), np.nan))
        while t_s - self._t[0] > SHOWN_S:
            self._t.popleft()
            self._parts.popleft()

    def draw(self) -> np.ndarray:
        """(h, w, 3) uint8 RGB."""
        picture = np.full((_HEIGHT, _WIDTH, 3), _PAPER, np.uint8)
        end = self._t[-1] if self._t else SHOWN_S
        begin = max(0.0, end - SHOWN_S)
        self._axes(picture, begin)
        for k, (style, colour) in enumerate(zip(self._styles, self._colours)):
            points = [(_x(t, begin), _y(parts[k])) if isfinite(parts[k]) else None
                      for t, parts in zip(self._t, self._parts)]
            for one, next_one in zip(points, points[1:]):
                if one and next_one:
                    cv2.line(picture, one, next_one, colour, 2, cv2.LINE_AA)
            _text(picture, style.name, _LEFT + 8 + 84 * (k % 6), _TOP + 16 + 18 * (k // 6), colour)
        return picture

    def _axes(self, picture, begin):
        _text(picture, "error / threshold", 12, 20, size=0.55)
        bottom, right = _HEIGHT - _BOTTOM, _WIDTH - _RIGHT
        for power in range(LOWEST, HIGHEST + 1):
            y = _y(10.0**power)
            cv2.line(picture, (_LEFT, y), (right, y), _INK if power == 0 else _LINE, 1)
            _text(picture, f"1e{power}" if power else "1", 12, y + 5, size=0.42)
        second = floor(begin / 5.0) * 5.0
        while second <= begin + SHOWN_S:
            if second >= begin:
                x = _x(second, begin)
                cv2.line(picture, (x, _TOP), (x, bottom), _LINE, 1)
                _text(picture, f"{second:g} s", x - 12, bottom + 20, size=0.42)
            second += 5.0
        cv2.rectangle(picture, (_LEFT, _TOP), (right, bottom), _INK, 1)


def _x(t_s, begin):
    return round(_LEFT + (t_s - begin) / SHOWN_S * (_WIDTH - _LEFT - _RIGHT))


def _y(part):
    power = max(LOWEST, min(HIGHEST, log10(part) if part > 0.0 else LOWEST))
    return round(_HEIGHT - _BOTTOM - (power - LOWEST) / (HIGHEST - LOWEST) * (_HEIGHT - _TOP - _BOTTOM))


def _text(picture, words, x, y, colour=_INK, size=0.48):
    cv2.putText(picture, words, (x, y), cv2.FONT_HERSHEY_SIMPLEX, size, colour, 1, cv2.LINE_AA)
