"""Moving targets: the motion of the target is estimated from image and joints, and the camera moves along with it.

A law that only knows the error lags behind a target that moves at v by v / lambda. The target's own motion is the
motion that is seen, less the camera's motion. The difference is taken in space and not in the image, because there a
target with a constant velocity has a constant velocity however the camera turns. A Kalman filter follows a point of the
target and the attitude of the goal in B, and the camera moves as if it were fixed to the target (docs/theory.md T45).

References: T45, and F. Bensalah and F. Chaumette, IROS 1995 (targets that change their motion abruptly).
"""

from dataclasses import dataclass
from math import cos, sin
from typing import TYPE_CHECKING, Any, Optional, Sequence, Tuple

import numpy as np

from ..config.settings import setting
from ..ground.errors import ParameterError
from ..features.base import FeatureSet, View
from ..spatial import exponential, inverse, rotation, rotation_vector
from ..ground.types import FEATURE_NAMES, Reference
from .stage import Stage, Tick

if TYPE_CHECKING:  # it imports this file
    from .feature_filter import FeatureFilter

POSE_FEATURES = ("tx", "ty", "tz", "rx", "ry", "rz")
#: A singular value of the interaction matrix at the goal below this part of the largest one is not inverted.
RANK = 1e-4


@dataclass(frozen=True)
class FeedForwardSettings:
    """Section `servo.feed_forward`: the estimated motion of the target is fed forward."""

    acceleration_m_s2: float = setting(
        0.5, unit="m/s^2", above=0,
        help="Acceleration of the target (standard deviation). A larger value follows turns sooner, with more noise.")
    acceleration_rad_s2: float = setting(
        1.0, unit="rad/s^2", above=0,
        help="Angular acceleration of the target, likewise.")
    noise_m: float = setting(
        0.0003, unit="m", above=0, help="Noise of the goal's position from one image (standard deviation).")
    noise_rad: float = setting(0.001, unit="rad", above=0, help="Noise of the goal's attitude from one image.")
    speed_m_s: float = setting(
        0.1, unit="m/s", above=0, help="Initial speed of the target (standard deviation).")
    turn_rad_s: float = setting(
        0.3, unit="rad/s", above=0, help="Initial turn rate of the target, likewise.")
    part: float = setting(1.0, at_least=0, at_most=1, help="Part of the estimated motion that is fed forward.")


class ConstantVelocity:
    """Variances of a Kalman filter with state (place, velocity), the same for each axis, and its gains.

    The acceleration is white between two images (piecewise constant), as in Bar-Shalom et al., 2001, section 6.3.2.
    """

    def __init__(self, acceleration: float, noise: float, speed: float) -> None:
        """Args: standard deviations of acceleration, of a measured place, and of the velocity at first; > 0."""
        self._q, self._r = acceleration * acceleration, noise * noise
        self._pp, self._pv, self._vv = self._r, 0.0, speed * speed

    def gains(self, dt_s: float) -> Tuple[float, float]:
        """Returns the gains (place, velocity) of a measurement dt_s > 0 after the last; updates the variances."""
        pp = self._pp + dt_s * (2.0 * self._pv + dt_s * self._vv) + 0.25 * self._q * dt_s**4
        pv = self._pv + dt_s * self._vv + 0.5 * self._q * dt_s**3
        vv = self._vv + self._q * dt_s * dt_s
        place, velocity = pp / (pp + self._r), pv / (pp + self._r)
        self._pp, self._pv, self._vv = (1.0 - place) * pp, (1.0 - place) * pv, vv - velocity * pv
        return place, velocity


class TargetMotion(Stage):
    """Twist stage: estimates the target's motion and feeds it forward.

    Attributes:
        velocity: (3,) of the followed point in B [m/s].  turn: (3,) angular velocity in B [rad/s].
    """

    def __init__(self, config: FeedForwardSettings, features: FeatureSet,
                 tracker: "Optional[FeatureFilter]" = None) -> None:
        """Args: features: of the law.  tracker: foresees them, or None."""
        self._config, self._features, self._tracker = config, features, tracker
        self._exact = features.names in (FEATURE_NAMES, POSE_FEATURES)
        self._point_G: Any = None
        self._to_go: Any = None
        self.clear()

    def clear(self) -> None:
        """Forgets the estimate, because the target may have changed its motion."""
        config = self._config
        self._places = ConstantVelocity(config.acceleration_m_s2, config.noise_m, config.speed_m_s)
        self._turns = ConstantVelocity(config.acceleration_rad_s2, config.noise_rad, config.turn_rad_s)
        self._last_ns = self._point_B = self._R_BG = None
        self.velocity, self.turn = np.zeros(3), np.zeros(3)

    def set_reference(self, reference: Reference) -> None:
        """Takes over the goal. Raises ParameterError: the reference does not say where the target is in space."""
        if reference.view is None:
            raise ParameterError("feed_forward: the reference holds no view of the target: teach it again")
        view = reference.view
        self._point_G = np.array([view.xn, view.yn, view.an])
        if not self._exact:
            if reference.plane_C is None:
                raise ParameterError("feed_forward: the reference holds no plane: teach it again")
            L = self._features.matrix(View(view, reference.plane_C))
            self._to_go = -np.linalg.pinv(L, rcond=RANK)
        self.clear()

    def apply(self, tick: Tick) -> Tick:
        tracker, answer = self._tracker, tick.answer
        ahead, motion = (None, None) if tracker is None else (tracker.ahead, tracker.motion)
        tick.twist = tick.twist + self.twist(tick.stamp_ns, tick.X_BC, answer.s, answer.e, ahead, motion)
        return tick

    def goal_and_point(self, s: Sequence[float], e: Sequence[float]) -> Tuple[np.ndarray, np.ndarray]:
        """Returns (R_CG, p_CP): attitude of the goal, place of the followed point in the camera, from s and e, (k,)."""
        if self._features.names == FEATURE_NAMES:  # exact for a target parallel to the image
            c, sine = cos(e[3]), sin(e[3])
            return np.array([[c, -sine, 0.0], [sine, c, 0.0], [0.0, 0.0, 1.0]]), np.array(s[:3])
        if self._features.names == POSE_FEATURES:
            displacement = np.array(s)
            turned = np.concatenate([np.zeros(3), displacement[3:]])
            X_GC = exponential(turned)
            X_GC[:3, 3] = displacement[:3]
            X_CG = inverse(X_GC)
        else:
            X_CG = exponential(self._to_go @ np.array(e))
        return X_CG[:3, :3], X_CG[:3, :3] @ self._point_G + X_CG[:3, 3]

    def twist(self, stamp_ns: int, X_BC: np.ndarray, s: Sequence[float], e: Sequence[float],
              ahead: Optional[np.ndarray] = None, motion: Optional[np.ndarray] = None) -> np.ndarray:
        """Updates the estimate with one image. Returns V_C, (6,), of a camera that moves along with the target.

        The estimate pairs the features of the image with the pose at the image. The twist is for the camera where the
        features of the law are, which may be foreseen.
        Args: X_BC: (4, 4) pose of the camera at the image.  s, e: (k,) features and errors of the law.
            ahead: (k,) by how much these are ahead of the image.  motion: (6,) of the camera in that time.
        """
        R_BC = X_BC[:3, :3]
        _, foreseen_CP = R_CG, p_CP = self.goal_and_point(s, e)
        if ahead is not None:
            R_CG, p_CP = self.goal_and_point(np.array(s) - ahead, np.array(e) - ahead)
        point_B, R_BG = R_BC @ p_CP + X_BC[:3, 3], R_BC @ R_CG
        if self._last_ns is None:
            self._last_ns, self._point_B, self._R_BG = stamp_ns, point_B, R_BG
            return np.zeros(6)
        dt_s = 1e-9 * (stamp_ns - self._last_ns)
        self._last_ns = stamp_ns
        place, rate = self._places.gains(dt_s)
        predicted = self._point_B + dt_s * self.velocity
        off = point_B - predicted
        self._point_B, self.velocity = predicted + place * off, self.velocity + rate * off
        place, rate = self._turns.gains(dt_s)
        R_predicted = rotation(dt_s * self.turn) @ self._R_BG
        off = R_predicted @ rotation_vector(R_predicted.T @ R_BG)
        self._R_BG, self.turn = rotation(place * off) @ R_predicted, self.turn + rate * off
        if motion is not None:
            R_BC = R_BC @ rotation(motion[3:])
        w = self.turn @ R_BC
        if not self._features.sees_tilt:
            w[:2] = 0.0
        (wx, wy, wz), (x, y, z) = w.tolist(), foreseen_CP.tolist()
        vx, vy, vz = (self.velocity @ R_BC).tolist()  # of the point; the camera's origin has v - w x p_CP
        twist = [vx - wy * z + wz * y, vy - wz * x + wx * z, vz - wx * y + wy * x, wx, wy, wz]
        return self._config.part * np.array(twist)
