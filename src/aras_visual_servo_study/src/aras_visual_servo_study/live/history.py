"""What a page can go back to: rows of numbers and pictures of a session, bounded and thinned.

When a bound is reached, the older half is thinned to half as many, in even steps. So the whole session stays. Bounds:
`MOST_ROWS` rows of some 50 numbers take 7 MB, and pictures `MOST_BYTES` of a temporary file.
"""

import bisect
import math
import tempfile
from array import array
from typing import Callable, Dict, List, Optional, Sequence, Tuple, TypeVar

T = TypeVar("T")
#: Rows kept: ten minutes of them at 30 Hz, before the first are thinned.
MOST_ROWS = 18_000
#: Bytes of pictures kept, in a temporary file.
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


def packed(row: Sequence[Optional[float]]) -> "array[float]":
    """Returns a row in four bytes a number, NaN for None: a list of floats takes eight times as much."""
    return array("f", [math.nan if value is None else value for value in row])


def unpacked(row: "array[float]") -> List[Optional[float]]:
    """Returns the numbers of a packed row: whole ones up to 2^24 as they were, others with their six digits."""
    return [None if value != value else value if value.is_integer() else float(f"{value:.6g}") for value in row]


class Pictures:
    """Pictures by growing number, in a temporary file without a name. Attributes: size: their bytes together.

    A picture that cannot be written, because the disk is full, is not kept.
    """

    def __init__(self, most_bytes: int = MOST_BYTES) -> None:
        """Args: most_bytes: bound of `size`."""
        self._most, self.size = most_bytes, 0
        self._numbers: List[int] = []
        self._places: Dict[int, Tuple[int, int]] = {}
        self._file = tempfile.TemporaryFile(buffering=0)

    def keep(self, number: int, picture: bytes) -> None:
        """Keeps a picture whose number is larger than those before."""
        if self._numbers and number <= self._numbers[-1]:
            return
        try:
            self._append(number, picture)
            while self.size > self._most and len(self._numbers) > 3:
                self._thin()
        except OSError:
            return

    def _append(self, number: int, picture: bytes) -> None:
        self._file.seek(self.size)
        if self._file.write(picture) < len(picture):
            return  # overwritten by the next one
        self._numbers.append(number)
        self._places[number] = self.size, len(picture)
        self.size += len(picture)

    def _thin(self) -> None:
        """Moves the pictures that stay to the front of the file, one after another."""
        kept, places, self.size = thinned(self._numbers, float), self._places, 0
        self._numbers, self._places = [], {}
        for number in kept:
            self._append(number, self._read(*places[number]))
        self._file.truncate(self.size)

    def _read(self, place: int, size: int) -> bytes:
        self._file.seek(place)
        return self._file.read(size)

    def at(self, number: int) -> Optional[bytes]:
        """Returns the picture of this number, else the one before it, else the first; None if there are none."""
        if not self._numbers:
            return None
        return self._read(*self._places[self._numbers[max(0, bisect.bisect_right(self._numbers, number) - 1)]])
