"""Remembers what keeps the arm from the motion that the law asks for."""

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
