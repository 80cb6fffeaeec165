"""Image features by name: what a law servos on, and how it moves with the camera.

    features = FeatureSet(("xn", "yn", "an", "sx", "sy", "alpha"))
    s = features.values(View(moment_features))                  # (k,)
    L = features.matrix(View(moment_features, plane))           # (k, 6), s_dot = L V_C

A new feature is a subclass with a name, a value and a row, both of a `View`:

    @register_feature("elongation")
    class Elongation(Feature):
        order, sees_tilt = 3, True
        def value(self, view): ...
        def row(self, view): ...

What an image measures comes from `MomentFeatures` (raw and centred moments by name "ij"); the plane of the target is
(A, B, C) of 1/Z = A x + B y + C in the camera frame (docs/theory.md T5).
"""

import numpy as np

from . import interaction
from .errors import DegenerateFeature, ParameterError
from .types import FEATURE_NAMES

_FEATURES = {}


def register_feature(name):
    """Class decorator: make a feature known by name."""

    def add(feature):
        feature.name = name
        _FEATURES[name] = feature
        return feature

    return add


def known_features():
    """Names of the registered features, sorted."""
    return sorted(_FEATURES)


def _area_row(view):
    """L of a = m00 (T8)."""
    return interaction.area(view.m, view.plane)


def _mu_row(view, i, j):
    """L of mu_ij (T7)."""
    return interaction.centred_moment(view.m, view.mu, i, j, view.plane)


def _normalised_rows(view):
    """L of (xn, yn, an) (T9)."""
    return interaction.normalised(view.m, view.plane, view.features.z_star_m, view.features.area_star)


class View:
    """One view of the target; what several features share is worked out once.

    Attributes:
        features: `Features`, or any object with its attributes.
        plane: (A, B, C) of the target in the camera frame [1/m], None when only values are asked for.
        displacement: (6,) of the camera from the goal, p_CgC and theta u of R_CgC; None: at the goal.
    """

    __slots__ = ("features", "plane", "displacement", "_m", "_mu", "_known")

    def __init__(self, features, plane=None, displacement=None):
        self.features, self.plane, self.displacement = features, plane, displacement
        self._m = self._mu = None
        self._known = {}

    @property
    def m(self):
        """Raw moments by name "ij"."""
        if self._m is None:
            self._m = dict(zip(self.features.moment_names, self.features.m))
        return self._m

    @property
    def mu(self):
        """Centred moments by name "ij"."""
        if self._mu is None:
            self._mu = dict(zip(self.features.moment_names, self.features.mu))
        return self._mu

    def shared(self, make, *arguments):
        """make(view, *arguments), computed once per view."""
        key = (make, arguments)
        if key not in self._known:
            self._known[key] = make(self, *arguments)
        return self._known[key]

    def L_area(self):
        """L of a = m00, (6,)."""
        return self.shared(_area_row)

    def L_mu(self, i, j):
        """L of mu_ij, (6,)."""
        return self.shared(_mu_row, i, j)

    def L_normalised(self):
        """L of (xn, yn, an), (3, 6)."""
        return self.shared(_normalised_rows)


class Feature:
    """One feature.

    Attributes: name.  order: of the moments that value and row need.  angle: it is one, known modulo 2 pi (modulo pi
    for a symmetric object).  sees_tilt: it tells a tilt of the camera from a translation.
    """

    name, order, angle, sees_tilt = "", 2, False, False

    def value(self, view):
        """The feature in this view."""
        raise NotImplementedError

    def row(self, view):
        """Its interaction row, (6,), [v; w]; needs view.plane."""
        raise NotImplementedError


class _Normalised(Feature):
    index = 0

    def value(self, view):
        return getattr(view.features, self.name)

    def row(self, view):
        return view.L_normalised()[self.index]


for _index, _name in enumerate(FEATURE_NAMES[:3]):
    register_feature(_name)(type(_name, (_Normalised,), {"index": _index, "__doc__": f"{_name} (T4, T9) [m]."}))


@register_feature("alpha")
class Alpha(Feature):
    """Orientation (T3, T10) [rad]."""

    order, angle = 3, True

    def value(self, view):
        return view.features.alpha

    def row(self, view):
        return interaction.orientation(view.m, view.mu, view.plane)


# --- two invariants each of the motions in the image plane: what is left of them tells tilt (T18, T19) ----------------


def third_order_vector(view):
    """S = sx + i sy (T18). Raises DegenerateFeature for an isotropic object."""
    z1, z2, T, a = _complex_moments(view)
    return z2 * z1.conjugate() / z1 * (a**0.5 / T**1.5)


def third_order_rows(view):
    """L of S, (6,) complex (T18)."""
    z1, z2, T, a = _complex_moments(view)
    L_z1, L_z2, L_T = view.shared(_complex_rows)
    turn = z1.conjugate() / z1 * (a**0.5 / T**1.5)
    relative = L_z1.conj() / z1.conjugate() - L_z1 / z1 + view.L_area() / (2.0 * a) - 1.5 * L_T / T
    return turn * (L_z2 + z2 * relative)


def _complex_moments(view):
    mu = view.mu
    z1 = complex(mu["20"] - mu["02"], 2.0 * mu["11"])
    z2 = complex(mu["03"] - 3.0 * mu["21"], mu["30"] - 3.0 * mu["12"])
    T, a = mu["20"] + mu["02"], view.m["00"]
    if not (T > 0.0 and a > 0.0 and abs(z1) > 0.0):
        raise DegenerateFeature("third-order invariants: the object is empty or its second-order moments isotropic")
    return z1, z2, T, a


def _complex_rows(view):
    L = view.L_mu
    L_z1 = L(2, 0) - L(0, 2) + 2.0j * L(1, 1)
    L_z2 = L(0, 3) - 3.0 * L(2, 1) + 1.0j * (L(3, 0) - 3.0 * L(1, 2))
    return L_z1, L_z2, L(2, 0) + L(0, 2)


class _ThirdOrder(Feature):
    order, sees_tilt = 4, True


@register_feature("sx")
class Sx(_ThirdOrder):
    """Real part of S (T18) [-]."""

    def value(self, view):
        return view.shared(third_order_vector).real

    def row(self, view):
        return view.shared(third_order_rows).real


@register_feature("sy")
class Sy(_ThirdOrder):
    """Imaginary part of S (T18) [-]."""

    def value(self, view):
        return view.shared(third_order_vector).imag

    def row(self, view):
        return view.shared(third_order_rows).imag


@register_feature("px")
class Px(_ThirdOrder):
    """Elongation, squared (T19) [-]. Its row needs moments to order 3 only."""

    order = 3

    def value(self, view):
        z1, _, T, _ = _complex_moments(view)
        return abs(z1) ** 2 / T**2

    def row(self, view):
        z1, _, T, _ = _complex_moments(view)
        L = view.L_mu
        L_z1, L_T = L(2, 0) - L(0, 2) + 2.0j * L(1, 1), L(2, 0) + L(0, 2)
        return 2.0 * (z1.conjugate() * L_z1).real / T**2 - 2.0 * abs(z1) ** 2 / T**3 * L_T


@register_feature("py")
class Py(_ThirdOrder):
    """Asymmetry, squared (T19) [-]; without a derivative, and of no use, for an object of central symmetry."""

    def value(self, view):
        _, z2, T, a = _complex_moments(view)
        return a * abs(z2) ** 2 / T**3

    def row(self, view):
        _, z2, T, a = _complex_moments(view)
        _, L_z2, L_T = view.shared(_complex_rows)
        value = a * abs(z2) ** 2 / T**3
        return 2.0 * a / T**3 * (z2.conjugate() * L_z2).real + value * (view.L_area() / a - 3.0 * L_T / T)


class _Displacement(Feature):
    sees_tilt, index = True, 0

    def value(self, view):
        return 0.0 if view.displacement is None else float(view.displacement[self.index])

    def row(self, view):
        raise DegenerateFeature(f"{self.name}: is for law 'pbvs', which needs no interaction matrix")


for _index, _name in enumerate(("tx", "ty", "tz", "rx", "ry", "rz")):
    _text = f"{_name} of the displacement from the goal: p_CgC [m], then theta u of R_CgC [rad] (T25)."
    register_feature(_name)(type(_name, (_Displacement,), {"index": _index, "__doc__": _text}))


class FeatureSet:
    """The features that are servoed on, in this order.

    Attributes: names.  order: of the moments needed.  sees_tilt: whether any of them does.
    """

    def __init__(self, names=FEATURE_NAMES):
        """Raises ParameterError: unknown names (the known ones are listed), a name given twice, none at all."""
        self.names = tuple(names)
        faults = [f"features: found '{name}', allowed {', '.join(known_features())}"
                  for name in self.names if name not in _FEATURES]
        if len(set(self.names)) != len(self.names) or not self.names:
            faults.append(f"features: found {list(self.names)}, allowed different names, at least one")
        if faults:
            raise ParameterError(faults)
        self._features = [_FEATURES[name]() for name in self.names]
        self._angles = [feature.angle for feature in self._features]
        self.order = max(feature.order for feature in self._features)
        self.sees_tilt = any(feature.sees_tilt for feature in self._features)

    def __len__(self):
        return len(self.names)

    def values(self, view):
        """s, tuple of k. Raises DegenerateFeature when a feature does not exist in this view or lacks its moments."""
        try:
            return tuple([feature.value(view) for feature in self._features])
        except KeyError as error:
            raise self._missing(error) from None

    def error(self, s, s_star, symmetric):
        """e = s - s_star, tuple of k; angles the short way round, modulo pi for a symmetric object."""
        return tuple([wrapped(a - b, symmetric) if angle else a - b
                      for a, b, angle in zip(s, s_star, self._angles)])

    def matrix(self, view):
        """L, (k, 6). Raises as `values`."""
        try:
            return np.array([feature.row(view) for feature in self._features])
        except KeyError as error:
            raise self._missing(error) from None

    def _missing(self, error):
        return DegenerateFeature(f"features {', '.join(self.names)}: moment {error} is missing, set vision.order to "
                                 f"{self.order} or more")


def wrapped(angle, symmetric=False):
    """Angle in [-pi, pi), or in [-pi/2, pi/2) for an object whose orientation is known modulo pi only [rad]."""
    half = 0.5 * np.pi if symmetric else np.pi
    return (angle + half) % (2.0 * half) - half
