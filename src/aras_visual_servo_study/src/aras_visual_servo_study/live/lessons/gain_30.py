"""Lesson: why not gain 30."""

from typing import Tuple

from aras_visual_servo import FEATURE_NAMES, RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import converged, duration, overshoot


@register_lesson("gain_30")
class Gain30(Lesson):
    """With 30 images a second, gain 30 removes the whole error from one image to the next; the joints cannot."""

    order, title = 20, "Why not gain 30"
    scene = "The gain is 3 per second, and the servo converges in about three seconds."
    question = "If a higher gain is faster, why not take 30? Choose a gain and predict its effect."
    changes = {f"gain {gain:g} per second": {"servo.gains_per_s": dict.fromkeys(FEATURE_NAMES, gain)}
               for gain in (6.0, 15.0, 30.0)}
    changes["gain 30, law paper (for continuous time)"] = {
        "servo.law": "paper", "servo.gains_per_s": dict.fromkeys(FEATURE_NAMES, 30.0)}
    answers = {"faster": "The servo takes a shorter time, and no error overshoots by more than 2 %.",
               "overshoots": "An error overshoots by more than 2 %, but the servo converges.",
               "never": "The servo does not converge."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Looks at the end, the overshoot and the duration of the run."""
        part, name = overshoot(run)
        ended = run.status_text[run.servo_rows[-1]]
        if not converged(run):
            right = "never"
        else:
            right = "overshoots" if part > 0.02 else "faster"
        return right, (f"{name} went {100 * part:.1f} % of its first error beyond zero. The servo took "
                       f"{duration(run):.2f} s, and {duration(first):.2f} s at gain 3. It ended with: {ended}.")
