"""Source `photometric`: the grey levels of the whole image compared with those of the goal (PhotometricFeatures)."""

from typing import NamedTuple

from .base import Source, Taught, register_source


class _SameImage(NamedTuple):
    """The features of an image that is its own reference."""

    has_reference: bool = True
    rms: float = 0.0


@register_source("photometric")
class PhotometricSource(Source):
    """Features that the camera package sums up over the pixels. It also keeps the reference, which is an image."""

    topic, message, section = "camera/photometric", "aras_visual_servo_msgs/PhotometricFeatures", "photometric"

    def extractor(self, camera_info, vision):
        from aras_visual_servo_camera import PhotometricExtractor  # here: this module can be imported without C++
        return PhotometricExtractor(camera_info, vision[self.section])

    def why_lost(self, features):
        if features.target_visible and features.valid:
            return ""
        return features.fault or super().why_lost(features)

    def taught(self, features, z_star_m, normal_C):
        return Taught(_SameImage())
