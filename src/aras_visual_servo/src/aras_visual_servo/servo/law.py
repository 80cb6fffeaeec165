"""Twist stages: the control law, and the smooth start after it."""

from math import exp
from typing import Optional

import numpy as np

from ..features.base import View
from ..ground.types import Reference
from ..laws.base import Law
from ..laws.look import Look
from .feature_filter import FeatureFilter
from .goal import Goal
from .stage import Stage, Tick, six_numbers


class LawStage(Stage):
    """Gives the law one `Look` and takes one `Answer`; nothing else goes between them."""

    def __init__(self, law: Law, goal: Goal, tracker: Optional[FeatureFilter], holds: bool) -> None:
        """Args: tracker: filters the features, or None.  holds: a twist is held until the next image."""
        self.law = law
        self._goal, self._tracker, self._holds = goal, tracker, holds

    @property
    def title(self) -> str:
        """What a fault calls the law."""
        return f"law '{self.law.name}'"

    def set_reference(self, reference: Reference) -> None:
        """Makes the law forget the past and servo to `reference`."""
        self.law.reset(reference)

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the answer of the law and its twist."""
        law, tracker, features, X_BC = self.law, self._tracker, tick.features, self._goal.kinematics.pose(tick.q)
        plane = self._goal.plane(X_BC) if law.needs_plane or tracker is not None else None
        if tracker is not None:
            features = tracker.at(tick.stamp_ns, X_BC, features, plane).features
        view = View(features, plane)
        X_CgC = self._goal.displacement(X_BC) if law.needs_pose else None
        answer = law.step(Look(view, tick.dt_s if self._holds else 0.0, X_CgC, tick.applied, tracker))
        tick.X_BC, tick.view, tick.answer, tick.twist = X_BC, view, answer, six_numbers(answer.twist)
        return tick

    def rest(self, tick: Tick) -> Tick:
        """Tells the filter that the camera stands still."""
        if self._tracker is not None:
            self._tracker.commanded(tick.stamp_ns, tick.twist)
        return tick


class SmoothStart(Stage):
    """Lets the camera start from rest instead of with a jump of its velocity (T23).

    The twist is given less what is left of the first one, which vanishes at `rate_per_s`.
    """

    def __init__(self, rate_per_s: float) -> None:
        """Args: rate_per_s: > 0 [1/s]."""
        self._rate_per_s, self._t_s = rate_per_s, 0.0
        self._first: Optional[np.ndarray] = None

    def set_reference(self, reference: Reference) -> None:
        """Starts from rest again."""
        self._first, self._t_s = None, 0.0

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the twist less what is left of the first one."""
        if self._first is None:
            self._first = np.array(tick.twist, dtype=float)
        self._t_s += tick.dt_s  # the end of the time for which this twist is held, so that the first one moves already
        tick.twist = tick.twist - exp(-self._rate_per_s * self._t_s) * self._first
        return tick
