"""Lesson: a singularity."""

from typing import Any, Dict, Tuple

import numpy as np

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import duration, fastest_joint, positions

FASTER = 1.3


def bent(elbow_rad: float) -> Dict[str, Any]:
    """Returns the values of a start with an elbow J3 bent by so much [rad], the camera upright."""
    return {"experiment.start": {"joints": {"gantry": -0.1, "J1": 0.0, "J2": elbow_rad + 0.05, "J3": -elbow_rad,
                                            "J5": -0.05, "J6": 0.17}}}


@register_lesson("singularity")
class Singularity(Lesson):
    """A stretched arm cannot move along itself: near there, a small motion of the camera needs fast joints."""

    order, title = 50, "A singularity"
    values = bent(0.3)
    scene = "The servo begins with the elbow J3 bent by 0.3 rad. Look at the joint speeds and at the manipulability."
    question = ("The elbow is nearly straight at the start. The way of the camera is not longer. What do the "
                "joints do?")
    changes = {f"J3 bent by {bend:g} rad": bent(bend) for bend in (0.15, 0.05, 0.02)}
    answers = {"faster": f"The fastest joint is more than {FASTER:g} times as fast.",
               "alike": f"The fastest joint is as fast as before, within a factor of {FASTER:g}.",
               "slower": f"The fastest joint is more than {FASTER:g} times slower."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Compares the fastest joint of both runs."""
        (before, _), (now, name) = fastest_joint(first), fastest_joint(run)
        right = "faster" if now > FASTER * before else "slower" if now * FASTER < before else "alike"
        way = [1e3 * float(np.linalg.norm(positions(one)[-1] - positions(one)[0])) for one in (first, run)]
        return right, (f"The fastest joint, {name}, reached {now:.2f} rad/s, and {before:.2f} rad/s in the first run. "
                       f"The camera went {way[1]:.0f} mm in {duration(run):.1f} s, and {way[0]:.0f} mm in "
                       f"{duration(first):.1f} s in the first run.")
