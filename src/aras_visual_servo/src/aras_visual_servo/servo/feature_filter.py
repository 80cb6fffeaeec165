"""A Kalman filter on the features, whose model is the interaction matrix: through outages, dropped images and latency.

Between two looks the features change by L times the camera's motion, which the joints tell, and by the motion of the
target, which the filter estimates as a rate of each feature. So

1. a look at the target corrects the prediction, which smooths noise;
2. a look without the target is answered with the prediction, for `outage_s`, and the servo goes on;
3. with a latency, the answer has the features of the time at which it will act: the filter adds the twists commanded
   since the image was taken.

Reference: W. J. Wilson, C. C. Williams Hulls, G. S. Bell, "Relative end-effector control using Cartesian position based
visual servoing", IEEE T-RA 12(5), 1996 (Kalman filter in the loop, through lost features); P. I. Corke, "Visual control
of robots", 1996, chapter 7 (latency).
"""

from collections import deque
from dataclasses import dataclass
from re import fullmatch
from typing import Any, Sequence, Tuple

import numpy as np

from ..config.settings import setting
from ..features.base import FeatureSet, View
from ..spatial import inverse, logarithm, rotation, skew
from ..ground.types import Features
from .feed_forward import POSE_FEATURES, ConstantVelocity

#: Commands that are kept: ten seconds of images at 100 Hz.
COMMANDS = 1000
#: Below this angle the series of the rotation's rate is exact to rounding with its first two terms [rad].
SMALL_RAD = 1e-4


@dataclass(frozen=True)
class FilterSettings:
    """Section `servo.filter`: features are filtered and foreseen."""

    outage_s: float = setting(
        1.0, unit="s", at_least=0,
        help="Longest time on predicted features while the target is not visible.")
    latency_s: float = setting(
        0.0, unit="s", at_least=0,
        help="Time from an image to the effect of its answer; the prediction covers it.")
    noise: float = setting(0.001, above=0, help="Noise of a measured feature (standard deviation), in its unit.")
    acceleration: float = setting(
        1.0, above=0,
        help="Change of a feature's rate by the target's motion (standard deviation), in its unit per s^2. A larger "
             "value follows turns sooner, with more noise.")
    rate: float = setting(
        0.2, above=0,
        help="Initial rate of a feature by the target's motion (standard deviation), in its unit per second.")


class FeatureFilter:
    """The filter of one servo. A law asks it through its look (`Look.tracker`).

    Attributes:
        seen: whether the present look shows the target.
        features: those seen last, with points where they are foreseen.
        rate: (k,) of the features by the target's motion, in their units per second.
        ahead: (k,) by how much the features that were answered are ahead of those of the image.
        motion: (6,) of the camera in that time, [v; w] in its frame [m; rad].
    """

    def __init__(self, config: FilterSettings, features: FeatureSet, symmetric: bool) -> None:
        """Args: symmetric: the target looks the same after half a turn."""
        self._config, self._set, self._symmetric = config, features, symmetric
        names = [fullmatch(r"([xy])([0-9]+)", name) for name in features.names]
        self._points = [("xy".index(name[1]), int(name[2]) - 1) for name in names] if all(names) else None
        self.clear()

    def clear(self) -> None:
        """Forget the past."""
        config = self._config
        self._variances = ConstantVelocity(config.acceleration, config.noise, config.rate)
        self._commands = deque(maxlen=COMMANDS)
        self._s: Any = None
        self._L = self._X_BC = self.features = self._seen_ns = None
        self.rate, self.ahead, self.motion = np.zeros(len(self._set)), np.zeros(len(self._set)), np.zeros(6)
        self.seen = False

    def foresees(self, stamp_ns: int) -> bool:
        """Returns whether a look without the target at that time can be answered."""
        return self._s is not None and stamp_ns - self._seen_ns <= 1e9 * self._config.outage_s

    def unseen_s(self, stamp_ns: int) -> float:
        """Returns the time since the target was seen [s]."""
        return 1e-9 * (stamp_ns - self._seen_ns)

    def commanded(self, stamp_ns: int, twist: np.ndarray) -> None:
        """Remembers the twist, (6,), with which an image was answered."""
        self._commands.append((stamp_ns, twist))

    def at(self, stamp_ns: int, X_BC: np.ndarray, features: Any, plane: np.ndarray) -> "FeatureFilter":
        """Makes this the present look, and returns self, the tracker of the law.

        Args: X_BC: (4, 4) pose of the camera.  features: of the image, None where the target is not seen.
            plane: (A, B, C) of the target there [1/m].
        """
        self._now, self.seen = (stamp_ns, X_BC, plane), features is not None
        if self.seen:
            self.features = features
        elif self._points is not None:
            self.features = self._with_points()
        return self

    def corrected(self, s: Sequence[float], view: View) -> Tuple[float, ...]:
        """Returns the k features of the look, measured as s, filtered and foreseen by the latency."""
        stamp_ns, X_BC, plane = self._now
        s, L = np.array(s), self._matrix(s, View(view.features, plane, None, view.inverse_depths))
        if self._s is None:
            self._s = s
        else:
            dt_s = self.unseen_s(stamp_ns)
            self._advance(stamp_ns, X_BC, 0.5 * (L + self._L))
            place, rate = self._variances.gains(dt_s)
            off = np.array(self._set.error(s, self._s, self._symmetric))
            self._s, self.rate = self._s + place * off, self.rate + rate * off
        self._L, self._X_BC, self._at_ns, self._seen_ns = L, X_BC, stamp_ns, stamp_ns
        return self._ahead(stamp_ns)

    def foreseen(self) -> Tuple[float, ...]:
        """Returns the k features of a look that does not show the target."""
        stamp_ns, X_BC, plane = self._now
        self._advance(stamp_ns, X_BC, self._L)
        self._X_BC, self._at_ns = X_BC, stamp_ns
        if self._points is not None:
            self.features = self._with_points()
        if self._points is not None or self._set.names == POSE_FEATURES:
            self._L = self._matrix(self._s, View(self.features, plane))
        return self._ahead(stamp_ns)

    def _matrix(self, s: np.ndarray, view: View) -> np.ndarray:
        """L, (k, 6), of the features at s in this view."""
        return matrix_of_pose(s) if self._set.names == POSE_FEATURES else self._set.matrix(view)

    def _advance(self, stamp_ns: int, X_BC: np.ndarray, L: np.ndarray) -> None:
        """Move the features along with the camera and the target."""
        self._s = self._s + L @ logarithm(inverse(self._X_BC) @ X_BC) + 1e-9 * (stamp_ns - self._at_ns) * self.rate

    def _ahead(self, stamp_ns: int) -> Tuple[float, ...]:
        """The features after the latency, in which the answers to earlier images act."""
        latency_s = self._config.latency_s
        if latency_s <= 0.0:
            return tuple(self._s.tolist())
        begin, end, motion = stamp_ns - 1e9 * latency_s, stamp_ns, np.zeros(6)
        for at_ns, twist in reversed(self._commands):
            motion += 1e-9 * max(0.0, end - max(at_ns, begin)) * twist
            end = at_ns
            if at_ns <= begin:
                break
        self.motion, self.ahead = motion, self._L @ motion + latency_s * self.rate
        return tuple((self._s + self._L @ motion + latency_s * self.rate).tolist())

    def _with_points(self) -> Features:
        """`Features` as those seen last, with the points where they are foreseen."""
        copy = Features.from_object(self.features)
        places = [list(copy.point_x), list(copy.point_y)]
        for (axis, number), value in zip(self._points, self._s.tolist()):
            places[axis][number] = value
        copy.point_x, copy.point_y = tuple(places[0]), tuple(places[1])
        return copy


def matrix_of_pose(s: Sequence[float]) -> np.ndarray:
    """Returns L, (6, 6), of the camera's displacement s = (p_CgC, theta u), (6,), from the goal, for a target at rest.

    p_dot = R v, and (theta u)_dot = J(theta u) w with the inverse of the right Jacobian of the rotations.
    """
    turn = np.asarray(s[3:], dtype=float)
    W, angle = skew(turn), float(turn @ turn) ** 0.5
    part = 1.0 / 12.0 if angle < SMALL_RAD else (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle**2
    L = np.zeros((6, 6))
    L[:3, :3], L[3:, 3:] = rotation(turn), np.eye(3) + 0.5 * W + part * (W @ W)
    return L
