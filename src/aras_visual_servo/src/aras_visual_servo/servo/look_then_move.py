"""Look then move: one image, one move of the set-points, wait until the arm rests, the next image (T15)."""

from dataclasses import dataclass
from math import inf
from typing import Any, Optional, Tuple

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..arm.limits import position_factor
from ..arm.motion import ArmMotion
from ..arm.trajectory import JointTrajectory
from ..ground.types import Status
from .arrival import Arrival
from .gates import FREE_S, SETTLING
from .stage import Stage, Tick

#: A look's displacement is followed in this many steps (the arm's Jacobian turns on the way), and this part of the tilt
#: is corrected by each look.
LOOK_STEPS, LOOK_TILT = 10, 0.9
_MOVING = (Status.SERVOING, Status.JOINT_LIMIT, Status.NEAR_SINGULARITY)


class LookThenMove(Stage):
    """The moves of the set-points, one after the other.

    Attributes: set_point: (n,) joint set-points as commanded last, None until they are known.
    """

    def __init__(self, kinematics: RobotKinematics, arm: ArmMotion, config: Any, arrival: Arrival,
                 set_point: Optional[np.ndarray] = None) -> None:
        """Args: config: `ServoSettings`.  set_point: (n,) joint set-points commanded last; None: as measured first."""
        self._kinematics, self._arm, self._config = kinematics, arm, config
        self._arrival, self._begin_ns, self._followed_s, self._held = arrival, 0, 0.0, ""
        self.set_point: Any = set_point
        self._move: Any = None
        self._last: Any = None

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the begin of the move that this look asks for."""
        if self._arrival.below:
            return tick.set(twist=np.zeros(6), applied=np.zeros(6), q_dot=np.zeros_like(tick.q), text="holding",
                            held="holding, every error is below its threshold")
        rule, target_C, applied, features = self._arrival.rule, None, tick.twist, tick.view.features
        lacking = rule.lacking
        rule.clear()
        rule.lacking = lacking  # what the time limit says
        if self._arrival.holds_tilt:
            target_C = features.xn, features.yn, features.an
        twist, manipulability, joint = self.plan(tick.stamp_ns, tick.q, tick.X_BC, tick.twist, target_C)
        tick = tick.set(twist=twist, applied=applied, manipulability=manipulability, judged=rule.judged)
        self._held = "" if joint is None else f"joint '{joint}' at its limit"
        if joint is not None:
            tick = tick.set(status=Status.JOINT_LIMIT, text=self._held)
        return self.followed(tick)

    def followed(self, tick: Tick) -> Tick:
        """Returns the tick with the next period of the move under way."""
        t_s = 1e-9 * (tick.stamp_ns - self._begin_ns)
        self._followed_s = t_s + tick.dt_s
        self.set_point, q_dot = self._move.step(t_s, tick.dt_s)
        if tick.status not in _MOVING:
            tick = tick.set(status=Status.SERVOING, text="moving")
        over_s = t_s - self._move.duration_s
        if over_s >= 0.0 and tick.status == Status.SERVOING:
            tick.text = SETTLING
        late = over_s > FREE_S and "the joints do not settle"
        return tick.set(q_dot=q_dot, set_point=self.set_point, held=self._held or late or "")

    def rest(self, tick: Tick) -> Tick:
        """Breaks the move off where it is, and follows what moves the arm while the target is lost."""
        if self._move is not None:
            t_s = min(1e-9 * (tick.stamp_ns - self._begin_ns), self._followed_s)
            self.set_point = tick.set_point = self._move.position(t_s)
            self._move = self._last = None
        if self.set_point is not None:
            self.set_point = self._kinematics.moved(self.set_point, tick.q_dot * tick.dt_s, 1.0)
        return tick

    def plan(self, stamp_ns: int, q: np.ndarray, X_BC: np.ndarray, twist: np.ndarray,
             target_C: Optional[Tuple[float, float, float]]) -> Tuple[np.ndarray, float, Optional[str]]:
        """Begins the move that one look asks for.

        Args:
            q: (n,) measured.  X_BC: (4, 4) pose of the camera there.  twist: V_C, (6,), of the law.
            target_C: (x, y, z) of the target if tilt is held, or None.
        Returns:
            (twist with tilt hold, manipulability, name of the joint that shortens the move or None).
        """
        motion, ahead = twist * self._config.sample_time_s, q
        for step in range(LOOK_STEPS):
            jacobian, inverse = self._arm.at(ahead)
            if step == 0:
                manipulability = inverse.manipulability
                if target_C is not None:
                    motion = motion + self._arm.tilt(X_BC, inverse, LOOK_TILT, target_C)
                twist = motion / self._config.sample_time_s
            q_dot = self._arm.unlimited(ahead, motion, inverse)
            turning = self._arm.turning(ahead, q_dot, jacobian, inverse, 1.0 / LOOK_STEPS)
            ahead = self._kinematics.moved(ahead, (q_dot + turning) / LOOK_STEPS, 1.0)
        if self.set_point is None:
            self.set_point = q
        wanted, shortened_by = self._kinematics.moved(self.set_point, self._kinematics.way(q, ahead), 1.0), None
        target = np.clip(wanted, self._arm.lower, self._arm.upper)
        if (target != wanted).any():  # shorten, so that the direction is kept
            way = wanted - self.set_point
            room, joint = position_factor(self.set_point, way, self._arm.lower, self._arm.upper, 1.0)
            target, shortened_by = self.set_point + room * way, self._kinematics.joint_names[joint]
        self._move = JointTrajectory(self._kinematics, self.set_point, target, self._kinematics.velocity,
                                     self._config.acceleration)
        self._begin_ns = stamp_ns
        return twist, manipulability, shortened_by

    def under_way(self, stamp_ns: int, q: np.ndarray) -> bool:
        """Returns whether a move is not finished, or its joints have not settled at q."""
        if self._move is None:
            return False
        way, speed = self._kinematics.way, inf
        if self._last is not None:
            speed = float(np.abs(way(self._last[1], q)).max()) / (1e-9 * (stamp_ns - self._last[0]))
        self._last = stamp_ns, q
        waited_s = 1e-9 * (stamp_ns - self._begin_ns) - self._move.duration_s
        if waited_s < 0.0:
            return True
        near = float(np.abs(way(self.set_point, q)).max()) < self._config.settle_tolerance
        if (near and speed < self._config.settle_speed) or waited_s > self._config.settle_limit_s:
            self._move = self._last = None
            return False
        return True


@dataclass(eq=False)
class UnderWay(Stage):
    """Gate: takes no look while a move is under way or its joints have not settled."""

    moves: LookThenMove

    def apply(self, tick: Tick) -> Tick:
        return self.moves.followed(tick) if self.moves.under_way(tick.stamp_ns, tick.q) else tick
