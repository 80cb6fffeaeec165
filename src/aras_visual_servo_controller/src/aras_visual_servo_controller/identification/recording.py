"""Joint states and commands of one arm, checked before anything is fitted."""

from dataclasses import dataclass
from typing import Iterator, Optional, Tuple

import numpy as np

from aras_visual_servo import MOST_TURN_RAD, ParameterError

#: Joint states farther apart than this belong to two recordings, or the clock jumped. [s]
LONGEST_GAP_S = 0.5
#: Shortest recording that can be fitted. [samples]
FEWEST_SAMPLES = 100
KINDS = ("position", "velocity")


@dataclass(frozen=True)
class Commands:
    """Commands of all joints of a recording. Each holds until the next one.

    Attributes:
        kind: `position` or `velocity`.  times_s: (k,) stamps.  values: (k, m) [m, rad or m/s, rad/s].
    """

    kind: str
    times_s: np.ndarray
    values: np.ndarray


@dataclass(frozen=True)
class Recording:
    """Joint states of one arm with what it was told.

    Attributes:
        joint_names: m names.
        times_s: (n,) stamps of the joint states, increasing.
        position: (n, m) [m or rad].
        velocity: (n, m) [m/s or rad/s], or None.
        effort: (n, m) of the actuators [N or N m], or None.
        commands: `Commands`, or None.
        received_s: (n,) when the recorder got the joint states, on the clock of the stamps, or None.
    Raises: ParameterError: with every fault found.
    """

    joint_names: Tuple[str, ...]
    times_s: np.ndarray
    position: np.ndarray
    velocity: Optional[np.ndarray] = None
    effort: Optional[np.ndarray] = None
    commands: Optional[Commands] = None
    received_s: Optional[np.ndarray] = None

    def __post_init__(self) -> None:
        faults = list(self._faults())
        if faults:
            raise ParameterError(faults)

    @property
    def period_s(self) -> float:
        """Median time between two joint states."""
        return float(np.median(np.diff(self.times_s)))

    def _faults(self) -> Iterator[str]:
        n, m = len(self.times_s), len(self.joint_names)
        if len(set(self.joint_names)) != m or m == 0:
            yield f"joint_names: found {list(self.joint_names)}, allowed one or more different names"
        if n < FEWEST_SAMPLES:
            yield f"times_s: found {n} joint states, allowed at least {FEWEST_SAMPLES}"
        shapes = {"position": (n, m), "velocity": (n, m), "effort": (n, m), "received_s": (n,)}
        values = {name: getattr(self, name) for name in shapes if getattr(self, name) is not None}
        stamps = {"times_s": self.times_s}
        if self.commands is not None:
            if self.commands.kind not in KINDS:
                yield f"commands.kind: found {self.commands.kind}, allowed {', '.join(KINDS)}"
            stamps["commands.times_s"] = self.commands.times_s
            values["commands.values"] = self.commands.values
            shapes["commands.values"] = (len(self.commands.times_s), m)
        for name, value in values.items():
            if np.shape(value) != shapes[name]:
                yield f"{name}: found shape {np.shape(value)}, allowed {shapes[name]}"
            elif not np.all(np.isfinite(value)):
                yield f"{name}: found values that are not finite, allowed finite ones"
        for name, times in stamps.items():
            steps = np.diff(times)
            if len(times) == 0 or not np.all(np.isfinite(times)):
                yield f"{name}: found none, or some that are not finite, allowed finite stamps"
            elif np.any(steps <= 0.0):
                at = int(np.argmax(steps <= 0.0))
                yield f"{name}: found {times[at + 1]:.6f} s after {times[at]:.6f} s, allowed increasing stamps"
            elif name == "times_s" and np.any(steps > LONGEST_GAP_S):
                at = int(np.argmax(steps > LONGEST_GAP_S))
                yield (f"{name}: found a gap of {steps[at]:.3f} s after {times[at]:.6f} s, allowed at most "
                       f"{LONGEST_GAP_S} s: a clock jump, or two recordings")
        if np.shape(self.position) == (n, m):
            for name, column in zip(self.joint_names, np.abs(self.position).T):
                if np.any(column > MOST_TURN_RAD):
                    yield (f"position of {name}: found {column.max():.1f}, allowed at most {MOST_TURN_RAD:.1f} rad: "
                           "it may be in degrees")
