"""Stages from the law to the joints: computation of the twist, and of the joint velocities."""

from dataclasses import dataclass
from math import exp, expm1
from typing import Optional

import numpy as np

from ..arm.motion import ArmMotion
from ..features.base import View
from ..ground.types import Reference
from ..laws.base import Law
from ..laws.look import Arm, Look
from .feature_filter import FeatureFilter
from .goal import Goal
from .out_of_reach import OutOfReach
from .stage import Stage, Tick, six_numbers
from .stop_rule import CALM_PER_S, StopRule

#: The correction for creep is no faster than this [m/s; rad/s]: dry friction creeps a fifth of it on the shipped arm.
FASTEST = np.array([0.0003, 0.0003, 0.0003, 0.003, 0.003, 0.003])


@dataclass(eq=False)
class LawStage(Stage):
    """Gives the law one `Look` and takes one `Answer`; nothing else goes between them."""

    law: Law
    goal: Goal
    tracker: Optional[FeatureFilter]
    holds: bool  # a twist is held until the next image

    @property
    def title(self) -> str:
        return f"law '{self.law.name}'"

    def set_reference(self, reference: Reference) -> None:
        self.law.reset(reference)

    def apply(self, tick: Tick) -> Tick:
        law, tracker, features, X_BC = self.law, self.tracker, tick.features, self.goal.kinematics.pose(tick.q)
        plane = self.goal.plane(X_BC) if law.needs_plane or tracker is not None else None
        if tracker is not None:
            features = tracker.at(tick.stamp_ns, X_BC, features, plane).features
        view = View(features, plane)
        X_CgC = self.goal.displacement(X_BC) if law.needs_pose else None
        answer = law.step(Look(view, tick.dt_s if self.holds else 0.0, X_CgC, tick.applied, tracker))
        tick.X_BC, tick.view, tick.answer, tick.twist = X_BC, view, answer, six_numbers(answer.twist)
        return tick

    def rest(self, tick: Tick) -> Tick:
        if self.tracker is not None:
            self.tracker.commanded(tick.stamp_ns, tick.twist)
        return tick


@dataclass(eq=False)
class SmoothStart(Stage):
    """Lets the camera start from rest instead of with a jump of its velocity (T23).

    The twist is given less what is left of the first one, which vanishes at `rate_per_s`.
    """

    rate_per_s: float
    t_s: float = 0.0
    first: Optional[np.ndarray] = None

    def set_reference(self, reference: Reference) -> None:
        self.first, self.t_s = None, 0.0

    def apply(self, tick: Tick) -> Tick:
        if self.first is None:
            self.first = np.array(tick.twist, dtype=float)
        self.t_s += tick.dt_s  # the end of the time for which this twist is held, so that the first one moves already
        tick.twist = tick.twist - exp(-self.rate_per_s * self.t_s) * self.first
        return tick


@dataclass(eq=False)
class Calm(Stage):
    """Rests where there is nothing to correct, and lowers the rates of a servo that hunts about the goal (T62)."""

    rule: StopRule
    tilt_gain_per_s: float

    def apply(self, tick: Tick) -> Tick:
        rule, resting = self.rule, self.rule.resting and tick.answer.settled
        if not rule.close:
            return tick
        if resting:
            tick.set(twist=np.zeros(6), text="resting", held="resting, nothing is left to correct")
        calm = rule.calm(min(tick.answer.gains_per_s, default=CALM_PER_S))
        if calm != 1.0:
            tick.twist = tick.twist * calm
        tick.tilt_part = 0.0 if resting or self.tilt_gain_per_s == 0.0 else rule.calm(self.tilt_gain_per_s)
        return tick


@dataclass(eq=False)
class JointPlace(Stage):
    """Computes the Jacobian at the joint positions, its inverse and the manipulability."""

    arm: ArmMotion

    def apply(self, tick: Tick) -> Tick:
        tick.jacobian, tick.inverse = self.arm.at(tick.q)
        tick.manipulability = tick.inverse.manipulability
        return tick


@dataclass(eq=False)
class Tilt(Stage):
    """Turns the optical axis, whose tilt the features do not see, back to its taught direction by the joint positions.

    The target keeps its place in the image.
    """

    arm: ArmMotion
    gain_per_s: float  # part of the angle to turn per second, > 0

    def apply(self, tick: Tick) -> Tick:
        if tick.tilt_part == 0.0:
            return tick
        gain, features = -expm1(-self.gain_per_s * tick.tilt_part * tick.dt_s) / tick.dt_s, tick.view.features
        target_C = features.xn, features.yn, features.an
        tick.twist = tick.twist + self.arm.tilt(tick.X_BC, tick.inverse, gain, target_C)
        return tick


class CreepCompensation(Stage):
    """Friction compensation: keeps joints that creep against dry friction from holding an error near the goal.

    Such joints creep, and the law only sees an error of creep / lambda that stays. But the joints tell how far the
    camera really moved, beside how far it was told to. The difference is worked off at `creep_rate_per_s` (T62).

    Far from the goal this difference is the delay of the arm, which is not to be corrected, so it counts from near the
    goal on. It is bounded, so that a joint that sticks does not shoot ahead when it comes free.
    """

    def __init__(self, rate_per_s: float, rule: Optional[StopRule] = None) -> None:
        """Args: rate_per_s: of working the difference off, 0: never.  rule: tells where the camera is close."""
        from .._kinematics import between  # C++: not needed to describe the settings of the servo
        self._rate_per_s, self._between, self._rule = rate_per_s, between, rule
        self._most = FASTEST / rate_per_s if rate_per_s > 0.0 else FASTEST
        self._clear()

    def _clear(self):
        """Begins anew with the next image."""
        self._X_BC, self._off, self._twist = None, np.zeros(6), np.zeros(6)

    def apply(self, tick: Tick) -> Tick:
        if not self._rule.close:
            return self.rest(tick)
        tick.twist = tick.twist + self.correction(tick.twist, tick.X_BC, tick.dt_s)
        return tick

    def rest(self, tick: Tick) -> Tick:
        if self._X_BC is not None:
            self._clear()
        return tick

    def correction(self, twist: np.ndarray, X_BC: np.ndarray, dt_s: float) -> np.ndarray:
        """(6,) correction of this image, [v; w] [m/s; rad/s].

        Args: twist: (6,) V_C that is asked for beside the correction, for the next dt_s.  X_BC: (4, 4) by the joints.
        """
        if self._rate_per_s == 0.0:
            return self._twist
        if self._X_BC is not None:
            off = self._off - self._between(self._X_BC, X_BC)
            self._off = np.minimum(np.maximum(off, -self._most), self._most)
            self._twist = self._rate_per_s * self._off
        self._off = self._off + dt_s * twist
        self._X_BC = X_BC
        return self._twist


@dataclass(eq=False)
class JointVelocity(Stage):
    """Turns the twist into joint velocities that the arm may do, and into the twist that they give the camera."""

    arm: ArmMotion
    law: Law
    tracker: Optional[FeatureFilter]
    reach: OutOfReach

    @property
    def title(self) -> str:
        """Returns the name of the last stage for faults: most of them come from the law."""
        return f"law '{self.law.name}'"

    def apply(self, tick: Tick) -> Tick:
        law, asked, twist = self.law, tick.twist, self.reach.left(tick.twist)
        resting = self.reach.held(tick)
        if resting is not None:
            motion = resting
        elif law.moves_joints:
            arm = Arm(**self.arm.as_seen(tick.q, tick.X_BC, twist, tick.jacobian, tick.inverse, tick.dt_s))
            joints = law.joint_velocity(tick.view, arm, twist)
            motion = self.arm.told(joints.q_dot, tick.jacobian, joints.status, joints.text)
        else:
            motion = self.arm.joint_velocity(tick.q, twist, tick.jacobian, tick.inverse, tick.dt_s)
        motion = self.reach.told(asked, twist, motion)
        self.reach.watch(tick, asked, motion)
        if motion.status is not None:
            tick.status, tick.held = motion.status, motion.text
        if self.tracker is not None:
            self.tracker.commanded(tick.stamp_ns, motion.twist)
        tick.q_dot, tick.twist, tick.applied = motion.q_dot, motion.twist, motion.twist
        tick.text, tick.over = motion.text or tick.text, self.reach.over
        return tick

    def rest(self, tick: Tick) -> Tick:
        self.reach.clear()
        return tick
