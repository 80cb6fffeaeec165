"""What a page can go back to: rows of numbers and pictures of a session, bounded and thinned.

When a bound is reached, the older half is thinned to half as many, in even steps. So the whole session stays. Bounds:
`MOST_ROWS` rows of some 50 numbers take 40 MB, and pictures `MOST_BYTES`.
"""

import bisect
from typing import Callable, Dict, List, Optional, TypeVar

T = TypeVar("T")
#: Rows kept: ten minutes of them at 30 Hz, before the first are thinned.
MOST_ROWS = 18_000
#: Bytes of pictures kept.
MOST_BYTES = 40_000_000


def thinned(entries: List[T], place: Callable[[T], float]) -> List[T]:
    """Returns a new list: of the older half every second entry at most, spread evenly, and the newer half as it is.

    Args: place: of an entry in the session; it grows from entry to entry.
    """
    half = len(entries) // 2
    step, kept = 2.0 * (place(entries[half]) - place(entries[0])) / half, []
    for entry in entries[:half]:
        if not kept or place(entry) - place(kept[-1]) >= step:
            kept.append(entry)
    return kept + entries[half:]


class Pictures:
    """Pictures by growing number. Attributes: size: their bytes together."""

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        """Args: most_bytes: bound of `size`."""
        self._most, self._numbers, self._pictures, self.size = most_bytes, [], {}, 0  # type: int, List[int], Dict, int

    def keep(self, number: int, picture: bytes) -> None:
        """Keeps a picture whose number is larger than those before."""
        if self._numbers and number <= self._numbers[-1]:
            return
        self._numbers.append(number)
        self._pictures[number] = picture
        self.size += len(picture)
        while self.size > self._most and len(self._numbers) > 3:
            self._numbers = thinned(self._numbers, float)
            self._pictures = {one: self._pictures[one] for one in self._numbers}
            self.size = sum(map(len, self._pictures.values()))

    def at(self, number: int) -> Optional[bytes]:
        """Returns the picture of this number, else the one before it, else the first; None if there are none."""
        if not self._numbers:
            return None
        return self._pictures[self._numbers[max(0, bisect.bisect_right(self._numbers, number) - 1)]]
