"""Lesson: a depth that is wrong by a factor of two."""

from typing import Tuple

import numpy as np

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import converged, decay_rate, positions


@register_lesson("wrong_depth")
class WrongDepth(Lesson):
    """The features xn, yn and an are proportional to the depth Z* that was told, so it acts as a factor of the gain."""

    order, title = 60, "Depth wrong by two"
    scene = "The law gets the depth of the target at the goal, 0.59 m. The gain is 3 per second."
    question = "One image does not show the depth. The law gets a wrong depth. How does the servo change?"
    changes = {"told half the depth, 0.295 m": {"experiment.z_star_m": 0.295},
               "told twice the depth, 1.18 m": {"experiment.z_star_m": 1.18}}
    answers = {"elsewhere": "The camera comes to rest more than 1 mm beside the goal.",
               "rate": "It arrives, and the error falls at another rate.",
               "nothing": "It arrives, and the error falls at the same rate within 10 %.",
               "never": "It does not converge."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Compares rate and place of arrival."""
        before, now = decay_rate(first, "an"), decay_rate(run, "an")
        beside_mm = 1e3 * float(np.linalg.norm(positions(run)[-1] - run.taught_pose[:3, 3]))
        right = "never" if not converged(run) else "elsewhere" if beside_mm > 1.0 else \
            "rate" if abs(now / before - 1.0) > 0.1 else "nothing"
        return right, (f"The camera came to rest {beside_mm:.2f} mm beside the goal. The error of an fell by {now:.2f} "
                       f"per second, and by {before:.2f} per second with the true depth: {now / before:.2f} times as "
                       "fast. The goal is an image, so the depth does not move it.")
