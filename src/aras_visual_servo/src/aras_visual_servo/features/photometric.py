"""Feature `photometric`: how much the grey levels of the image differ from those of the goal (docs/theory.md T33)."""

from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature
from ..palette import BLUE


@register_feature("photometric")
class Photometric(Feature):
    """Root mean square of I - I* over the image [grey levels]; 0 at the goal. It comes from PhotometricFeatures."""

    sees_tilt, source, overlay = True, "photometric", "photometric"
    unit, symbol, label, colour = "grey", "ΔI", "rms difference of the luminance", BLUE

    def value(self, view):
        if not view.features.has_reference:
            raise DegenerateFeature("photometric: the camera holds no reference image, teach one")
        return view.features.rms

    def row(self, view):
        raise DegenerateFeature("photometric: this feature has no interaction row, allowed with law 'photometric' "
                                "only, for which the camera sums up the matrix over the pixels")
