"""Where a target may lie on its plane, so that the arm can bring the camera to the taught view of it. No ROS.

The camera has to stand to the target as it stood when the view was taught, as far as the servo tells. With features
that do not see the tilt, and no `tilt_gain_per_s`, any tilt will do. Each place is searched from the joint positions of
the place beside it, as the arm would come there. So the map shows the reach of the servo from its posture, not the
reach of the arm in another posture.
"""

from heapq import heappop, heappush
from math import inf
from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..arm.nearest import Nearest, nearest
from ..servo.goal_pose import GoalPose
from ..servo.servo import Servo
from ..spatial import inverse, transform
from .feasibility import Feasibility

if TYPE_CHECKING:
    from .scenario import Scenario

#: Distance of the places that are tried first, to see how far the reach goes [m], and how many of them at most.
FIRST_M, FIRST_PLACES = 0.1, 900
#: Places of the map along each side.
SIDE = 41
#: A place out of reach is searched again from this many others beside it.
TRIES = 2
#: Steps of a search, and of the first one.
STEPS, STEPS_FIRST = 15, 200
Place = Tuple[int, int]


class ReachMap(NamedTuple):
    """Places of the target on its plane, as a grid.

    Attributes:
        X_WP: (4, 4) frame of the plane, with the attitude of the target.
        first_m: (2,) x, y in P of the place [0, 0].  step_m: (2,) from place to place along x and y.
        missing_m: (SIDE, SIDE), [along y, along x]: how near the camera comes [m]; 0 where it comes to the taught view,
            inf where the image would not show the target.
    """

    X_WP: np.ndarray
    first_m: np.ndarray
    step_m: np.ndarray
    missing_m: np.ndarray


class _Search:
    """Places of a grid, searched from place to place, those within reach first."""

    def __init__(self, ask: Any, step_m: np.ndarray, inside: Any) -> None:
        """Args: ask: (x, y [m], (n,) joints to begin at) -> (`Nearest`, missing [m]).  inside: Place -> bool."""
        self._ask, self._step_m, self._inside = ask, step_m, inside
        self.found: Dict[Place, Tuple[Nearest, float]] = {}
        self._tries: Dict[Place, int] = {}

    def run(self, q: np.ndarray, most: float, through: bool) -> "_Search":
        """Searches from place (0, 0), at joints q, (n,), `most` places.  through: goes on from places out of reach."""
        self._try((0, 0), q)
        heap: List[Tuple[float, Place]] = [(self.found[0, 0][1], (0, 0))]
        while heap and len(self.found) < most:
            missing_m, (x, y) = heappop(heap)
            if missing_m > self.found[x, y][1]:
                continue  # it has been found within reach since then
            for beside in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                if self._inside(beside) and self._try(beside, self.found[x, y][0].q):
                    near = abs(beside[0]) < 2 and abs(beside[1]) < 2
                    if through or near or self.found[beside][1] == 0.0:
                        heappush(heap, (self.found[beside][1], beside))
        return self

    def _try(self, place: Place, q: np.ndarray) -> bool:
        """Whether a place is new, or nearer than it was found before."""
        before = self.found.get(place)
        if before is not None and (before[1] == 0.0 or self._tries[place] >= TRIES):
            return False
        self._tries[place] = self._tries.get(place, 0) + 1
        found = self._ask(*(np.array(place) * self._step_m), q)
        if before is not None and found[1] >= before[1]:
            return False
        self.found[place] = found
        return True


def reach_map(scenario: "Scenario", kinematics: RobotKinematics, servo: Servo, X_WC: np.ndarray, X_WT: np.ndarray,
              X_WT_now: np.ndarray, q: np.ndarray) -> ReachMap:
    """Returns the `ReachMap` of a taught view.

    Args: servo: the goal was taught to it, or it is asked as if it told the whole pose.  X_WC, X_WT: (4, 4) camera and
        target when the view was taught.  X_WT_now: (4, 4), which gives plane and attitude.  q: (n,) joints now.
    """
    config, X_TC, feasibility = servo.config, inverse(X_WT) @ X_WC, Feasibility(scenario, kinematics)
    lower, upper = kinematics.lower + config.joint_limit_margin, kinematics.upper - config.joint_limit_margin
    pose: Optional[GoalPose] = servo.goal.pose
    rows = None if pose is None else pose.told_rows(config.holds_tilt(servo.goal.features.sees_tilt))
    R, p = X_WT_now[:3, :3], X_WT_now[:3, 3]
    X_WP = transform(R, X_WT[:3, 3] - R[:, 2] * float(R[:, 2] @ (X_WT[:3, 3] - p)))

    def ask(x, y, begin, steps=STEPS):
        X = X_WP @ transform(np.eye(3), (x, y, 0.0))
        found = nearest(kinematics, X @ X_TC, begin, lower, upper, rows, steps)
        if not found.within(config.stop.position_m, config.stop.rotation_rad):
            return found, max(found.sizes[0], config.stop.position_m)
        if feasibility.outline is not None:
            feasibility.outline.X_WT = X
        return found, inf if feasibility.refusal(found.q, found.q) else 0.0

    begin = ask(0.0, 0.0, nearest(kinematics, X_WC, q, lower, upper, None, STEPS_FIRST).q, STEPS_FIRST)[0].q
    step_m = np.full(2, FIRST_M)
    first = _Search(ask, step_m, lambda _place: True).run(begin, FIRST_PLACES, False).found
    within = np.array([(0, 0), *(place for place, (_, missing_m) in first.items() if missing_m == 0.0)])
    low, high = (within.min(axis=0) - 1.5) * FIRST_M, (within.max(axis=0) + 1.5) * FIRST_M
    step_m = (high - low) / (SIDE - 1)
    corner = np.round(low / step_m).astype(int)
    (left, low), (right, high) = corner, corner + SIDE
    found = _Search(ask, step_m, lambda place: left <= place[0] < right and low <= place[1] < high).run(
        begin, inf, True).found
    missing_m = np.array([[found[x, y][1] for x in range(left, right)] for y in range(low, high)])
    return ReachMap(X_WP, corner * step_m, step_m, missing_m)
