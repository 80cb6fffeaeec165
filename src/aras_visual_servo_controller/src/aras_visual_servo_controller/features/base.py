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

A feature with settings of its own describes them as a frozen dataclass (config/settings.py) and finds them as
`self.settings`; they are read from the section `servo.NAME` of the scenario:

    @register_feature("elongation", settings=ElongationSettings)
"""

import re

import numpy as np

from . import interaction
from ..config.plugins import load_room
from ..config.settings import keys_of, settings_of
from ..ground.errors import DegenerateFeature, ParameterError
from ..ground.types import FEATURE_NAMES

_FEATURES, _FAMILIES = {}, {}
_NUMBERED = re.compile(r"([a-z]+)([1-9][0-9]?)")


def register_feature(name, settings=None):
    """Class decorator: make a feature known by name.

    Args: settings: settings class of the feature's own section `servo.NAME`. ParameterError: it does not describe one.
    """

    def add(feature):
        feature.name = name
        _FEATURES[name] = _owning(feature, name, settings)
        return feature

    return add


def register_family(prefix, settings=None):
    """Class decorator: make features known as `prefix` and a number from 1 to 99, which the class finds as `number`.

    Args: settings: as of `register_feature`; the section is `servo.PREFIX`, for all of the family.
    """

    def add(feature):
        _FAMILIES[prefix] = _owning(feature, prefix, settings)
        return feature

    return add


def _owning(feature, section, settings):
    if settings is not None:
        keys_of(settings)
    feature.section, feature.settings_class = section, settings
    return feature


def feature_settings():
    """Features and families with settings of their own: name of their section -> settings class, sorted by name."""
    feature_class("")
    found = {feature.section: feature.settings_class for feature in [*_FEATURES.values(), *_FAMILIES.values()]}
    return {name: found[name] for name in sorted(found) if found[name] is not None}


def feature_class(name):
    """The class registered under that name, or made for that member of a family; None when there is none."""
    load_room(__package__)
    match = _NUMBERED.fullmatch(name)
    if name in _FEATURES or match is None or match[1] not in _FAMILIES:
        return _FEATURES.get(name)
    return type(name, (_FAMILIES[match[1]],), {"name": name, "number": int(match[2])})


def source_of(name):
    """Name of the source of the feature of that name; None when there is no such feature."""
    feature = feature_class(name)
    return None if feature is None else feature.source


def is_known(name):
    """Whether there is a feature of that name."""
    return feature_class(name) is not None


def known_features():
    """Names of the registered features, sorted; "xN" stands for x1, x2, ..., x99."""
    feature_class("")
    return sorted([*_FEATURES, *(f"{prefix}N" for prefix in _FAMILIES)])


def expand(names):
    """Names with "pointsN" written out: x1, y1, ..., xN, yN. Returns a tuple."""
    result = []
    for name in names:
        match = _NUMBERED.fullmatch(str(name))
        if match is None or match[1] != "points":
            result.append(name)
        else:
            result += [f"{axis}{number}" for number in range(1, int(match[2]) + 1) for axis in "xy"]
    return tuple(result)


def spread(values):
    """Dict of feature name -> value, of a dict whose keys may be "pointsN": each of x1, y1, ... gets that value."""
    return {name: value for key, value in values.items() for name in expand((key,))}


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
        plane: (A, B, C) of the target in the camera frame [1/m], floats, None when only values are asked for.
        displacement: (6,) of the camera from the goal, p_CgC and theta u of R_CgC; None: at the goal.
        inverse_depths: (N,) 1/Z of the followed points [1/m]; None: that of the plane.
        reference_point: (x, y, ln(Z/Z*)) of the target's reference point; None: at the goal.
    """

    __slots__ = ("features", "plane", "displacement", "inverse_depths", "reference_point", "_m", "_mu", "_known")

    def __init__(self, features, plane=None, displacement=None, inverse_depths=None, reference_point=None):
        self.features, self.displacement = features, displacement
        self.plane = plane if plane is None else tuple(map(float, plane))  # numpy's own scalars are slow
        self.inverse_depths, self.reference_point = inverse_depths, reference_point
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

    Attributes:
        name.  number: of a family's member.  order: of the moments that value and row need.
        angle: it is one, known modulo 2 pi (modulo pi for a symmetric object, unless it is `directed`).
        sees_tilt: it tells a tilt of the camera from a translation.
        source: name of the `Source` that it is a feature of.
        settings: its own, an instance of settings_class; None: it has none.  section: where they stand.
        unit: of its value: "m", "rad", "1/m", "grey" (grey levels), ..., "-" for none.
        symbol: plain text, a subscript after the first underscore ("x_n", "α"); "": the name.
        label: what it is, in a few words; "": the name.
        colour: of its curves, "#rrggbb"; "": one that the other features do not have. In a family the hues (from, to)
            [deg] that its members share, see palette.shade.
    In symbol and label of a family, "{number}" stands for the number.
    """

    name, number, order, angle, directed, sees_tilt = "", 0, 2, False, False, False
    source, section, settings_class, settings = "moments", "", None, None
    unit, symbol, label, colour = "-", "", "", ""

    def value(self, view):
        """The feature in this view."""
        raise NotImplementedError

    def row(self, view):
        """Its interaction row, (6,), [v; w]; needs view.plane."""
        raise NotImplementedError


class FeatureSet:
    """The features that are servoed on, in this order.

    Attributes: names.  order: of the moments needed.  sees_tilt: whether any of them does.  source: name of their one.
    """

    def __init__(self, names=FEATURE_NAMES, settings=None):
        """Args: names.  settings: section -> settings of features that have their own; None: the defaults.

        Raises ParameterError: names unknown (the known ones are listed), given twice, none at all, sources mixed,
        settings missing that have no default.
        """
        self.names = expand(names)
        classes = [feature_class(name) for name in self.names]
        faults = [f"features: found '{name}', allowed {', '.join(known_features())}"
                  for name, found in zip(self.names, classes) if found is None]
        if len(set(self.names)) != len(self.names) or not self.names:
            faults.append(f"features: found {list(self.names)}, allowed different names, at least one")
        if faults:
            raise ParameterError(faults)
        sources = {found.source for found in classes}
        if len(sources) > 1:
            raise ParameterError(f"features: found {', '.join(self.names)}, of {' and '.join(sorted(sources))}, "
                                 "allowed features of one of them")
        self._features, self.source = [found() for found in classes], sources.pop()
        for feature in self._features:
            if feature.settings_class is not None:
                feature.settings = settings_of(feature.section, feature.settings_class, settings or {},
                                               f"feature '{feature.name}'")
        self._angles = [(feature.angle, not feature.directed) for feature in self._features]
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
        return tuple([wrapped(a - b, symmetric and half_turns) if angle else a - b
                      for a, b, (angle, half_turns) in zip(s, s_star, self._angles)])

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
