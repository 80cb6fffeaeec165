"""Metric `vit_vs`: that of ViT-VS, visual servoing on the features of vision transformers."""

from typing import Optional

from .base import Outcome, register_metric

VIT_VS_PART = 0.1
#: A start that is closer than this in position or in angle has no part of it that could be left.
LEAST_MM, LEAST_DEG = 0.1, 0.1


@register_metric("vit_vs", label="ViT-VS",
                 threshold=f"below {100 * VIT_VS_PART:g} % of the initial distance and of the initial angle",
                 source="Scherl et al., ViT-VS, 2025")
def vit_vs(outcome: Outcome) -> Optional[bool]:
    """None for a start that is hardly displaced or hardly turned.

    Source: A. Scherl, S. Thalhammer, B. Neuberger, W. Woeber, J. Garcia-Rodriguez, "ViT-VS: On the applicability of
    pretrained vision transformer features for generalizable visual servoing", 2025.
    """
    if outcome.distance0_mm < LEAST_MM or outcome.angle0_deg < LEAST_DEG:
        return None
    return (outcome.error_mm < VIT_VS_PART * outcome.distance0_mm
            and outcome.angle_deg < VIT_VS_PART * outcome.angle0_deg)
