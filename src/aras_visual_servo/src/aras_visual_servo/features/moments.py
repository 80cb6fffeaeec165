"""The default features xn, yn, an, alpha: position, depth and orientation of the target (docs/theory.md T3, T4)."""

from . import interaction
from .base import Feature, register_feature
from ..palette import BLUE, GREEN, PURPLE, VERMILION


@register_feature("xn")
class NormalisedX(Feature):
    """x of the centroid times an (T4, T9) [m]."""

    unit, symbol, label, colour = "m", "x_n", "centroid in x, at the depth of the target", BLUE
    index = 0

    def value(self, view):
        return getattr(view.features, self.name)

    def row(self, view):
        return view.L_normalised()[self.index]


@register_feature("yn")
class NormalisedY(NormalisedX):
    """y of the centroid times an (T4, T9) [m]."""

    symbol, label, colour = "y_n", "centroid in y, at the depth of the target", VERMILION
    index = 1


@register_feature("an")
class NormalisedArea(NormalisedX):
    """Depth of the target as its area tells it (T4, T9) [m]."""

    symbol, label, colour = "a_n", "depth of the target, by its area", GREEN
    index = 2


@register_feature("alpha")
class Alpha(Feature):
    """Orientation (T3, T10) [rad]."""

    order, angle = 3, True
    unit, symbol, label, colour = "rad", "α", "orientation of the target in the image", PURPLE

    def value(self, view):
        return view.features.alpha

    def row(self, view):
        return interaction.orientation(view.m, view.mu, view.plane)
