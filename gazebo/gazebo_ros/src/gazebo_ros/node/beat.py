"""Times of what happens at a rate."""

#: A time that never comes.
NEVER_NS = 2 ** 62


class Beat:
    """Due at its beginning and then every period of simulated time."""

    def __init__(self, rate_hz, now_ns):
        self._period_ns = max(1, round(1e9 / rate_hz))
        self.next_ns = now_ns

    def due(self, now_ns):
        """Whether it is time. Moves on to the next time after now if so."""
        if now_ns < self.next_ns:
            return False
        self.next_ns += self._period_ns * (1 + (now_ns - self.next_ns) // self._period_ns)
        return True
