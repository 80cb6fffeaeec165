"""Joint positions at the time of an image, from joint states that have other stamps, and the ages of messages.

Every joint has stamps of its own: an arm and its linear axis often have drivers, and messages, of their own.
"""

import bisect
import collections
from math import isfinite, nan
from typing import Any, List, NamedTuple, Optional, Sequence

import numpy as np


class JointsThen(NamedTuple):
    """Joint positions at a time.

    Attributes:
        q: (n,) positions [m or rad]; None if they are not known.
        gap_s: between the two joint states used, 0 if one has that very stamp [s].
        extrapolation_s: how much later than the newest joint state the time is, 0 if it is not [s].
        refusal: why they are not known, in words; "" if they are.  wait: a later joint state may change that.
    """

    q: Any
    gap_s: float = 0.0
    extrapolation_s: float = 0.0
    refusal: str = ""
    wait: bool = False


class JointHistory:
    """Keeps the joint states of the last seconds, joint by joint.

    Args:
        joint_names: n names.
        max_gap_s: joint states farther apart are not interpolated between.  max_extrapolation_s: see `at`.
        kept_s: how long joint states are kept [s].
    """

    def __init__(self, joint_names: Sequence[str], max_gap_s: float, max_extrapolation_s: float,
                 kept_s: float = 3.0) -> None:
        self._names = tuple(joint_names)
        self._max_gap_s, self._max_extrapolation_s = max_gap_s, max_extrapolation_s
        self._kept_ns = round(kept_s * 1e9)
        self.clear()

    def clear(self) -> None:
        """Forget all."""
        self._tracks = [([], []) for _ in self._names]  # stamps and positions of each joint

    @property
    def newest_ns(self) -> int:
        """Stamp of the joint whose newest state is the oldest, -1 while a joint has none."""
        return min(stamps[-1] if stamps else -1 for stamps, _ in self._tracks)

    @property
    def newest(self) -> Optional[np.ndarray]:
        """(n,) newest positions, None while a joint has none."""
        if not all(stamps for stamps, _ in self._tracks):
            return None
        return np.array([positions[-1] for _, positions in self._tracks])

    def add(self, stamp_ns: int, q: np.ndarray) -> List[str]:
        """Takes a joint state, (n,), with NaN for joints that it does not name.

        Returns the names of the joints that were taken. Left out are positions that are not finite, and those whose
        stamp is not later than the newest of their joint. Jittered stamps may repeat or swap; `Watchdog` notices a
        clock that was set back.
        """
        taken = []
        for name, (stamps, positions), position in zip(self._names, self._tracks, q):
            if not isfinite(position) or stamps and stamp_ns <= stamps[-1]:
                continue
            taken.append(name)
            stamps.append(stamp_ns)
            positions.append(float(position))
            while stamps[-1] - stamps[0] > self._kept_ns:
                del stamps[0], positions[0]
        return taken

    def at(self, time_ns: int) -> JointsThen:
        """`JointsThen`: linear between the two joint states around the time, or on from the last two of them.

        The gap and the extrapolation are the largest of the joints. A refusal names its joints, unless it is for all.
        """
        found = [self._joint_at(stamps, positions, time_ns) for stamps, positions in self._tracks]
        gap_s, beyond_s = (max(getattr(then, name) for then in found) for name in ("gap_s", "extrapolation_s"))
        refused = [then for then in found if then.refusal]
        if not refused:
            return JointsThen(np.array([then.q for then in found]), gap_s, beyond_s)
        # A refusal for good comes before one that a later joint state may lift.
        worst = next((then for then in refused if not then.wait), refused[0])
        names = [name for name, then in zip(self._names, found) if then.refusal == worst.refusal]
        whose = "" if len(names) == len(self._names) else f"{', '.join(names)}: "
        return JointsThen(None, gap_s, beyond_s, whose + worst.refusal, worst.wait)

    def _joint_at(self, stamps, positions, time_ns):
        """`JointsThen` of one joint, whose q is a number."""
        after = bisect.bisect_left(stamps, time_ns)
        if after < len(stamps) and stamps[after] == time_ns:
            return JointsThen(positions[after])
        if after == 0:
            when = "no joint state has come" if not stamps else \
                f"the oldest joint state is {(stamps[0] - time_ns) * 1e-9:.3f} s later than the image"
            return JointsThen(None, refusal=when, wait=not stamps)
        beyond_s = 1e-9 * (time_ns - stamps[-1])
        if beyond_s > self._max_extrapolation_s:
            return JointsThen(None, extrapolation_s=beyond_s, wait=True, refusal=(
                f"the newest joint state is {beyond_s:.3f} s older than the image, allowed "
                f"{self._max_extrapolation_s:g} s"))
        if beyond_s > 0.0:
            after -= 1
            if after == 0:
                return JointsThen(None, refusal="only one joint state has come", wait=True)
        before_ns, after_ns = stamps[after - 1], stamps[after]
        gap_s = 1e-9 * (after_ns - before_ns)
        if gap_s > self._max_gap_s:
            return JointsThen(None, gap_s, max(0.0, beyond_s), (
                f"the joint states around the image are {gap_s:.3f} s apart, allowed {self._max_gap_s:g} s"))
        part = (time_ns - before_ns) / (after_ns - before_ns)
        before, later = positions[after - 1], positions[after]
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
