"""Twist stage: holds the optical axis at its taught direction, which the features do not see."""

from math import expm1

from ..arm.motion import ArmMotion
from .stage import Stage, Tick


class Tilt(Stage):
    """Turns the optical axis back by the joint positions; the target keeps its place in the image."""

    def __init__(self, arm: ArmMotion, gain_per_s: float) -> None:
        """Args: gain_per_s: part of the angle to turn per second, > 0 [1/s]."""
        self._arm, self._gain_per_s = arm, gain_per_s

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with the turn added to the twist."""
        if tick.tilt_part == 0.0:
            return tick
        gain, features = -expm1(-self._gain_per_s * tick.tilt_part * tick.dt_s) / tick.dt_s, tick.view.features
        target_C = features.xn, features.yn, features.an
        tick.twist = tick.twist + self._arm.tilt(tick.X_BC, tick.inverse, gain, target_C)
        return tick
