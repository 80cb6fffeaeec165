"""Latency: how old messages are when they come, over the last of them."""

import collections
from math import nan
from typing import NamedTuple

import numpy as np


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
    """Collects the ages of messages. Args: count: number of the last ones that the summary is made of."""

    def __init__(self, count: int = 100):
        self._values = collections.deque(maxlen=count)

    def clear(self) -> None:
        """Forget all."""
        self._values.clear()

    def add(self, age_s: float) -> None:
        """Take the age of one message [s]; negative where its clock is ahead of ours."""
        self._values.append(age_s)

    def summary(self) -> LatencySummary:
        """`LatencySummary`."""
        if not self._values:
            return LatencySummary(nan, nan, nan, nan)
        values = np.array(self._values)
        return LatencySummary(float(values.mean()), float(values.min()), float(values.max()), float(values.std()))
