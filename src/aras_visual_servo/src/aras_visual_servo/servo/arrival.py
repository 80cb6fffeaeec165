"""Stage: judges each image by the stop rule, and ends the servo when it has arrived."""

from math import atan2, degrees, nan
from typing import Any, Optional

import numpy as np

from ..arm.motion import ArmMotion
from ..ground.types import FINAL, Status
from .feature_filter import FeatureFilter
from .goal import Goal
from .goal_pose import LeftOpen
from .stage import Stage, Tick
from .stop_rule import StopRule, StopSettings

#: The target counts as displaced when the camera at the goal stands further from the taught place than so many times
#: what the stop rule allows.
DISPLACED = 4.0


class Arrival(Stage):
    """Feeds the stop rule.

    Attributes:
        rule: `StopRule`.  displaced: how far the target is from where it was taught, in words; "" if it is there.
        holds_tilt: whether the optical axis is held by the joint positions.
    """

    def __init__(self, goal: Goal, arm: ArmMotion, config: Any, tracker: Optional[FeatureFilter]) -> None:
        """Args: config: `ServoSettings`.  tracker: filters the features, or None."""
        images = goal.reference.images if goal.reference is not None and goal.source.averages else 1
        left_open = LeftOpen() if goal.pose is None else goal.pose.left_open
        self.rule = StopRule(goal.features.names, config.thresholds, config.hold_s, config.stop, config.follows, images,
                             left_open)
        self._goal, self._arm, self._config, self._tracker = goal, arm, config, tracker
        self.holds_tilt = config.holds_tilt(goal.features.sees_tilt)
        self._tells_displaced = not (config.follows or config.symmetric_target)
        self._below_ns: Optional[int] = None
        self.displaced = ""
        self._unseen = goal.unseen(self.holds_tilt)

    @property
    def below(self) -> bool:
        """Whether every error of the last image was below its threshold."""
        return self._below_ns is not None

    def apply(self, tick: Tick) -> Tick:
        if tick.features is None:
            self.rule.clear()
            self._below_ns, self.displaced = None, ""
            text = f"target not seen for {self._tracker.unseen_s(tick.stamp_ns):.2f} s"
            return tick.set(judged=self.rule.judged, status=Status.SERVOING,
                            text=f"servoing on foreseen features, {text}")
        answer, rule, config, X_BC = tick.answer, self.rule, self._config, tick.X_BC
        tilt, pose = self._arm.tilt_of(X_BC) if self.holds_tilt else None, answer.pose
        if pose is None:
            pose = self._goal.pose.of(np.array(answer.e), tilt)
        tick.pose = pose
        arrived = rule.arrived(tick.stamp_ns, answer.e, tilt, pose, X_BC, answer.pose is not None,
                               getattr(tick.features, "edge_stddev", nan))
        published, self.displaced = config.stop.rule == "published", ""
        if rule.close and self._tells_displaced and self._goal.reference.posture is not None:
            self.displaced = displaced_target(self._goal.displacement(X_BC), pose, config.stop)
        within = (all([abs(e) < most for e, most in zip(answer.e, config.thresholds)]) if published
                  else not rule.lacking)
        if not (answer.settled and within):
            self._below_ns = None
        elif self._below_ns is None:
            self._below_ns = tick.stamp_ns
        displaced = f"; {self.displaced}" if self.displaced else ""
        tick.judged, tick.status, tick.text = rule.judged, Status.SERVOING, f"servoing{displaced}"
        if config.track or not self.below:
            return tick
        if published and tick.stamp_ns - self._below_ns >= 1e9 * config.hold_s:
            return tick.rest(Status.STOPPED_BY_RULE, f"stopped by the published rule{displaced}")
        if not arrived or published:
            return tick
        unknown = self._unknown(X_BC)
        if unknown:
            return tick.rest(Status.SETTLED, f"arrived as far as these features tell: {unknown}{displaced}")
        if rule.uncertain:
            return tick
        return tick.rest(Status.CONVERGED, f"features, tilt and pose within their thresholds{displaced}")

    def _unknown(self, X_BC: np.ndarray) -> str:
        """Returns a text about the part of the pose that no image determines; "" if there is none."""
        if self._unseen:
            return f"{', '.join(self._unseen)} not seen"
        if not self._config.follows and self._goal.turned_alike(X_BC):
            return "the target looks the same after a part of a turn, and by the joints the camera is turned by it"
        rule = self.rule
        if not (rule.uncertain and rule.hopeless):
            return ""
        _, position_m, rotation_rad = rule.judged
        if not position_m == position_m:
            return "the pose of the camera is not known"
        return f"the pose is known to {1e3 * position_m:.2g} mm and {degrees(rotation_rad):.2g} deg only"

    def rest(self, tick: Tick) -> Tick:
        """Forgets the images seen, unless the servo has ended."""
        if tick.status not in FINAL:
            self._below_ns = None
            self.rule.clear()
        return tick


def displaced_target(X_CgC: np.ndarray, pose: Optional[np.ndarray], stop: StopSettings) -> str:
    """Returns a text about the displacement of the target since it was taught; "" without one.

    A camera that sees a target at rest as it was taught stands where it was taught. The joints
    give its pose, and the image its displacement from the taught view. Their difference is the motion of the target, or
    an error of the arm, its model or the camera's calibration. The servo cannot distinguish these.
    Args:
        X_CgC: (4, 4) pose of the camera by the joints, relative to the taught one.
        pose: (6,) displacement from the taught view by the image, small [m, rad]; None: not known.
    """
    if pose is None:
        return ""
    (xx, xy, xz, x), (yx, yy, yz, y), (zx, zy, zz, z), _ = X_CgC.tolist()
    px, py, pz, wx, wy, wz = pose.tolist()
    distance_m = ((x - px) ** 2 + (y - py) ** 2 + (z - pz) ** 2) ** 0.5
    sines = 0.5 * (zy - yz) - wx, 0.5 * (xz - zx) - wy, 0.5 * (yx - xy) - wz
    angle_rad = atan2(sum([sine * sine for sine in sines]) ** 0.5, 0.5 * (xx + yy + zz - 1.0))
    if distance_m <= DISPLACED * stop.position_m and angle_rad <= DISPLACED * stop.rotation_rad:
        return ""
    return f"the target is found {1e3 * distance_m:.1f} mm and {degrees(angle_rad):.1f} deg from where it was taught"
