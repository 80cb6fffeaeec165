"""Joint positions at the time of an image, from joint states that have other stamps, and the ages of messages."""

import bisect
import collections
from math import nan
from typing import NamedTuple, Optional

import numpy as np


class JointsThen(NamedTuple):
    """Joint positions at a time.

    Attributes:
        q: (n,) positions [m or rad]; None if they are not known.
        gap_s: between the two joint states used, 0 if one has that very stamp [s].
        extrapolation_s: how much later than the newest joint state the time is, 0 if it is not [s].
        refusal: why they are not known, in words; "" if they are.  wait: a later joint state may change that.
    """

    q: Optional[np.ndarray]
    gap_s: float = 0.0
    extrapolation_s: float = 0.0
    refusal: str = ""
    wait: bool = False


class JointHistory:
    """Keeps the joint states of the last seconds.

    Args:
        max_gap_s: joint states farther apart are not interpolated between.  max_extrapolation_s: see `at`.
        kept_s: how long joint states are kept [s].
    """

    def __init__(self, max_gap_s: float, max_extrapolation_s: float, kept_s: float = 3.0) -> None:
        self._max_gap_s, self._max_extrapolation_s = max_gap_s, max_extrapolation_s
        self._kept_ns = round(kept_s * 1e9)
        self.clear()

    def clear(self) -> None:
        """Forget all."""
        self._stamps, self._positions = [], []

    @property
    def newest_ns(self) -> int:
        """Stamp of the newest joint state, -1 without any."""
        return self._stamps[-1] if self._stamps else -1

    @property
    def newest(self) -> Optional[np.ndarray]:
        """(n,) of the newest joint state, None without any."""
        return self._positions[-1] if self._positions else None

    def add(self, stamp_ns: int, q: np.ndarray) -> bool:
        """Take a joint state, (n,). One whose stamp is not later than the newest is left out; returns whether it was
        taken. Jittered stamps may repeat or swap; a clock that was set back is for `Watchdog` to see."""
        if stamp_ns <= self.newest_ns:
            return False
        self._stamps.append(stamp_ns)
        self._positions.append(np.array(q, dtype=float))
        while self._stamps[-1] - self._stamps[0] > self._kept_ns:
            del self._stamps[0], self._positions[0]
        return True

    def at(self, time_ns: int) -> JointsThen:
        """`JointsThen`: linear between the two joint states around the time, or on from the last two of them."""
        after = bisect.bisect_left(self._stamps, time_ns)
        if after < len(self._stamps) and self._stamps[after] == time_ns:
            return JointsThen(self._positions[after])
        if after == 0:
            when = "no joint state has come" if not self._stamps else \
                f"the oldest joint state is {(self._stamps[0] - time_ns) * 1e-9:.3f} s later than the image"
            return JointsThen(None, refusal=when, wait=not self._stamps)
        beyond_s = 1e-9 * (time_ns - self._stamps[-1])
        if beyond_s > self._max_extrapolation_s:
            return JointsThen(None, extrapolation_s=beyond_s, wait=True, refusal=(
                f"the newest joint state is {beyond_s:.3f} s older than the image, allowed "
                f"{self._max_extrapolation_s:g} s"))
        if beyond_s > 0.0:
            after -= 1
            if after == 0:
                return JointsThen(None, refusal="only one joint state has come", wait=True)
        before_ns, after_ns = self._stamps[after - 1], self._stamps[after]
        gap_s = 1e-9 * (after_ns - before_ns)
        if gap_s > self._max_gap_s:
            return JointsThen(None, gap_s, max(0.0, beyond_s), (
                f"the joint states around the image are {gap_s:.3f} s apart, allowed {self._max_gap_s:g} s"))
        part = (time_ns - before_ns) / (after_ns - before_ns)
        before, later = self._positions[after - 1], self._positions[after]
        return JointsThen(before + part * (later - before), gap_s, max(0.0, beyond_s))


class LatencySummary(NamedTuple):
    """Of the last values [s]; NaN without any."""

    mean_s: float
    least_s: float
    most_s: float
    stddev_s: float

    def text(self, what: str) -> str:
        """One line for people."""
        return (f"{what} are {1e3 * self.mean_s:.1f} ms old when they come ({1e3 * self.least_s:.1f} to "
                f"{1e3 * self.most_s:.1f} ms, standard deviation {1e3 * self.stddev_s:.1f} ms)")


class Latency:
    """How old messages are when they come. Args: count: number of the last ones that the summary is made of."""

    def __init__(self, count: int = 100) -> None:
        self._values = collections.deque(maxlen=count)

    def add(self, age_s: float) -> None:
        """Take the age of one message [s]; negative where its clock is ahead of ours."""
        self._values.append(age_s)

    def summary(self) -> LatencySummary:
        """`LatencySummary`."""
        if not self._values:
            return LatencySummary(nan, nan, nan, nan)
        values = np.array(self._values)
        return LatencySummary(float(values.mean()), float(values.min()), float(values.max()), float(values.std()))
