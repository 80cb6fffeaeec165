"""Lesson: noise and averaging."""

import math
from typing import Tuple

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import held_noise

AVERAGED = (2, 4, 16)


@register_lesson("noise")
class Noise(Lesson):
    """The mean of N independent images has 1/sqrt(N) of the standard deviation of one."""

    order, title = 70, "Noise and averaging"
    values = {"sim.cameras.0.noise_stddev": 5.0, "servo.hold_s": 10.0, "servo.time_limit_s": 11.0}
    scene = ("The grey values of each image have noise of 5 grey levels. The arm holds at the goal, and the errors "
             "fluctuate.")
    question = ("The noise becomes stronger. How many images must be averaged to be as certain as one image of the "
                "first run?")
    changes = {f"{level:g} grey levels, {level / 5:g} times as much": {"sim.cameras.0.noise_stddev": level}
               for level in (7.0, 10.0, 20.0)}
    answers = {str(count): f"The mean of {count} images is enough." for count in AVERAGED}
    answers["more"] = "None of these is enough."

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Compares the standard deviation of means with that of one image of the first run; 15 % is its own noise."""
        one, now = held_noise(first, "alpha"), held_noise(run, "alpha")
        means = {count: held_noise(run, "alpha", count) for count in AVERAGED}
        right = next((str(count) for count, found in means.items() if found <= 1.15 * one), "more")
        listed = ", ".join(f"{math.degrees(found):.4f} deg for {count}" for count, found in means.items())
        return right, (f"One image gave the angle alpha to {math.degrees(one):.4f} deg (standard deviation) in the "
                       f"first run, and to {math.degrees(now):.4f} deg now. Means of several: {listed}.")
