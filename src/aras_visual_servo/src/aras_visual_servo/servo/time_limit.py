"""Gate: ends the servo when its time is up, and says why it has not converged."""

from ..ground.types import Status
from .arrival import Arrival
from .hindrance import Hindrance
from .stage import Stage, Tick


class TimeLimit(Stage):
    """Ends the servo `time_limit_s` after its start."""

    def __init__(self, config, start_ns: int, arrival: Arrival, hindrance: Hindrance):
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
