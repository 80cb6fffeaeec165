"""Metric `success`: the camera came home, this project's own. It decides the outcome of a run."""

from .base import Outcome, register_metric
from .strict import STRICT_MM

SUCCESS_PART, SUCCESS_DEG = 0.1, 10.0


@register_metric("success", label="success",
                 threshold=f"below {100 * SUCCESS_PART:g} % of the initial distance, or {STRICT_MM:g} mm, and below "
                           f"{SUCCESS_DEG:g}°",
                 source="this project")
def success(outcome: Outcome) -> bool:
    """Less than 10 % of the initial distance is left, or less than 1 mm, and less than 10 degrees.

    The millimetre is for starts that are only turned and have no distance. Source: this project; the published metrics
    it resembles are `cns` and `vit_vs`.
    """
    near_mm = max(SUCCESS_PART * outcome.distance0_mm, STRICT_MM)
    return outcome.error_mm < near_mm and outcome.angle_deg < SUCCESS_DEG
