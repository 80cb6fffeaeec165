"""Gate: ends the servo when its time is up, and says why it has not converged and what held the arm back."""

from typing import Any

from ..ground.types import Status
from .arrival import Arrival
from .stage import Stage, Tick

#: Without a hindrance for this long the arm counts as free again [s].
FREE_S = 0.5


class Hindrance:
    """Remembers since when, and by what, the arm is kept from the motion that the law asks for."""

    def __init__(self) -> None:
        self._text, self._since_ns, self._last_ns = "", 0, 0

    def seen(self, stamp_ns: int, text: str) -> None:
        """At this image the arm could not do the motion in full, for the reason of this text."""
        if not self._text or stamp_ns - self._last_ns > 1e9 * FREE_S:
            self._since_ns = stamp_ns
        self._text, self._last_ns = text, stamp_ns

    def words(self, stamp_ns: int) -> str:
        """For how long the arm has been held back until now, and by what; an empty text if it is not."""
        if not self._text or stamp_ns - self._last_ns > 1e9 * FREE_S:
            return ""
        return f"for the last {1e-9 * (stamp_ns - self._since_ns):.1f} s the arm could not do what was asked " \
               f"({self._text})"


class TimeLimit(Stage):
    """Ends the servo `time_limit_s` after its start."""

    def __init__(self, config: Any, start_ns: int, arrival: Arrival, hindrance: Hindrance) -> None:
        """Args: config: `ServoSettings`.  arrival, hindrance: know what has been in the way."""
        self._limit_s, self._track, self._start_ns = config.time_limit_s, config.track, start_ns
        self._arrival, self._hindrance = arrival, hindrance

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick, at rest when the time is up."""
        if tick.stamp_ns - self._start_ns < 1e9 * self._limit_s:
            return tick
        arrival = self._arrival
        if self._track and arrival.below:
            return tick.rest(Status.CONVERGED, "followed to the end, every error below its threshold")
        reasons = [arrival.rule.why_not(), self._hindrance.words(tick.stamp_ns), arrival.displaced]
        return tick.rest(Status.TIMED_OUT,
                         f"not converged after {self._limit_s} s: {'; '.join(filter(None, reasons))}")
