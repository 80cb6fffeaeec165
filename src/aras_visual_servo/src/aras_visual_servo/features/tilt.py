"""Two pairs of features for the tilt of the camera: sx, sy (docs/theory.md T18) and px, py (T19).

With the image parallel to the target neither pair changes as the camera translates, and px, py do not change as it
turns about its axis either. So a tilt shows in them, which the four default features do not tell from a translation.
"""

import numpy as np

from . import interaction
from .interaction import times
from ..ground.errors import DegenerateFeature
from .base import Feature, View, register_each, register_feature
from ..palette import BROWN, MAROON, NAVY, VIOLET


def third_order_vector(view: View) -> complex:
    """S = sx + i sy, complex [-] (T18). Raises DegenerateFeature: the object is empty or isotropic."""
    z1, z2, T, a = _complex_moments(view)
    return z2 * z1.conjugate() / z1 * (a**0.5 / T**1.5)


def third_order_rows(view: View) -> np.ndarray:
    """L of S, (6,) complex, columns [v; w] (T18)."""
    z1, z2, T, a = _complex_moments(view)
    L_z1, L_z2, L_T = view.shared(_complex_rows)
    turn = z1.conjugate() / z1 * (a**0.5 / T**1.5)
    relative = L_z1.conj() / z1.conjugate() - L_z1 / z1 + view.L_area() / (2.0 * a) - 1.5 * L_T / T
    return times(turn, L_z2 + times(z2, relative))


def _complex_moments(view):
    mu = view.mu
    z1 = complex(mu["20"] - mu["02"], 2.0 * mu["11"])
    z2 = complex(mu["03"] - 3.0 * mu["21"], mu["30"] - 3.0 * mu["12"])
    T, a = mu["20"] + mu["02"], view.m["00"]
    if not (T > 0.0 and a > 0.0 and abs(z1) > 0.0):
        raise DegenerateFeature("third-order invariants: the object is empty, or its second-order moments are "
                                "isotropic (a disc, a square), so that it has no orientation")
    return z1, z2, T, a


_ORDERS = ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))


def _complex_rows(view):
    L20, L11, L02, L30, L21, L12, L03 = interaction.centred_moments(view.m, view.mu, _ORDERS, view.plane)
    L_z1 = L20 - L02 + 2.0j * L11
    L_z2 = L03 - 3.0 * L21 + 1.0j * (L30 - 3.0 * L12)
    return L_z1, L_z2, L20 + L02


class _ThirdOrder(Feature):
    order, sees_tilt = 4, True


class _Vector(_ThirdOrder):
    """Real or imaginary part of S (T18) [-]."""

    def value(self, view):
        S = view.shared(third_order_vector)
        return (S.real, S.imag)[self.index]

    def row(self, view):
        L = view.shared(third_order_rows)
        return (L.real, L.imag)[self.index]


register_each(_Vector, (("sx", "s_x", "third-order invariant, real part", NAVY),
                        ("sy", "s_y", "third-order invariant, imaginary part", BROWN)))


@register_feature("px")
class Px(_ThirdOrder):
    """Elongation, squared (T19) [-]. Its row needs moments to order 3, those of the others to order 4."""

    symbol, label, colour = "p_x", "elongation, squared", VIOLET
    order = 3

    def value(self, view: View) -> float:
        z1, _, T, _ = _complex_moments(view)
        return abs(z1) ** 2 / T**2

    def row(self, view: View) -> np.ndarray:
        z1, _, T, _ = _complex_moments(view)
        L20, L11, L02 = interaction.centred_moments(view.m, view.mu, _ORDERS[:3], view.plane)
        L_z1, L_T = L20 - L02 + 2.0j * L11, L20 + L02
        return 2.0 * times(z1.conjugate(), L_z1).real / T**2 - 2.0 * abs(z1) ** 2 / T**3 * L_T


@register_feature("py")
class Py(_ThirdOrder):
    """Asymmetry, squared (T19) [-]. For an object of central symmetry seen parallel it is zero, and so is its row."""

    symbol, label, colour = "p_y", "asymmetry, squared", MAROON

    def value(self, view: View) -> float:
        _, z2, T, a = _complex_moments(view)
        return a * abs(z2) ** 2 / T**3

    def row(self, view: View) -> np.ndarray:
        _, z2, T, a = _complex_moments(view)
        _, L_z2, L_T = view.shared(_complex_rows)
        value = a * abs(z2) ** 2 / T**3
        return 2.0 * a / T**3 * times(z2.conjugate(), L_z2).real + value * (view.L_area() / a - 3.0 * L_T / T)
