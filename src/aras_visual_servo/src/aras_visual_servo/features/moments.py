"""Features of the target's moments: the default xn, yn, an, alpha (docs/theory.md T3, T4), which are position, depth
and orientation; and those of an ellipse (T28), centroid xg, yg and normalised second-order moments n20, n11, n02.

For a filled ellipse the matrix of the n_ij has the eigenvalues a^2/4 and b^2/4, a and b being the half axes, along the
axes of the ellipse. The interaction rows are those of moments, so they are exact for an object of any shape.
"""

import numpy as np

from . import interaction
from ..ground.errors import DegenerateFeature
from .base import Feature, View, register_each, register_feature
from ..palette import BLUE, BROWN, GREEN, NAVY, PURPLE, VERMILION, VIOLET


class _Normalised(Feature):
    """xn, yn, an: the centroid times an, and the depth of the target as its area tells it (T4, T9) [m]."""

    also_from = ("detections",)

    def value(self, view):
        return getattr(view.features, self.name)

    def row(self, view):
        return view.L_normalised()[self.index]


register_each(_Normalised, (("xn", "x_n", "centroid in x, at the depth of the target", BLUE),
                            ("yn", "y_n", "centroid in y, at the depth of the target", VERMILION),
                            ("an", "a_n", "depth of the target, by its area", GREEN)), unit="m")


@register_feature("alpha")
class Alpha(Feature):
    """Orientation (T3, T10) [rad]."""

    order, angle = 3, True
    unit, symbol, label, colour = "rad", "α", "orientation of the target in the image", PURPLE

    def value(self, view: View) -> float:
        return view.features.alpha

    def row(self, view: View) -> np.ndarray:
        return interaction.orientation(view.m, view.mu, view.plane)


class _Centroid(Feature):
    """x or y of the centroid (T2, T8) [-]."""

    also_from = ("detections",)

    def value(self, view):
        return getattr(view.features, self.name)

    def row(self, view):
        return view.L_centroid()[self.index]


register_each(_Centroid, (("xg", "x_g", "centroid in x", BLUE), ("yg", "y_g", "centroid in y", VERMILION)))


class _SecondOrder(Feature):
    """n_ij = mu_ij / a, L = (L_mu_ij - n_ij L_a) / a (T7, T8) [-]."""

    order, sees_tilt = 3, True

    def value(self, view):
        area = view.m["00"]
        if not area > 0.0:
            raise DegenerateFeature(f"{self.name}: area is {area}, must be > 0")
        return view.mu[self.name[1:]] / area

    def row(self, view):
        i, j = 2 - self.index, self.index
        return (view.L_mu(i, j) - self.value(view) * view.L_area()) / view.m["00"]


register_each(_SecondOrder, (("n20", "n_20", "variance in x", NAVY), ("n11", "n_11", "covariance of x and y", VIOLET),
                             ("n02", "n_02", "variance in y", BROWN)))
