"""This project's own metrics. `success`, the camera came home, decides the outcome of a run; `strict`: exactly."""

from .base import Outcome, register_metric

STRICT_MM, STRICT_DEG = 1.0, 0.3
SUCCESS_PART, SUCCESS_DEG = 0.1, 10.0


@register_metric("success", label="success",
                 threshold=f"below {100 * SUCCESS_PART:g} % of the initial distance, or {STRICT_MM:g} mm, and below "
                           f"{SUCCESS_DEG:g}°",
                 source="this project")
def success(outcome: Outcome) -> bool:
    """The millimetre is for starts that are only turned. Source: this project; it resembles `cns` and `vit_vs`."""
    near_mm = max(SUCCESS_PART * outcome.distance0_mm, STRICT_MM)
    return outcome.error_mm < near_mm and outcome.angle_deg < SUCCESS_DEG


@register_metric("strict", label="strict", threshold=f"below {STRICT_MM:g} mm and {STRICT_DEG:g}°",
                 source="this project")
def strict(outcome: Outcome) -> bool:
    """The camera is at the goal as exactly as one could use it. Source: this project."""
    return outcome.error_mm < STRICT_MM and outcome.angle_deg < STRICT_DEG
