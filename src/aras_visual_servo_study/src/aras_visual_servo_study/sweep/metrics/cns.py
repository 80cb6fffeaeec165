"""Metric `cns`: that of the graph-network servo CNS."""

from typing import Optional

from .base import Outcome, register_metric

CNS_PART, CNS_DEG = 0.1, 10.0


@register_metric("cns", label="CNS",
                 threshold=f"below {100 * CNS_PART:g} % of the goal's distance from the origin and below {CNS_DEG:g}°",
                 source="Chen et al., CNS, ICRA 2024")
def cns(outcome: Outcome) -> Optional[bool]:
    """How far away the camera began does not matter; None without a target.

    Source: A. Chen, H. Yu, Y. Wang, R. Xiong, "CNS: Correspondence encoded neural image servo policy", ICRA 2024.
    """
    if outcome.goal_distance_mm is None:
        return None
    return outcome.error_mm < CNS_PART * outcome.goal_distance_mm and outcome.angle_deg < CNS_DEG
