"""Gates: stop the arm on data that cannot be used, and end the servo when its time is up."""

from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Any, Optional

import numpy as np

from ..ground.types import FINAL, Status
from .arrival import Arrival
from .feature_filter import FeatureFilter
from .stage import Stage, Tick

#: Without a hindrance for this long the arm counts as free again [s].
FREE_S = 0.5
#: Joints that are commanded no faster than this stand still [m/s, rad/s].
STILL = 1e-6
#: Text of an image at which a move is over and its joints come to rest.
SETTLING = "settling"


class Hindrance:
    """Tracks since when, and for which reason, the arm cannot follow the law."""

    def __init__(self) -> None:
        self._text, self._since_ns, self._last_ns = "", 0, 0

    def note(self, tick: Tick) -> Tick:
        """Notes the hindrance at an answered image. Returns the tick, with the reason if the arm stands still."""
        if tick.status in FINAL:
            return tick
        if not tick.held and _stands(tick):
            tick.held = _why_still(tick)
        if tick.held and tick.status == Status.SERVOING and _stands(tick) and tick.text.startswith("servoing"):
            tick.text = f"standing still, {tick.held}"
        if tick.held:
            self.seen(tick.stamp_ns, tick.held)
        return tick

    def _is_over(self, stamp_ns):
        return not self._text or stamp_ns - self._last_ns > 1e9 * FREE_S

    def seen(self, stamp_ns: int, text: str) -> None:
        """Notes that the arm could not do the motion in full at this image, for the reason `text`."""
        if self._is_over(stamp_ns):
            self._since_ns = stamp_ns
        self._text, self._last_ns = text, stamp_ns

    def words(self, stamp_ns: int) -> str:
        """Returns for how long the arm has been hindered, with the reason; "" if it is not."""
        if self._is_over(stamp_ns):
            return ""
        return f"for the last {1e-9 * (stamp_ns - self._since_ns):.1f} s the arm could not follow the law " \
               f"({self._text})"


def _stands(tick):
    return not any(speed > STILL or speed < -STILL for speed in tick.q_dot.tolist())


def _why_still(tick):
    """Returns why the joints stand still although no stage reports a hindrance; "" if that is expected."""
    if tick.text == SETTLING:
        return ""
    if tick.rests or tick.status != Status.SERVOING or not tick.text.startswith("servoing"):
        return tick.text
    if not tick.answer.twist.any():
        return "the law asks for no motion"
    return "the stages remove all of the law's motion" if not tick.twist.any() else "the joints get no velocity for it"


@dataclass(eq=False)
class TimeLimit(Stage):
    """Ends the servo `time_limit_s` after its start. The text names the lacking features and the hindrance."""

    config: Any  # ServoSettings
    start_ns: int
    arrival: Arrival
    hindrance: Hindrance

    def apply(self, tick: Tick) -> Tick:
        config, arrival = self.config, self.arrival
        if tick.stamp_ns - self.start_ns < 1e9 * config.time_limit_s:
            return tick
        if config.track and arrival.below:
            return tick.rest(Status.CONVERGED, "followed to the end, every error below its threshold")
        reasons = [arrival.rule.why_not(), self.hindrance.words(tick.stamp_ns), arrival.displaced]
        return tick.rest(Status.TIMED_OUT,
                         f"not converged after {config.time_limit_s} s: {'; '.join(filter(None, reasons))}")


@dataclass(eq=False)
class Stale(Stage):
    """Stops the arm on joint positions that are no numbers, and on images that are missing, old or late."""

    joints: int
    timeout_s: float
    tracker: Optional[FeatureFilter]
    last_ns: Optional[int] = None

    def apply(self, tick: Tick) -> Tick:
        q = tick.q
        if q.shape != (self.joints,) or not isfinite(sum(q.tolist())):
            tick.q = np.full(self.joints, nan)
            return tick.rest(Status.FAULT, f"joint positions {q} are not {self.joints} finite numbers")
        gap_s = nan if self.last_ns is None else 1e-9 * (tick.stamp_ns - self.last_ns)
        if gap_s <= 0.0 or not 0.0 < tick.dt_s < inf:
            return tick.rest(Status.STALE_INPUT, f"stamp advanced by {gap_s} s, period {tick.dt_s} s")
        self.last_ns = tick.stamp_ns
        foreseen = self.tracker is not None and self.tracker.foresees(tick.stamp_ns)
        if tick.features is None and (gap_s > self.timeout_s or not foreseen):
            return tick.rest(Status.STALE_INPUT, "no image")
        if gap_s > self.timeout_s:
            return tick.rest(Status.STALE_INPUT, f"no image for {gap_s:.3f} s")
        return tick
