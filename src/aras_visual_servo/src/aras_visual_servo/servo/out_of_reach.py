"""Rests the arm at the point nearest to the goal, and reports the direction in which the camera cannot continue.

At the end of its workspace an arm cannot follow the law. The damped inverse then turns joints of a stretched arm to and
fro from image to image, or a joint rests at its limit. Three steps follow each other:

1. The stage watches the camera over WINDOW_S. The arm is at its end when the camera drifts slower than DRIFT, the law
   asks for ASKED times as much, and the camera does not follow a slow way steadily.
2. Where joints chatter, the stage removes the singular directions from the twist that the law asks for. The arm goes on
   in the other directions, so that the camera comes to the nearest point.
3. The joints stand still with status OUT_OF_REACH. The servo goes on when the law asks for another twist, because the
   target has moved.
"""

from collections import deque
from typing import Any, Deque, Optional, Tuple

import numpy as np

from ..arm.motion import ArmMotion, Motion
from ..ground.types import Status
from .nearest_point import DISTANCE_M, NearestPoint, direction, would_go_on
from .stage import Tick
from .stop_rule import StopRule

#: Time over which the motion is watched before and during step 2, and between two looks at it [s].
WINDOW_S, CALM_WINDOW_S, LOOK_S = 2.0, 1.0, 0.25
#: Drift (translation [m/s], rotation [rad/s]) below which the end may be reached, and below which the camera rests.
DRIFT, RESTS = np.array([0.01, 0.015]), np.array([0.001, 0.002])
#: The end is reached too where joints chatter for SLOW_S and the drift is less than this part of the requested twist.
SLOW, SLOW_S = 0.05, 12.0
#: A commanded way above this that is longer than the drift goes to and fro [m/s, rad/s].
SWINGS = np.array([0.01, 0.02])
#: At the end of the reach the requested twist is this many times the drift, and at least LEAST [m/s, rad/s].
ASKED, LEAST = 5.0, np.array([0.003, 0.012])
#: Factor on DRIFT where joints swing slowly.
SWINGING = 3.0
#: A camera whose drift is more than this part of its commanded way goes steadily.
STEADY = 0.5
#: After this time in step 2 a camera that is slower than DRIFT, or swings, has come as far as it can [s].
CALM_S = 4.0
#: A lost direction is removed when it holds this part of the requested twist.
TAKEN = 0.1
#: The servo continues when the requested twist, averaged over MEAN_S [s], has changed by this part.
CHANGED, MEAN_S = 0.1, 0.2


class OutOfReach:
    """Watches the arm of one servo. Attributes: asked: (6,) twist that the resting arm cannot do; None: it does not
    rest."""

    def __init__(self, arm: ArmMotion, rule: StopRule, swings: bool = False,
                 nearest: Optional[NearestPoint] = None) -> None:
        """Args: rule: tells where the camera is close to the goal; nothing is watched there.  swings: joints swing more
        slowly than from image to image, as under limits of their acceleration.  nearest: is asked first."""
        from .._kinematics import between  # C++: not needed to describe the settings of the servo
        self._arm, self._rule, self._between, self._active = arm, rule, between, arm.has_ends
        self._drift, self._nearest = SWINGING * DRIFT if swings else DRIFT, nearest
        self.clear()

    def clear(self) -> None:
        """Clears the history: another stage stopped the arm."""
        self.asked: Optional[np.ndarray] = None
        self._text, self._calm_ns = "", None  # type: str, Optional[int]
        self._lost = np.zeros((0, 6))
        self._forget()

    def _forget(self) -> None:
        #: Of each image: stamp, (6,) place of the camera, (6,) place as asked, (2,) way as commanded, (n,) joints.
        self._images: Deque[Tuple[int, np.ndarray, np.ndarray, np.ndarray, np.ndarray]] = deque()
        self._X_BC: Any = None
        self._place, self._way, self._look_ns, self._slow_ns = np.zeros(6), np.zeros(2), 0, 0

    def held(self, tick: Tick) -> Optional[Motion]:
        """Returns the `Motion` of a resting arm; None where the arm does not rest, or goes on with this image."""
        motion = None if self._nearest is None else self._nearest.motion(tick)
        if motion is not None:
            self.clear()
            return motion
        if self.asked is None:
            return None
        part = min(1.0, tick.dt_s / MEAN_S)
        self._mean = self._mean + part * (self._arm.within_limits(tick.twist) - self._mean)
        if _size(self._mean - self.asked) > CHANGED * _size(self.asked):
            self.clear()
            return None
        self._arm.rest()
        return Motion(np.zeros_like(tick.q), np.zeros(6), Status.OUT_OF_REACH, self._text)

    @property
    def over(self) -> bool:
        """Whether the arm has rested for so long that the servo ends."""
        return self._nearest is not None and self._nearest.over

    def left(self, twist: np.ndarray) -> np.ndarray:
        """Returns the part of a requested twist, (6,), that the arm is to do."""
        return self._arm.without(twist, self._lost) if len(self._lost) else twist

    def told(self, asked: np.ndarray, left: np.ndarray, motion: Motion) -> Motion:
        """Returns the `Motion` of the part `left` of a requested twist, with a status about the omitted part."""
        if left is asked or motion.status is not None:
            return motion
        text = f"the arm cannot go on {direction(asked - left)}, as seen in the camera's image"
        return motion._replace(status=Status.NEAR_SINGULARITY, text=text)

    def watch(self, tick: Tick, asked: np.ndarray, motion: Motion) -> None:
        """Updates the history with the answer to an image. Args: asked: (6,) requested twist."""
        if self._nearest is not None:
            self._nearest.hindered = motion.status is not None
        if not self._active or self.asked is not None or self._nearest is not None and self._nearest.active:
            return
        if self._rule.close:
            if self._images or self._calm_ns is not None:
                self.clear()
            return
        if self._X_BC is None:
            self._X_BC, self._look_ns, self._slow_ns = tick.X_BC, tick.stamp_ns, tick.stamp_ns
        place = self._between(self._X_BC, tick.X_BC)
        self._images.append((tick.stamp_ns, place, self._place, self._way, tick.q))
        self._place = self._place + tick.dt_s * self._arm.within_limits(asked)
        self._way = self._way + tick.dt_s * _parts(tick.jacobian @ motion.q_dot)
        if tick.stamp_ns - self._look_ns >= 1e9 * LOOK_S:
            self._look_ns = tick.stamp_ns
            self._look(tick, asked, motion)

    def _look(self, tick: Tick, asked: np.ndarray, motion: Motion) -> None:
        calm_ns, images = self._calm_ns, self._images
        window_ns = 1e9 * (WINDOW_S if calm_ns is None else CALM_WINDOW_S)
        while len(images) > 2 and tick.stamp_ns - images[1][0] >= window_ns:
            images.popleft()
        if tick.stamp_ns - images[0][0] < window_ns:
            return
        drift, wanted, way = self._rates()
        if calm_ns is None:
            stands = (way < SWINGS).all()
            ends = (drift < self._drift).all() and (wanted > np.maximum(LEAST, ASKED * drift)).any()
            if not self._arm.chatters or (drift > SLOW * wanted).any():
                self._slow_ns = tick.stamp_ns
            ends = ends or tick.stamp_ns - self._slow_ns > 1e9 * SLOW_S
            if not ends or not (stands or self._arm.chatters or _total(drift) < STEADY * _total(way)):
                return
            self._calm_ns = calm_ns = tick.stamp_ns
        elif len(self._lost) and not self._held_by(self._lost, asked).any():
            self.clear()
            return
        swings = self._arm.chatters or (way > SWINGS).any() and _total(drift) < STEADY * _total(way)
        late = tick.stamp_ns - calm_ns > 1e9 * CALM_S
        if swings and not late:
            self._take_out(asked)
        elif not (swings or (drift < (DRIFT if late else RESTS)).all()):
            if not len(self._lost) and (drift > DRIFT).any():  # the camera follows again
                self._calm_ns = None
        elif not self._arm.others_could(tick.q, asked, tick.jacobian, motion):
            self._rest(motion)

    def _take_out(self, asked: np.ndarray) -> None:
        """Removes lost directions from the requested twist. Args: asked: (6,)."""
        lost = self._arm.lost_directions(np.mean([image[4] for image in self._images], axis=0))
        self._lost = lost[self._held_by(lost, asked)]
        self._forget()

    def _held_by(self, lost: np.ndarray, asked: np.ndarray) -> np.ndarray:
        """Returns (k,) whether each direction, (k, 6), holds a significant part of the requested twist."""
        scaled = self._arm.scaled(asked)
        return np.abs(lost @ scaled) > TAKEN * np.linalg.norm(scaled)

    def _rates(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """((2,), (2,), (2,)): translation and rotation per second of the camera, as asked, and of the commanded way.

        The first two are of the mean place in the second half of the window against that in the first half, so that
        an oscillation does not count.
        """
        stamps, place, asked, way, _ = zip(*self._images)
        half, period_s = len(stamps) // 2, 0.5e-9 * (stamps[-1] - stamps[0])
        drift, wanted = (_parts(np.mean(values[half:], axis=0) - np.mean(values[:half], axis=0)) / period_s
                         for values in (place, asked))
        return drift, wanted, 0.5 * (way[-1] - way[0]) / period_s

    def _rest(self, motion: Motion) -> None:
        first, last = self._images[-1 - len(self._images) // 2], self._images[-1]
        self.asked = self._mean = (last[2] - first[2]) / (1e-9 * (last[0] - first[0]))
        by = f", {motion.text}" if motion.status == Status.JOINT_LIMIT else ""
        self._text = f"out of reach{by}; {would_go_on(self.asked)}"


def _parts(twist: np.ndarray) -> np.ndarray:
    """(2,) sizes of translation and rotation."""
    vx, vy, vz, wx, wy, wz = twist.tolist()
    return np.array([(vx * vx + vy * vy + vz * vz) ** 0.5, (wx * wx + wy * wy + wz * wz) ** 0.5])


def _size(twist: np.ndarray) -> float:
    return _total(_parts(twist))


def _total(parts: np.ndarray) -> float:
    return float(parts @ (1.0, DISTANCE_M))
