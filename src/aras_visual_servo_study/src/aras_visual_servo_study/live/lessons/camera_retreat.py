"""Lesson: camera retreat and the half turn (Chaumette 1998)."""

import math
from typing import Any, Dict, Tuple

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import converged, retreat

GOAL = {"gantry": 0.05, "J1": 0.0, "J2": -0.5, "J3": 0.9, "J4": 0.0, "J5": -0.4}


def turned(degrees: float, interaction: str = "current") -> Dict[str, Any]:
    """Returns the values of a start that is the goal, turned about the optical axis [degrees]."""
    return {"experiment.start": {"joints": {**GOAL, "J6": math.radians(degrees)}}, "servo.interaction": interaction}


@register_lesson("camera_retreat")
class CameraRetreat(Lesson):
    """Straight lines of the points in the image need a camera that goes away; at a half turn they meet in one point."""

    order, title, scenario = 40, "Camera retreat and the half turn", "six_dof_points"
    values = turned(15)
    scene = ("The camera only has to turn by 15 degrees about its own axis. The law draws the four corners along "
             "straight lines to their places in the image.")
    question = "The turn becomes larger, or the law takes another interaction matrix. Where does the camera go?"
    changes = {"turn by 60 deg": turned(60), "turn by 150 deg": turned(150),
               "turn by 60 deg, matrix of the goal": turned(60, "desired"),
               "turn by 60 deg, mean of both matrices": turned(60, "mean")}
    answers = {"stays": "It stays within 1 cm of its height.",
               "away": "It goes away from the target by more than 1 cm, and comes back.",
               "nearer": "It comes nearer to the target by more than 1 cm, and goes back.",
               "never": "It goes away and never comes back."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Looks at the way along the optical axis, and at the end."""
        away, nearer = retreat(run)
        right = "never" if not converged(run) and away > 0.01 else \
            "stays" if max(away, nearer) < 0.01 else "away" if away > nearer else "nearer"
        return right, (f"The camera went away by {1e3 * away:.0f} mm and nearer by {1e3 * nearer:.0f} mm, and in the "
                       f"first run away by {1e3 * retreat(first)[0]:.0f} mm. "
                       f"{'It arrived.' if converged(run) else 'It did not arrive.'}")
