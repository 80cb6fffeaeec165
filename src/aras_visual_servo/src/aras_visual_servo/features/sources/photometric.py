"""Source `photometric`: the grey levels of the whole image compared with those of the goal (PhotometricFeatures)."""

from typing import Any, NamedTuple, Sequence

from .base import Source, Taught, register_source


class _SameImage(NamedTuple):
    """The features of an image that is its own reference."""

    has_reference: bool = True
    rms: float = 0.0


@register_source("photometric")
class PhotometricSource(Source):
    """Features that the camera package sums up over the pixels. It also keeps the reference, which is an image."""

    topic, message, section = "camera/photometric", "aras_visual_servo_msgs/PhotometricFeatures", "photometric"
    extractor_class, averages = "PhotometricExtractor", False

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        return Taught(_SameImage())
