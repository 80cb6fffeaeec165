"""Source `photometric`: the luminance of the whole image against that of the reference (PhotometricFeatures)."""

from typing import NamedTuple

from .base import Source, Taught, register_source


class _SameImage(NamedTuple):
    """What an image is to itself."""

    has_reference: bool = True
    rms: float = 0.0


@register_source("photometric")
class PhotometricSource(Source):
    """The reference is an image, and the camera's: nothing of it is kept here."""

    topic, message, section = "camera/photometric", "aras_visual_servo_msgs/PhotometricFeatures", "photometric"

    def extractor(self, camera_info, vision):
        from aras_visual_servo_camera import PhotometricExtractor  # C++: not needed to import this
        return PhotometricExtractor(camera_info, vision[self.section])

    def why_lost(self, features):
        if features.target_visible and features.valid:
            return ""
        return features.fault or super().why_lost(features)

    def taught(self, features, z_star_m, normal_C):
        return Taught(_SameImage())
