"""Features of an ellipse: centroid xg, yg and normalised second-order moments n20, n11, n02 (docs/theory.md T28).

For a filled ellipse the matrix of the n_ij has the eigenvalues a^2/4 and b^2/4, a and b being the half axes, along the
axes of the ellipse. The interaction rows are those of moments, so they are exact for an object of any shape.
"""

from . import interaction
from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature
from ..palette import BLUE, BROWN, NAVY, VERMILION, VIOLET


def _centroid_rows(view):
    return interaction.centroid(view.m, view.plane)


@register_feature("xg")
class CentroidX(Feature):
    """x of the centroid (T2, T8) [-]."""

    symbol, label, colour = "x_g", "centroid in x", BLUE
    index = 0

    def value(self, view):
        return (view.features.xg, view.features.yg)[self.index]

    def row(self, view):
        return view.shared(_centroid_rows)[self.index]


@register_feature("yg")
class CentroidY(CentroidX):
    """y of the centroid (T2, T8) [-]."""

    symbol, label, colour = "y_g", "centroid in y", VERMILION
    index = 1


class _SecondOrder(Feature):
    """n_ij = mu_ij / a, L = (L_mu_ij - n_ij L_a) / a (T7, T8) [-]."""

    order, sees_tilt, ij = 3, True, (2, 0)

    def value(self, view):
        area = view.m["00"]
        if not area > 0.0:
            raise DegenerateFeature(f"{self.name}: area is {area}, must be > 0")
        return view.mu["%d%d" % self.ij] / area

    def row(self, view):
        return (view.L_mu(*self.ij) - self.value(view) * view.L_area()) / view.m["00"]


for _ij, _label, _colour in (((2, 0), "variance in x", NAVY), ((1, 1), "covariance of x and y", VIOLET),
                             ((0, 2), "variance in y", BROWN)):
    _name = "n%d%d" % _ij
    register_feature(_name)(type(_name, (_SecondOrder,), {
        "ij": _ij, "__doc__": f"{_name}: {_SecondOrder.__doc__}", "symbol": f"n_{_name[1:]}", "label": _label,
        "colour": _colour}))
