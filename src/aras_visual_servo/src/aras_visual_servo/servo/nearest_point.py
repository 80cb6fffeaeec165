"""Brings the camera to the point that is nearest to an unreachable goal, rests there, and ends the servo soon.

`out_of_reach.py` watches the camera for seconds until it is sure that the arm is at its end. This stage asks the
kinematics where the end is:

1. The law stalls: the camera follows less than STALLS of the law's twist for STALL_S; or a joint chatters.
2. The goal is placed by the pose that the errors of the features stand for (T60). If `arm.nearest` finds that the arm
   cannot bring the camera there, the joints are driven to where it comes nearest. A stretched arm does not chatter
   there, because the joint positions are sought and not the inverse of a singular Jacobian.
3. The joints stand still with status OUT_OF_REACH. They go on when the goal moves; the law goes on when the goal is
   within reach. After `rest_s` the servo ends as OUT_OF_REACH.

Features that do not tell the pose are left to `out_of_reach.py`.
"""

from dataclasses import dataclass
from math import degrees, inf
from typing import TYPE_CHECKING, Any, Optional, Tuple

import numpy as np

from ..arm.nearest import Nearest, nearest
from ..config.settings import setting
from ..ground.types import Status
from ..spatial import inverse, rotation, size_of, transform
from .goal import Goal
from .stage import Tick

if TYPE_CHECKING:  # C++: not needed to describe the settings of this file
    from ..arm.motion import ArmMotion, Motion

#: The law stalls when the camera follows less than this part of its twist for this time. Both are averaged over MEAN_S.
STALLS, STALL_S, MEAN_S = 0.5, 0.3, 0.2
#: Slower twists do not count as stalled [m/s], rotations times DISTANCE_M: a distance from which targets are seen [m].
LEAST, DISTANCE_M = 1e-3, 0.3
WEIGHTS = np.array([1.0] * 3 + [DISTANCE_M] * 3)
#: Each component of a twist in words, (negative, positive): the camera's x is right, y down, z forwards.
MOTIONS = (("to the left", "to the right"), ("up", "down"), ("backwards", "forwards"),
           ("by a turn down", "by a turn up"), ("by a turn to the left", "by a turn to the right"),
           ("by a roll anticlockwise", "by a roll clockwise"))
#: Components of the direction below this part of the largest one are not named.
NAMED = 0.25
#: Rate at which the joints go to the nearest point [1/s]: that of the law within these bounds.
RATES = 1.0, 4.0
#: Rate at which the measured joint positions correct those that the commands lead to [1/s]. It is slow: a stretched arm
#: swings, and joints that are driven by what is measured alone would make it swing more.
CORRECTION_PER_S = 1.5
#: The camera rests when it has no further to go than this [m, rad], or after LATEST_S on its way.
NEAR_M, NEAR_RAD, LATEST_S = 5e-4, 2e-3, 2.5
#: The features tell the place of a goal to this part of the camera's distance from it, and its attitude to so much for
#: each metre of the distance [rad/m]. The goal has moved when it differs by more, and by MOVED times what the stop rule
#: allows.
TOLD_PART, TOLD_RAD_PER_M, MOVED = 0.15, 0.5, 2.0
#: The goal counts as moved, or as within reach, when it has been for this many images.
WITHIN = 3
#: A law that stalls because the arm is hindered is helped to a goal that is nearer than this [m], and farther than FAR
#: times what the stop rule allows: nearer than that, dry friction holds the joints, which the law overcomes by itself.
#: The help ends within ARRIVES times what the stop rule allows, or after HELP_S. A scenario with another
#: `servo.inverse.method` than HELPED shows what that method does, and gets no help.
HELP_M, FAR, ARRIVES, HELP_S, HELPED = 0.15, 3.0, 0.1, 2.0, "damped"
#: Without an image of the target for this long, the past is forgotten [s].
FORGET_S = 1.0
#: Steps of the search in one image; the next image goes on from there.
STEPS = 25
#: A joint nearer than this to the end of its way is named [m, rad].
AT_LIMIT = 1e-4


@dataclass(frozen=True)
class OutOfReachSettings:
    """Section `servo.out_of_reach`: behaviour of the arm when the camera cannot follow the target."""

    rest_s: float = setting(
        2.0, unit="s", at_least=0,
        help="Rest at the nearest point before the servo ends as `OUT_OF_REACH`; with `track` it continues.")


class NearestPoint:
    """Attributes: active: whether the joints are driven to the nearest point, or rest there.  over: the servo ends.
    hindered: whether the arm could not do the law's twist in full at the last image."""

    def __init__(self, settings: OutOfReachSettings, goal: Goal, arm: "ArmMotion", config: Any) -> None:
        """Args: config: `ServoSettings`."""
        from .._kinematics import between  # C++: not needed to describe the settings of the servo
        self._between, self._goal, self._arm, self._stop = between, goal, arm, config.stop
        self._may_help = config.inverse.method == HELPED
        self._rest_s = inf if config.track else settings.rest_s
        self._rows = None if goal.pose is None else goal.pose.told_rows(config.holds_tilt(goal.features.sees_tilt))
        self.clear()

    def clear(self) -> None:
        """Clears the history: another stage stopped the arm, or the arm follows the law."""
        self.active = self.over = self.hindered = self._helps = False
        self._X_BC: Optional[np.ndarray] = None
        self._asked, self._done, self._stamp_ns = np.zeros(6), np.zeros(6), 0
        self._stalled_ns: Optional[int] = None
        self._within = self._elsewhere = self._since_ns = 0
        self._q: Optional[np.ndarray] = None  # where the search was at the last image
        self._q_led: Optional[np.ndarray] = None  # where the commands lead
        self._X_BCg: Optional[np.ndarray] = None  # of the goal that the joints go to
        self._rest_ns: Optional[int] = None  # since when the arm rests
        self._text = ""

    def motion(self, tick: Tick) -> Optional["Motion"]:
        """Returns the `Motion` of this image while the goal is out of reach; None: the law goes on."""
        if tick.features is None or tick.pose is None or not self._arm.has_ends:
            return None
        if tick.stamp_ns - self._stamp_ns > 1e9 * FORGET_S:
            self.clear()
        was_lost = tick.stamp_ns - self._stamp_ns > 1.5e9 * tick.dt_s
        stalls = self._stalls(tick)
        if not (stalls or self._arm.chatters or self.active or self._helps):
            return None
        self._place(tick)
        if self._rest_ns is not None:
            return self._resting(tick)
        found = nearest(self._goal.kinematics, self._X_BCg, tick.q if self._q is None else self._q, self._arm.lower,
                        self._arm.upper, self._rows, STEPS)
        if not self.active and found.within(*self._tells(tick, 1.0)):
            begins = stalls and self.hindered and self._may_help
            return self._help(tick, found.q) if begins or self._helps else None
        if found.within(self._stop.position_m, self._stop.rotation_rad):
            self._within += 1
            if self._within >= WITHIN:
                self.clear()
                return None
        else:
            self._within, self._text = 0, self._words(tick, found)
        if not self.active:
            self.active, self._since_ns = True, tick.stamp_ns
        self._q = found.q
        return self._go(tick, found, was_lost)

    def _place(self, tick: Tick) -> None:
        """Places the goal anew when it has moved. What changes with the place of the camera alone is no motion."""
        X_BCg = tick.X_BC @ inverse(transform(rotation(tick.pose[3:]), tick.pose[:3]))
        if self.active and self._X_BCg is not None:
            moved_m, moved_rad = size_of(inverse(self._X_BCg) @ X_BCg)
            most_m, most_rad = self._tells(tick, MOVED)
            self._elsewhere = self._elsewhere + 1 if moved_m > most_m or moved_rad > most_rad else 0
            if self._elsewhere < WITHIN:
                return
        self._X_BCg, self._elsewhere, self._rest_ns = X_BCg, 0, None
        if self.active:
            self._since_ns = tick.stamp_ns

    def _tells(self, tick: Tick, times: float) -> Tuple[float, float]:
        """Returns the uncertainty of the goal's place [m, rad]. Args: times: least, in stop-rule limits."""
        distance_m = float(np.linalg.norm(tick.pose[:3]))
        return max(times * self._stop.position_m, TOLD_PART * distance_m), \
            max(times * self._stop.rotation_rad, TOLD_RAD_PER_M * distance_m)

    def _help(self, tick: Tick, q: np.ndarray) -> Optional["Motion"]:
        """Goes the rest of the way to a goal within reach, next to a singularity, by joint positions, (n,)."""
        left_m, left_rad = float(np.linalg.norm(tick.pose[:3])), float(np.linalg.norm(tick.pose[3:]))
        arrived = left_m < ARRIVES * self._stop.position_m and left_rad < ARRIVES * self._stop.rotation_rad
        if not self._helps:
            self._since_ns = tick.stamp_ns
        near = not self._helps and left_m < FAR * self._stop.position_m
        if arrived or near or left_m > HELP_M or tick.stamp_ns - self._since_ns > 1e9 * HELP_S:
            self.clear()
            return None
        self._helps, self._q = True, q
        text = "next to a singularity, the joints go to where the goal is"
        return self._driven(tick, tick.q, q, Status.NEAR_SINGULARITY, text)

    def _driven(self, tick: Tick, at: np.ndarray, q: np.ndarray, status: Status, text: str) -> "Motion":
        """The `Motion` of joints on their way from positions to positions, (n,) each."""
        rate = min(max(min(tick.answer.gains_per_s, default=RATES[1]), RATES[0]), RATES[1])
        way = self._goal.kinematics.way(at, q)
        return self._arm.driven(tick.q, rate * way, tick.jacobian, tick.dt_s, status, text)

    def _stalls(self, tick: Tick) -> bool:
        """Returns whether the camera has not followed the law for long enough to look for a reason."""
        before, self._X_BC, dt_s = self._X_BC, tick.X_BC, 1e-9 * (tick.stamp_ns - self._stamp_ns)
        self._stamp_ns = tick.stamp_ns
        if before is None:
            self._stalled_ns = None
        else:
            part = min(1.0, dt_s / MEAN_S)
            self._done = self._done + part * (WEIGHTS * self._between(before, tick.X_BC) / dt_s - self._done)
            self._asked = self._asked + part * (WEIGHTS * self._arm.within_limits(tick.twist) - self._asked)
            size2 = float(self._asked @ self._asked)
            if size2 < LEAST * LEAST or float(self._done @ self._asked) > STALLS * size2:
                self._stalled_ns = None
            elif self._stalled_ns is None:
                self._stalled_ns = tick.stamp_ns
        return self._stalled_ns is not None and tick.stamp_ns - self._stalled_ns >= 1e9 * STALL_S

    def _go(self, tick: Tick, found: Nearest, stays: bool) -> "Motion":
        """Goes to the nearest point, and rests there. Args: stays: rests here, since the target was lost on the way."""
        way = self._goal.kinematics.way(tick.q, found.q)
        left = tick.jacobian @ way
        late = stays or tick.stamp_ns - self._since_ns > 1e9 * LATEST_S
        near = np.linalg.norm(left[:3]) < NEAR_M and np.linalg.norm(left[3:]) < NEAR_RAD
        if not self._within and (late or near):
            self._rest_ns, self._q_led = tick.stamp_ns, None
            return self._resting(tick)
        kinematics, led = self._goal.kinematics, self._q_led
        at = tick.q if led is None else kinematics.moved(led, kinematics.way(led, tick.q), CORRECTION_PER_S * tick.dt_s)
        motion = self._driven(tick, at, found.q, Status.OUT_OF_REACH, f"going to the nearest point, {self._text}")
        self._q_led = kinematics.moved(at, motion.q_dot, tick.dt_s)
        return motion

    def _resting(self, tick: Tick) -> "Motion":
        self.over = tick.stamp_ns - self._rest_ns >= 1e9 * self._rest_s
        return self._arm.told(np.zeros_like(tick.q), tick.jacobian, Status.OUT_OF_REACH, self._text)

    def _words(self, tick: Tick, found: Nearest) -> str:
        missing_m, missing_rad = found.sizes
        size = [f"{1e3 * missing_m:.3g} mm"] if missing_m > self._stop.position_m else []
        size += [f"{degrees(missing_rad):.2g} deg"] if missing_rad > self._stop.rotation_rad else []
        at_end = (found.q < self._arm.lower + AT_LIMIT) | (found.q > self._arm.upper - AT_LIMIT)
        names = self._goal.kinematics.joint_names
        ends = [f", joint '{name}' at its limit" for name, end in zip(names, at_end) if end]
        asked = self._arm.within_limits(tick.twist)
        return f"out of reach by {' and '.join(size)}{''.join(ends)}; {would_go_on(asked)}"


def direction(twist: np.ndarray) -> str:
    """Returns the components of a twist, (6,), that count most, as seen in the camera's image, largest first."""
    sizes = [abs(value) * weight for value, weight in zip(twist.tolist(), WEIGHTS.tolist())]
    order = sorted(range(6), key=lambda i: -sizes[i])
    return " and ".join(MOTIONS[i][int(twist[i] > 0.0)] for i in order if sizes[i] >= NAMED * max(sizes))


def would_go_on(twist: np.ndarray) -> str:
    """Returns in words how the camera would go on if the arm could: by a twist, (6,)."""
    return f"the camera would have to go on {direction(twist)}, as seen in its image"
