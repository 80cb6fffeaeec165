"""Twist stage: lets the camera rest at the goal, and calms a servo that hunts about it (T62)."""

import numpy as np

from .stage import Stage, Tick
from .stop_rule import CALM_PER_S, StopRule


class Calm(Stage):
    """Rests where there is nothing to correct, and lowers the rates of a servo that stays close without arriving."""

    def __init__(self, rule: StopRule, tilt_gain_per_s: float) -> None:
        """Args: tilt_gain_per_s: return of the optical axis to its taught direction [1/s]."""
        self._rule, self._tilt_gain_per_s = rule, tilt_gain_per_s

    def apply(self, tick: Tick) -> Tick:
        """Returns the tick with a smaller twist and tilt gain where the camera is close to the goal."""
        rule = self._rule
        if not rule.close:
            return tick
        twist, text, resting = tick.twist, tick.text, rule.resting and tick.answer.settled
        if resting:
            twist, text = np.zeros(6), "resting"
        calm = rule.calm(min(tick.answer.gains_per_s, default=CALM_PER_S))
        if calm != 1.0:
            twist = twist * calm
        part = 0.0 if resting or self._tilt_gain_per_s == 0.0 else rule.calm(self._tilt_gain_per_s)
        return tick.set(twist=twist, tilt_part=part, text=text)
