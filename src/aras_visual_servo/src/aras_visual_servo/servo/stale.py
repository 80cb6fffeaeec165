"""Gate: stops the arm on joint positions that are no numbers, and on images that are missing, old or late."""

from math import inf, isfinite, nan
from typing import Optional

import numpy as np

from ..ground.types import Status
from .feature_filter import FeatureFilter
from .stage import Stage, Tick


class Stale(Stage):
    """Watches stamps and joint positions."""

    def __init__(self, joints: int, input_timeout_s: float, tracker: Optional[FeatureFilter]) -> None:
        """Args: joints: number n of them.  input_timeout_s: longest gap between images [s].  tracker: foresees."""
        self._shape, self._timeout_s, self._tracker = (joints,), input_timeout_s, tracker
        self._last_ns: Optional[int] = None

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick, at rest where its image cannot be used."""
        q = tick.q
        if q.shape != self._shape or not isfinite(sum(q.tolist())):
            tick = tick.set(q=np.full(self._shape, nan))
            return tick.rest(Status.FAULT, f"joint positions {q} are not {self._shape[0]} finite numbers")
        gap_s = nan if self._last_ns is None else 1e-9 * (tick.stamp_ns - self._last_ns)
        if gap_s <= 0.0 or not 0.0 < tick.dt_s < inf:
            return tick.rest(Status.STALE_INPUT, f"stamp advanced by {gap_s} s, period {tick.dt_s} s")
        self._last_ns = tick.stamp_ns
        if tick.features is None and (gap_s > self._timeout_s or not foreseen(self._tracker, tick)):
            return tick.rest(Status.STALE_INPUT, "no image")
        if gap_s > self._timeout_s:
            return tick.rest(Status.STALE_INPUT, f"no image for {gap_s:.3f} s")
        return tick


def foreseen(tracker: Optional[FeatureFilter], tick: Tick) -> bool:
    """Returns whether the servo can go on at this tick without seeing the target."""
    return tracker is not None and tracker.foresees(tick.stamp_ns)
