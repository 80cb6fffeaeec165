"""Source and feature `photometric`: how far the luminance of the image is from that of the reference (T33)."""

from typing import NamedTuple

from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature
from .palette import BLUE
from .source import Source, Taught, register_source


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


@register_feature("photometric")
class Photometric(Feature):
    """Rms of I - I* over the image, 0 at the goal [grey levels]; of PhotometricFeatures, not of moments."""

    sees_tilt, source = True, "photometric"
    unit, symbol, label, colour = "grey", "ΔI", "rms difference of the luminance", BLUE

    def value(self, view):
        if not view.features.has_reference:
            raise DegenerateFeature("photometric: the camera holds no reference image, teach one")
        return view.features.rms

    def row(self, view):
        raise DegenerateFeature("photometric: is for law 'photometric', the camera sums its interaction matrix up")
