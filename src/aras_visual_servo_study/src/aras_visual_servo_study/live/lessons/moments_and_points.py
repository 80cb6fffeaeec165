"""Lesson: moments against points."""

from typing import Any, Dict, Tuple

from aras_visual_servo import RunRecord
from ..lesson import Lesson, register_lesson
from ..lesson_measures import converged, detour, duration

START = {"gantry": -0.01, "J1": 0.0, "J2": -0.38, "J3": 0.8, "J4": 0.15, "J5": -0.28}
POINTS: Dict[str, Any] = {
    "vision.points": "corners", "vision.point_count": 4, "servo.point_depth": "plane",
    "servo.features": ["points4"], "servo.gains_per_s": {"points4": 2.0}, "servo.thresholds": {"points4": 0.0005}}

MOMENTS: Dict[str, Any] = {
    "vision.points": None, "vision.point_count": None, "servo.point_depth": None,
    "servo.features": ["xn", "yn", "an", "sx", "sy", "alpha"],
    "servo.gains_per_s": dict.fromkeys(("xn", "yn", "an", "sx", "sy", "alpha"), 2.0),
    "servo.thresholds": {"xn": 2e-4, "yn": 2e-4, "an": 2e-4, "sx": 1e-3, "sy": 1e-3, "alpha": 1e-3}}


def turned(angle_rad: float) -> Dict[str, Any]:
    """Returns the values of a start beside the goal, turned about the optical axis [rad]."""
    return {"experiment.start": {"joints": {**START, "J6": angle_rad}}}


@register_lesson("moments_and_points")
class MomentsAndPoints(Lesson):
    """Normalised moments are nearly decoupled, so that the camera's path is nearly straight; points are not."""

    order, title, scenario = 80, "Moments against points", "six_dof_rectangle"
    values = {**POINTS, **turned(1.0), "servo.interaction": "current"}
    scene = ("The goal is 8 cm away and turned by 1 rad. The features are the four corners of the rectangle. Look at "
             "the path of the camera in the view.")
    question = "Choose a change. How long is the camera's path then, as a multiple of the straight distance?"
    changes = {"moments xn, yn, an, sx, sy, alpha": MOMENTS,
               "points, turned by 0.2 rad": turned(0.2),
               "points, mean of the matrices here and at the goal": {"servo.interaction": "mean"}}
    answers = {"straight": "Nearly straight, less than 1.5 times.", "bent": "1.5 to 3 times.",
               "loop": "More than 3 times."}

    def finding(self, first: RunRecord, run: RunRecord) -> Tuple[str, str]:
        """Compares the lengths of the paths."""
        before, now = detour(first), detour(run)
        right = "straight" if now < 1.5 else "bent" if now < 3.0 else "loop"
        return right, (f"The camera's path was {now:.2f} times the straight distance, and {before:.2f} times in the "
                       f"first run. It took {duration(run):.1f} s, and {duration(first):.1f} s. "
                       f"{'It arrived.' if converged(run) else 'It did not arrive.'}")
