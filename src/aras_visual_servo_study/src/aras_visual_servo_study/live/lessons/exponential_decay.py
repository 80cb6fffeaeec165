"""Lesson: the error of each feature decays exponentially."""

from typing import Tuple

from aras_visual_servo import FEATURE_NAMES, RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import decay_rate, duration


@register_lesson("exponential_decay")
class ExponentialDecay(Lesson):
    """The law asks for de/dt = -gain e, so e(t) = e(0) exp(-gain t): a straight line on a logarithmic axis."""

    order, title = 10, "Exponential decay"
    values = {"servo.gains_per_s": dict.fromkeys(FEATURE_NAMES, 2.0)}
    scene = ("The gain is 2 per second. Look at the curve of the errors: on its logarithmic axis each error is a "
             "straight line.")
    question = ("Choose another gain. How does the time change in which an error falls to a tenth?")
    changes = {f"gain {gain:g} per second": {"servo.gains_per_s": dict.fromkeys(FEATURE_NAMES, gain)}
               for gain in (0.5, 1.0, 4.0, 6.0)}
    answers = {"inverse": "The old time is divided by new gain / old gain.",
               "same": "The time stays the same: a higher gain only moves the camera farther.",
               "square": "The old time is divided by (new gain / old gain)²."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Compares the measured rates with the ratio of the gains."""
        before, now = decay_rate(first, "yn"), decay_rate(run, "yn")
        gains = [one.settings["servo"]["gains_per_s"]["yn"] for one in (first, run)]
        ratio, asked = now / before, gains[1] / gains[0]
        right = min(("inverse", asked), ("same", 1.0), ("square", asked**2), key=lambda way: abs(ratio / way[1] - 1.0))
        return right[0], (f"The error of yn fell by {before:.2f} per second at gain {gains[0]:g}, and by {now:.2f} per "
                          f"second at gain {gains[1]:g}: {ratio:.2f} times as fast. To a tenth it took "
                          f"{2.303 / before:.2f} s and {2.303 / now:.2f} s. The whole servo took "
                          f"{duration(first):.1f} s and {duration(run):.1f} s.")
