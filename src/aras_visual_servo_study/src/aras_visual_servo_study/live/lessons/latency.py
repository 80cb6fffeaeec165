"""Lesson: latency."""

from typing import Tuple

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import converged, duration, overshoot


@register_lesson("latency")
class Latency(Lesson):
    """With de/dt = -gain e(t - delay) an error overshoots from gain * delay = 1/e on, and grows from pi/2 on."""

    order, title = 30, "Latency"
    values = {"servo.input_timeout_s": 2.0}
    scene = "The gain is 3 per second. Each image arrives without delay."
    question = ("Each image now reaches the law later. By de/dt = -3 e(t - delay), the limits are at "
                "3 delay = 1/e = 0.37 and at 3 delay = π/2 = 1.57. How does the servo end?")
    changes = {f"delay {delay:g} s": {"sim.cameras.0.latency_s": delay} for delay in (0.1, 0.2, 0.3, 0.5)}
    answers = {"smooth": "It converges without an overshoot of more than 2 %.",
               "overshoots": "An error overshoots by more than 2 %, then it converges.",
               "never": "It does not converge within 20 seconds."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Looks at the end and the overshoot of the run."""
        part, name = overshoot(run)
        delay = run.settings["sim"]["cameras"][0]["latency_s"]
        right = ("overshoots" if part > 0.02 else "smooth") if converged(run) else "never"
        return right, (f"With a delay of {delay:g} s, 3 delay is {3 * delay:.2f}. {name} went {100 * part:.0f} % of "
                       f"its first error beyond zero. The servo took {duration(run):.1f} s, without delay "
                       f"{duration(first):.1f} s.")
