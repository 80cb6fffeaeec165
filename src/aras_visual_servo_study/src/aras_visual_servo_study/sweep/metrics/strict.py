"""Metric `strict`: the camera is at the goal as exactly as one could use it, this project's own."""

from .base import Outcome, register_metric

STRICT_MM, STRICT_DEG = 1.0, 0.3


@register_metric("strict", label="strict", threshold=f"below {STRICT_MM:g} mm and {STRICT_DEG:g}°",
                 source="this project")
def strict(outcome: Outcome) -> bool:
    """Less than 1 mm and less than 0.3 degrees are left. Source: this project."""
    return outcome.error_mm < STRICT_MM and outcome.angle_deg < STRICT_DEG
