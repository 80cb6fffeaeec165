"""Feature `photometric`: how far the luminance of the image is from that of the reference (docs/theory.md T33)."""

from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature
from .palette import BLUE


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
