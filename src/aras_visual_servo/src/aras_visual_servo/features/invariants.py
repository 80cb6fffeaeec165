"""Moment invariants c1 to c10 (docs/theory.md T48), numbered as in ViSP (vpMomentCInvariant).

Each is a quotient N / D. N and D are linear combinations of products of complex moments, C_pq = integral of
z^p conj(z)^q about the centroid with z = x + iy. Only products occur that do not change when the image turns. N and D
have the same degree and order, so that the size of the object cancels.
"""

from math import comb

import numpy as np

from ..ground.errors import DegenerateFeature
from .interaction import times
from .base import Feature, register_each
from ..palette import shade

#: A modulus |C_pq| smaller than this part of a (T/a)^(order/2), which is the object's own scale, counts as zero: it is
#: mostly noise of the image, and the invariant would divide by it.
LEAST = 1e-3

#: For each name: order of the moments, degree of the products, and the coefficients of these products (in the sequence
#: of `_products`) in N and in D.
_INVARIANTS = {
    "c1": (2, 2, (-0.25, 0.25), (0, 1)),
    "c2": (3, 2, (0, 1), (1, 0)),
    "c3": (3, 4, (-3, -6, 1, 8, 0), (9, 6, 1, -16, 0)),
    "c4": (3, 4, (0, 0, 0, 0, 16), (9, 6, 1, -16, 0)),
    "c5": (3, 4, (-9, 10, -1, 0, 0), (9, 6, 1, -16, 0)),
    "c6": (3, 4, (81, -18, 1, 0, 0), (9, 6, 1, -16, 0)),
    "c7": (4, 2, (-9, 8, 1), (3, -4, 1)),
    "c8": (4, 2, (36, 16, -4), (3, -4, 1)),
    "c9": (5, 2, (1, 0, 0), (0, 0, 1)),
    "c10": (5, 2, (0, 1, 0), (0, 0, 1)),
}


def _weights(p, q):
    """C_pq as a weighted sum of the mu_ij: a tuple of (i, j, complex weight)."""
    total = {}
    for k in range(p + 1):
        for n in range(q + 1):
            j = k + n
            total[j] = total.get(j, 0) + comb(p, k) * comb(q, n) * 1j**k * (-1j) ** n
    return tuple((p + q - j, j, weight) for j, weight in total.items() if weight)


#: For each order p + q the C_pq with p >= q, by increasing p. Those with p < q are the conjugates of these.
_COMPLEX = {order: tuple(_weights(p, order - p) for p in range((order + 1) // 2, order + 1)) for order in (2, 3, 4, 5)}


def _moments(view, order):
    """(C_pq, ...) of that order."""
    mu = view.mu
    return [sum(weight * mu[f"{i}{j}"] for i, j, weight in terms) for terms in _COMPLEX[order]]


def _moment_rows(view, order):
    """L of `_moments`, each (6,) complex."""
    return [sum(weight * view.L_mu(i, j) for i, j, weight in terms) for terms in _COMPLEX[order]]


def _products(view, order, degree):
    """The products that N and D combine, (k,).

    Of degree 2 they are |C_pq|^2, in the sequence of `_COMPLEX`. Of degree 4 (and order 3) they are B^2, A B, A^2, and
    the real and imaginary part of C30 conj(C21)^3, with A = |C30|^2 and B = |C21|^2.
    """
    C = view.shared(_moments, order)
    squares = [abs(c) ** 2 for c in C]
    if degree == 2:
        return np.array(squares)
    (C21, C30), (B, A) = C, squares
    third = C30 * C21.conjugate() ** 3
    return np.array([B * B, A * B, A * A, third.real, third.imag])


def _product_rows(view, order, degree):
    """L of `_products`, (k, 6)."""
    C, L = view.shared(_moments, order), view.shared(_moment_rows, order)
    squares = [2.0 * times(c.conjugate(), row).real for c, row in zip(C, L)]
    if degree == 2:
        return np.array(squares)
    (C21, C30), (L21, L30), (L_B, L_A) = C, L, squares
    A, B, c = abs(C30) ** 2, abs(C21) ** 2, C21.conjugate()
    L_third = times(c**3, L30) + times(3.0 * C30 * c**2, L21.conj())
    return np.array([2.0 * B * L_B, A * L_B + B * L_A, 2.0 * A * L_A, L_third.real, L_third.imag])


class _Invariant(Feature):
    """N / D of complex moments (T48) [-]. The value needs moments to `moment_order`, the row to one order more."""

    sees_tilt = True
    moment_order, degree, numerator, denominator = 2, 2, (), ()

    def _fraction(self, view):
        """N and D. Raises DegenerateFeature where D is zero, or so small that noise decides."""
        products = view.shared(_products, self.moment_order, self.degree)
        N, D = float(np.dot(self.numerator, products)), float(np.dot(self.denominator, products))
        area, T = view.m["00"], view.mu["20"] + view.mu["02"]
        if not (area > 0.0 and T > 0.0):
            raise DegenerateFeature(f"{self.name}: found area {area} and mu20 + mu02 {T}, both must be > 0")
        size = area * (T / area) ** (0.5 * self.moment_order)
        if not D > (LEAST * size) ** self.degree:
            raise DegenerateFeature(
                f"{self.name}: 0/0, the denominator (order {self.moment_order}) vanishes for this shape in this view: "
                f"found {max(D, 0.0) ** (1.0 / self.degree) / size:.1e} of the object's size, must be > {LEAST:g}")
        return N, D

    def value(self, view):
        N, D = self._fraction(view)
        return N / D

    def row(self, view):
        N, D = self._fraction(view)
        rows = view.shared(_product_rows, self.moment_order, self.degree)
        return (np.dot(self.numerator, rows) - N / D * np.dot(self.denominator, rows)) / D


for _name, (_order, _degree, _numerator, _denominator) in _INVARIANTS.items():
    _number = int(_name[1:])
    register_each(_Invariant, [(_name, f"c_{_number}", f"moment invariant {_number}", shade((0.0, 360.0), _number))],
                  order=_order + 1, moment_order=_order, degree=_degree, numerator=_numerator, denominator=_denominator)
