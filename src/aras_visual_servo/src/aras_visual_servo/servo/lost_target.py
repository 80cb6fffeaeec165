"""Behaviour of the arm while the target is not seen: hold still, go back along its path, or search.

The arm moves only in answer to an image that came in time. Without an image it holds still, whatever is configured
here.
"""

from collections import deque
from dataclasses import dataclass
from math import atan2, ceil, cos, pi, sin
from typing import TYPE_CHECKING, Any, List, Optional, Tuple

import numpy as np

from ..config.settings import setting
from ..features.sources.base import Source
from ..ground.types import Status
from ..spatial import exponential, inverse, rotation_vector
from .feature_filter import FeatureFilter
from .stage import Stage, Tick

if TYPE_CHECKING:  # C++: not needed to describe the settings of this file
    from ..arm.kinematics import RobotKinematics
    from ..arm.motion import ArmMotion

ACTIONS = ("hold", "back_off", "search")
#: Images whose joint positions are kept for the way back: ten minutes at 30 Hz.
PATH_LENGTH = 18000
#: Directions of one ring of the search.
DIRECTIONS = 8
#: A place of the search counts as reached at a distance of NEAR_PART of a step. The search goes on to the next place
#: after PATIENT times the time that the way takes at full speed, plus WHILE_S: an arm may be slow, or may not get there
#: at all.
NEAR_PART, PATIENT, WHILE_S = 0.1, 2.0, 0.3
#: Near a place of the search the arm slows down, so that the rest of the way takes at least this many periods: joints
#: follow their commands with a delay.
EASE_PERIODS = 5.0


@dataclass(frozen=True)
class LostTargetSettings:
    """Section `servo.lost_target`: how the arm backs off or searches, where `on_lost` says so."""

    patience_s: float = setting(
        0.1, unit="s", at_least=0, help="Time for which the arm first holds still.")
    speed: float = setting(0.5, unit="m/s, rad/s", above=0, help="Speed of the fastest joint.")
    confirm_s: float = setting(
        0.2, unit="s", at_least=0, help="Time for which the target must be visible before the law resumes.")
    slow_down: float = setting(
        0.5, above=0, at_most=1,
        help="Factor on the twist of the law after each recovery, against repeated overshoot.")
    attempts: int = setting(5, at_least=1, help="Recoveries per run; the next loss ends the servo as `STOPPED`.")
    time_limit_s: float = setting(
        10.0, unit="s", above=0,
        help="A longer loss ends the servo as `STOPPED`.")
    pattern: str = setting(
        "translate", choices=("translate", "tilt"),
        help="Search motion: along the camera's own x and y, or turns about them.")
    step_m: float = setting(
        0.04, unit="m", above=0,
        help="Distance between the rings of the search with `pattern: translate`. Each ring has eight places, the "
             "first towards the last view of the target.")
    step_rad: float = setting(0.08, unit="rad", above=0, help="Likewise with `pattern: tilt`.")
    rings: int = setting(3, at_least=1, help="Number of rings of a search.")
    speed_m_s: float = setting(0.1, unit="m/s", above=0, help="Speed of the camera in a search.")
    turn_rad_s: float = setting(0.3, unit="rad/s", above=0, help="Turn of the camera in a search.")


def search_places(config: LostTargetSettings, first_angle: float) -> List[np.ndarray]:
    """Returns camera displacements from where it saw the target last, (6,) each: [translation m; rotation vector rad].

    Rings of `DIRECTIONS` places, beginning in the direction in which the target was seen last.
    Args: first_angle: of that direction in the image [rad].
    """
    places = []
    for ring in range(1, config.rings + 1):
        for k in range(DIRECTIONS):
            c, s = cos(first_angle + 2.0 * pi * k / DIRECTIONS), sin(first_angle + 2.0 * pi * k / DIRECTIONS)
            if config.pattern == "translate":
                places.append(ring * config.step_m * np.array([c, s, 0.0, 0.0, 0.0, 0.0]))
            else:  # turned about (-s, c, 0) the optical axis moves towards (c, s)
                places.append(ring * config.step_rad * np.array([0.0, 0.0, 0.0, -s, c, 0.0]))
    return places


class LostTarget(Stage):
    """Gate: follows the servo, and takes over while the target is lost.

    Attributes:
        recoveries: how often the arm moved until the target was found again, since `clear`.
    """

    def __init__(self, kinematics: "RobotKinematics", arm: "ArmMotion", action: str, config: LostTargetSettings,
                 source: Optional[Source] = None, tracker: Optional[FeatureFilter] = None) -> None:
        """Args: action: one of ACTIONS.  source: of the features.  tracker: foresees the features, or None."""
        self._source, self._tracker = source, tracker
        self._kinematics, self._arm, self._action, self._config = kinematics, arm, action, config
        self._speed = np.minimum(kinematics.velocity, config.speed)
        self._path, self.recoveries = deque(maxlen=PATH_LENGTH), 0
        self._direction = 0.0
        self._found()

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick: without features where these are foreseen, at rest where the target is lost."""
        if tick.features is None:
            return tick
        text = self._source.why_lost(tick.features)
        if not text:
            return tick if self.found(tick.stamp_ns) else self.recover(tick, "", visible=True)
        if self._tracker is not None and self._tracker.foresees(tick.stamp_ns):
            return tick.set(features=None)
        return self.recover(tick, text)

    def _found(self) -> None:
        self._lost_ns = self._seen_ns = self._here = self._places = None
        self._moved = False

    @property
    def factor(self) -> float:
        """Factor on the twist of the law: it becomes smaller with each recovery."""
        return self._config.slow_down**self.recoveries

    def found(self, stamp_ns: int) -> bool:
        """Returns whether the servo may go on with this image, in which the target is seen."""
        if not self._moved:
            return True
        self._seen_ns = stamp_ns if self._seen_ns is None else self._seen_ns
        return stamp_ns - self._seen_ns >= 1e9 * self._config.confirm_s

    def servoed(self, q: np.ndarray, features: Any) -> None:
        """Notes that the law has answered an image of the target, taken at joint positions q, (n,)."""
        if self._action == "hold":
            return
        if self._lost_ns is not None:
            self.recoveries += self._moved
            self._found()
        self._path.append(q)
        self._direction = atan2(getattr(features, "yg", 0.0), getattr(features, "xg", 0.0))

    def recover(self, tick: Tick, text: str, visible: bool = False) -> Tick:
        """Returns the tick of an image without a usable target, with the motion of the recovery.

        Args: text: why the target is lost.  visible: it is seen, but not for long enough yet.
        """
        config, tick = self._config, tick.rest(Status.TARGET_LOST, text)
        if self._action == "hold":
            return tick
        if self._lost_ns is None:
            self._lost_ns = tick.stamp_ns
            if self.recoveries >= config.attempts:
                return tick.set(status=Status.STOPPED,
                                text=f"target lost once more after {self.recoveries} recoveries")
        if not visible:
            self._seen_ns = None
        lost_s = 1e-9 * (tick.stamp_ns - self._lost_ns)
        if lost_s >= config.time_limit_s:
            return tick.set(status=Status.STOPPED, text=f"target lost for {config.time_limit_s:g} s")
        if not self._path:
            return tick.set(text="target not in view, never seen")
        if not self._moved and lost_s < config.patience_s:
            return tick.set(text="target not in view, waiting")
        self._moved = True
        state = "in view again" if visible else "target not in view"
        if self._action == "back_off":
            q_dot = self._back(tick.q, tick.dt_s)
            return tick.set(q_dot=q_dot, twist=self._kinematics.jacobian(tick.q) @ q_dot,
                            text=f"{state}, backing off: {len(self._path)} images of the path left")
        if visible:  # stay where it is seen
            return tick.set(text=f"{state}, search ends")
        q_dot, twist, place = self._look_around(tick.stamp_ns, tick.q, tick.dt_s)
        return tick.set(q_dot=q_dot, twist=twist, text=f"{state}, searching: {place}")

    def _back(self, q: np.ndarray, dt_s: float) -> np.ndarray:
        """Joint velocities that go back along the path for dt_s, at the speed limit; zeros at its end."""
        if self._here is None:
            self._here = q
        begin, left = self._here, 1.0  # left: part of this period that is not used up yet
        while self._path and left > 0.0:
            way = self._kinematics.way(self._here, self._path[-1])
            needed = float(np.max(np.abs(way) / self._speed)) / dt_s  # periods
            if needed > left:
                self._here, left = self._kinematics.moved(self._here, way, left / needed), 0.0
            else:
                self._here, left = self._path.pop(), left - needed
        if not self._path:
            self._path.append(self._here)  # the arm waits where the path began
        return self._kinematics.way(begin, self._here) / dt_s

    def _look_around(self, stamp_ns: int, q: np.ndarray, dt_s: float) -> Tuple[np.ndarray, np.ndarray, str]:
        """Joint velocities towards the present place of the search, the twist, and which place it is."""
        config = self._config

        def time_s(way):
            """Time that a way takes at full speed of the camera [s]."""
            return _longest(way, config.speed_m_s, config.turn_rad_s)

        if self._places is None:
            X_BH = self._kinematics.pose(self._path[-1])
            places = search_places(config, self._direction)
            self._places, self._place, self._until_ns = [X_BH @ exponential(place) for place in places], -1, stamp_ns
        way = None if self._place < 0 else self._way(q)
        if way is None or stamp_ns >= self._until_ns or _longest(way, config.step_m, config.step_rad) < NEAR_PART:
            # Go on to the next place of the search, and from the last place to the first one.
            self._place = (self._place + 1) % len(self._places)
            way = self._way(q)
            self._until_ns = stamp_ns + ceil(1e9 * (PATIENT * time_s(way) + WHILE_S))
        twist = way / max(time_s(way), EASE_PERIODS * dt_s)
        motion = self._arm.joint_velocity(q, twist, *self._arm.at(q), dt_s)
        from ..arm.limits import velocity_factor  # C++: not needed to describe the settings of this file
        factor = velocity_factor(motion.q_dot, self._speed)
        return motion.q_dot * factor, motion.twist * factor, f"place {self._place + 1} of {len(self._places)}"

    def _way(self, q: np.ndarray) -> np.ndarray:
        """Twist [v; w] in C that, held for 1 s, brings the camera from q to the present place (to first order)."""
        X_CP = inverse(self._kinematics.pose(q)) @ self._places[self._place]
        return np.concatenate([X_CP[:3, 3], rotation_vector(X_CP[:3, :3])])


def _longest(way, linear, angular):
    """The larger part of a way, (6,), in these units of its translation and its turn."""
    return float(max(np.linalg.norm(way[:3]) / linear, np.linalg.norm(way[3:]) / angular))


@dataclass(eq=False)
class AfterLoss(Stage):
    """Twist stage: remembers the path, and slows the law down by `slow_down` after each recovery."""

    lost: LostTarget

    def apply(self, tick: Tick) -> Tick:
        if tick.features is not None:
            self.lost.servoed(tick.q, tick.features)
        return tick.set(twist=tick.twist * self.lost.factor) if self.lost.recoveries else tick
