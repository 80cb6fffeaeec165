"""Stop rule: the servo has arrived when features, other bounds and the implied pose error are all within limits.

Feature errors alone do not tell: a tilt of the camera and a translation cancel in xn and yn. So CONVERGED asks for four
things at once, over `hold_s`: the mean of every feature error below its threshold; the tilt that is held from the
joints below `tilt_rad`; the displacement of the camera from the goal, at each image of that time, below `position_m`
and `rotation_rad`; and a camera that moves by less than half of these. The displacement of one image is L*^+ e (T60);
laws that work on the pose give it themselves. Images of the last AVERAGED_S seconds are averaged, and the standard
error counts as distance, so that noise cannot pass for arrival (T61).

Quantities that no number of images determines count too: the sides of the object within the steps of the grey levels,
the tilt of the target's plane, and motions that the features do not see (T73). If all others are within their
thresholds, the servo ends as SETTLED and names the undetermined quantities.

The published rule, |e| < thresholds and nothing else, is there by name. It ends a run with a status of its own.
"""

from dataclasses import dataclass
from math import nan
from typing import Optional, Sequence, Tuple

import numpy as np

from ..config.settings import setting
from .goal_pose import LeftOpen
from .stage import UNKNOWN

RULES = ("pose", "published")
#: The camera is close to the goal while every error is below this many times its threshold. Only there does the matrix
#: of the goal hold, and images are averaged.
CLOSE = 5.0
#: Noise may take single images farther; it is not close any more when none has been for so long [s].
LEAVE_S = 1.0
#: Images are averaged over this time at most [s].
AVERAGED_S = 10.0
#: So many standard errors of the mean count as distance from the goal.
SURE = 2.0
#: Within hold_s the camera moves by less than this part of position_m and rotation_rad: it has come to rest.
MOVED = 0.5
#: When all but what the model leaves open has been within its threshold for so long, waiting is over [s].
SETTLE_S = 5.0
#: The servo comes to rest when all that is judged is below this part of its threshold ...
REST = 0.5
#: ... and moves again when something is above this part of it.
MOVE = 0.8
#: Close to the goal for longer than PATIENCE_S without having arrived, the servo calms down, since delay or noise keep
#: it hunting: its rates become smaller with the time, down to CALM_PER_S.
PATIENCE_S, CALM_PER_S = 2.0, 1.0


@dataclass(frozen=True)
class StopSettings:
    """Section `servo.stop`: conditions of CONVERGED in addition to `thresholds` and `hold_s`."""

    rule: str = setting(
        "pose", choices=RULES,
        help="`pose`: features, tilt and pose, as below. `published`: only every error below its threshold, in each "
             "image of `hold_s`; the run ends as STOPPED_BY_RULE, never as CONVERGED.")
    tilt_rad: float = setting(
        0.0005, unit="rad", above=0,
        help="Largest angle of the optical axis to its taught direction, by the joints, if the servo holds it "
             "(`tilt_gain_per_s`).")
    position_m: float = setting(
        0.0006, unit="m", above=0,
        help="Largest distance of the camera from the goal, computed from the feature errors.")
    rotation_rad: float = setting(
        0.0024, unit="rad", above=0, help="Largest angle of the camera to the goal, likewise.")
    normal_rad: float = setting(
        0.2, unit="rad", at_least=0,
        help="Uncertainty of `target_normal_C`: the pose must be within both limits for every such plane (T73).")


class StopRule:
    """Watches the images of one run.

    Attributes:
        judged: (tilt_rad, position_m, rotation_rad) of the last image: the tilt, and the camera's distance and angle
            from the goal as far as the images up to it tell, with what they leave open; NaN where it is not known.
        uncertain: the pose is not within its limits, or not known to be, when what images leave open is counted.
        hopeless: ... and more images would not change that.
        lacking: what kept the servo from having arrived at the last image: features, "tilt", "position", "rotation",
            "rest".
        close: the last image was close to the goal.
        resting: all that is judged is so small that there is nothing to correct (`REST`, `MOVE`).
    """

    def __init__(self, names: Sequence[str], thresholds: Sequence[float], hold_s: float, settings: StopSettings,
                 follows: bool, taught_images: int = 1, left_open: LeftOpen = LeftOpen()) -> None:
        """Args: names, thresholds: of the features. follows: the goal may move.

        taught_images: number of images whose mean is the goal: their noise counts too.
        left_open: the part of the pose that images do not determine.
        """
        from .._kinematics import Arrival, between  # C++: not needed to describe the settings of this file
        self._names, self._thresholds, self._settings = names, thresholds, settings
        self._close = tuple([CLOSE * threshold for threshold in thresholds])
        self._hold_ns, self._follows, self._between = round(1e9 * hold_s), follows, between
        kept_ns = self._hold_ns if follows else max(self._hold_ns, round(1e9 * AVERAGED_S))
        self._images = Arrival(thresholds, self._hold_ns, kept_ns, settings.position_m, settings.rotation_rad,
                               settings.tilt_rad, SURE, taught_images, left_open.edges, left_open.planes)
        self._goal_edge = left_open.edge_stddev
        self._of_features = [stddev / most for stddev, most in zip(left_open.of_features.tolist(), thresholds)]
        self._last_ns = self._since_ns = self._settled_ns = None
        self.clear()

    def clear(self) -> None:
        """Forgets the images seen."""
        if self._last_ns is not None:
            self._images.clear()
        self._X_BC = self._last_ns = self._since_ns = self._close_ns = None
        self.uncertain = self.hopeless = False
        self.judged, self.lacking, self.close, self.resting = UNKNOWN, ("no image",), False, False

    def arrived(self, stamp_ns: int, e: Sequence[float], tilt: Optional[Sequence[float]], pose: Optional[np.ndarray],
                X_BC: np.ndarray, pose_of_law: bool = False, edge_stddev: float = nan) -> bool:
        """Returns whether the camera has been at the goal for `hold_s`, as far as images tell (`uncertain`).

        Args:
            e: (k,) feature errors.  tilt: (2,) about x and y by the joints, None where it is not held.
            pose: (6,) displacement from the goal by this image, None where it is not known.
            X_BC: (4, 4) pose of the camera by the joints.
            pose_of_law: the pose is the law's own and not that of e, so that a small e does not say that it holds.
            edge_stddev: of the features of this image.
        """
        tilt_rad = nan if tilt is None else (tilt[0] * tilt[0] + tilt[1] * tilt[1]) ** 0.5
        if self._is_close(e, tilt_rad, pose if pose_of_law else None):
            self._close_ns = stamp_ns
        self.close = self._close_ns is not None and stamp_ns - self._close_ns <= 1e9 * LEAVE_S
        if not self.close:
            self.clear()
            self.judged = (tilt_rad, *_size(pose))
            lacking = [name for name, error, most in zip(self._names, e, self._thresholds) if not abs(error) < most]
            self.lacking = (*lacking, "tilt") if tilt_rad >= self._settings.tilt_rad else tuple(lacking)
            return False
        if self._since_ns is None:
            self._since_ns = stamp_ns
        self._last_ns = stamp_ns
        moved = self._moved(X_BC)
        means, tilt_part = self._images.features(stamp_ns, e, tilt_rad, moved)
        parts = dict(zip(self._names, means))
        if tilt_rad == tilt_rad:
            parts["tilt"] = tilt_part
        most, self.judged = max(parts.values()), (tilt_rad, nan, nan)
        variance = sum([stddev * stddev for stddev in (edge_stddev, self._goal_edge) if stddev == stddev])
        edges = [variance**0.5 * part for part in self._of_features]
        self.hopeless = pose is None or max(edges, default=0.0) >= 1.0
        self.uncertain = self.hopeless or any([part * part + edge * edge >= 1.0 for part, edge in zip(means, edges)])
        if pose is not None:
            (off, parts["rest"], parts["position"], parts["rotation"], known, left_open, position_m,
             rotation_rad) = self._images.place(stamp_ns, moved, pose, variance)
            parts["rest"] /= MOVED
            most, self.judged = max(most, off), (tilt_rad, position_m, rotation_rad)
            self.uncertain = self.uncertain or not known < 1.0
            self.hopeless = self.hopeless or not left_open < 1.0
        self.resting = most < (MOVE if self.resting else REST)
        self.lacking = tuple([name for name, part in parts.items() if not part < 1.0])
        if self.lacking or stamp_ns - self._since_ns < self._hold_ns:
            return False
        if self._settled_ns is None:
            self._settled_ns = stamp_ns
        self.hopeless = self.hopeless or stamp_ns - self._settled_ns >= 1e9 * SETTLE_S
        return True

    def _is_close(self, e: Sequence[float], tilt_rad: float, pose: Optional[np.ndarray]) -> bool:
        settings, (position, rotation) = self._settings, _size(pose)
        far = (tilt_rad > CLOSE * settings.tilt_rad or position > CLOSE * settings.position_m
               or rotation > CLOSE * settings.rotation_rad)
        return not far and all([abs(error) < most for error, most in zip(e, self._close)])

    def _moved(self, X_BC: np.ndarray) -> np.ndarray:
        """(6,) displacement by the joints since the first image close to the goal; zeros if the goal may move."""
        if self._follows:
            return np.zeros(6)
        if self._X_BC is None:
            self._X_BC = X_BC
        return self._between(self._X_BC, X_BC)

    def calm(self, rate_per_s: float) -> float:
        """Returns the factor of a rate [1/s] of the servo: 1, or less where it has been close to the goal for long."""
        if self._last_ns is None:
            return 1.0
        over_s = 1e-9 * (self._last_ns - self._since_ns) - PATIENCE_S
        return 1.0 if over_s <= 0.0 else max(1.0 / (1.0 + over_s), min(1.0, CALM_PER_S / rate_per_s))

    def why_not(self) -> str:
        """Returns a text about the conditions that failed at the last image."""
        return ", ".join(self.lacking) or ("a pose that is known well enough" if self.uncertain else
                                           "everything for less than hold_s")


def _size(pose: Optional[np.ndarray]) -> Tuple[float, float]:
    if pose is None:
        return nan, nan
    x, y, z, a, b, c = pose.tolist()
    return (x * x + y * y + z * z) ** 0.5, (a * a + b * b + c * c) ** 0.5
