"""Image features by name: the values that a law servos on, and how they change when the camera moves.

    features = FeatureSet(("xn", "yn", "an", "sx", "sy", "alpha"))
    s = features.values(View(moment_features))                  # (k,)
    L = features.matrix(View(moment_features, plane))           # (k, 6), s_dot = L V_C

A new feature is a subclass with a name, which computes its value and its row of the interaction matrix from a `View`.
One with settings of its own, the section `servo.NAME` of the scenario, finds them as `self.settings`
(docs/extending.md).

The measurements of an image come as `MomentFeatures`, with raw and centred moments by name "ij". The plane of the
target is (A, B, C) of 1/Z = A x + B y + C in the camera frame [1/m] (docs/theory.md T5).
"""

import inspect
import re
import reprlib
from math import isfinite
from typing import Any, Callable, Dict, Iterable, List, Mapping, Optional, Sequence, Tuple, Type, TypeVar, Union

import numpy as np

from . import interaction
from ..config.settings import register, settings_of
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError, ShapeError
from ..ground.registry import Registry, unknown_name
from ..ground.types import FEATURE_NAMES

FEATURES: Registry[Type["Feature"]] = Registry("features", __package__, f"{__package__}.kinds")
FAMILIES: Registry[Type["Feature"]] = Registry("features", __package__, f"{__package__}.kinds")
F = TypeVar("F", bound="Feature")
T = TypeVar("T")
#: Sources of points beside the moments.
POINT_SOURCES = ("matches", "tag", "pose", "pose_with_covariance", "corners")
_NUMBERED = re.compile(r"([a-z]+)([1-9][0-9]?)")
_MOMENT = re.compile(r"[0-9]{2}")
ROW_SHAPE = (6,)


def register_feature(name: str, settings: Optional[type] = None) -> Callable[[Type[F]], Type[F]]:
    """Returns a class decorator that makes a feature known by name. Args and errors: of `settings.register`."""
    return register(FEATURES, name, settings, name=name, section=name)


def register_family(prefix: str, settings: Optional[type] = None) -> Callable[[Type[F]], Type[F]]:
    """Returns a class decorator for a family of features: `prefix` and a number from 1 to 99, as in x1, x2, ...

    The class finds the number as `self.number`; all members share the section `servo.PREFIX`.
    """
    return register(FAMILIES, prefix, settings, section=prefix)


def register_each(base: Type["Feature"], table: Iterable[Tuple[str, str, str, Any]], first: int = 0,
                  family: bool = False, **attributes: Any) -> None:
    """Registers a subclass of `base` for each row (name or prefix, symbol, label, colour) of a table.

    The subclasses have these attributes, and `index` first, first + 1, ...
    """
    registered = register_family if family else register_feature
    for index, (name, symbol, label, colour) in enumerate(table, first):
        look = {"symbol": symbol, "label": label, "colour": colour}
        registered(name)(type(name, (base,), {"index": index, **look, **attributes}))


def feature_settings() -> Dict[str, type]:
    """Returns section -> settings class of the features and families that have settings of their own, sorted."""
    found = {feature.section: feature.settings_class for feature in [*FEATURES.values(), *FAMILIES.values()]}
    return {name: cls for name, cls in sorted(found.items()) if cls is not None}


def feature_class(name: str) -> Optional[Type["Feature"]]:
    """Returns the class registered under that name, or made for that member of a family; None when there is none."""
    match = _NUMBERED.fullmatch(name)
    if name in FEATURES or match is None or match[1] not in FAMILIES:
        return FEATURES.get(name)
    return type(name, (FAMILIES[match[1]],), {"name": name, "number": int(match[2])})


def source_of(name: str) -> Optional[str]:
    """Returns the name of the source that a feature comes from; None when there is no such feature."""
    feature = feature_class(name)
    return None if feature is None else feature.source


def is_known(name: str) -> bool:
    """Whether there is a feature of that name."""
    return feature_class(name) is not None


def known_features() -> List[str]:
    """Returns the names of the registered features, sorted; "xN" stands for x1, x2, ..., x99."""
    return sorted([*FEATURES, *(f"{prefix}N" for prefix in FAMILIES)])


def expand(names: Iterable[str]) -> Tuple[str, ...]:
    """Returns the names, in which "pointsN" is replaced by x1, y1, ..., xN, yN."""
    result: List[str] = []
    for name in names:
        match = _NUMBERED.fullmatch(str(name))
        if match is None or match[1] != "points":
            result.append(name)
        else:
            result += [f"{axis}{number}" for number in range(1, int(match[2]) + 1) for axis in "xy"]
    return tuple(result)


def spread(values: Mapping[str, T]) -> Dict[str, T]:
    """Dict of feature name -> value, from one whose keys may be "pointsN": each of x1, y1, ... gets that value."""
    return {name: value for key, value in values.items() for name in expand((key,))}


def _area_row(view):
    """L of a = m00 (T8)."""
    return interaction.area(view.m, view.plane)


def _centroid_rows(view):
    """L of (xg, yg) (T8)."""
    return interaction.centroid(view.m, view.plane)


def _mu_row(view, i, j):
    """L of mu_ij (T7)."""
    return interaction.centred_moments(view.m, view.mu, [(i, j)], view.plane)[0]


def _normalised_rows(view):
    """L of (xn, yn, an) (T9)."""
    return interaction.normalised(view.m, view.plane, view.features.z_star_m, view.features.area_star)


class View:
    """One view of the target. Quantities that several features need are computed once (`shared`).

    Attributes:
        features: `Features`, or any object with its attributes.
        plane: (A, B, C) of the target in the camera frame [1/m], floats; None when only values are asked for.
        displacement: (6,) of the camera from the goal: p_CgC [m], then theta u of R_CgC [rad]; None: none, the camera
            is at the goal.
        inverse_depths: (N,) 1/Z of the followed points [1/m]; None: the plane gives them.
        reference_point: (x, y, ln(Z/Z*)) of the target's reference point; None: the camera is at the goal.
    """

    __slots__ = ("features", "plane", "displacement", "inverse_depths", "reference_point", "_m", "_mu", "_known")

    def __init__(self, features: Any, plane: Optional[Sequence[float]] = None,
                 displacement: Optional[np.ndarray] = None, inverse_depths: Optional[Sequence[float]] = None,
                 reference_point: Optional[Sequence[float]] = None) -> None:
        self.features, self.displacement = features, displacement
        self.plane: Any = plane if plane is None else tuple(map(float, plane))  # floats are faster than numpy's scalars
        self.inverse_depths, self.reference_point = inverse_depths, reference_point
        self._m: Optional[Dict[str, float]] = None
        self._mu: Optional[Dict[str, float]] = None
        self._known: Dict[Any, Any] = {}

    @property
    def m(self) -> Dict[str, float]:
        """Raw moments by name "ij"."""
        if self._m is None:
            self._m = dict(zip(self.features.moment_names, self.features.m))
        return self._m

    @property
    def mu(self) -> Dict[str, float]:
        """Centred moments by name "ij"."""
        if self._mu is None:
            self._mu = dict(zip(self.features.moment_names, self.features.mu))
        return self._mu

    def shared(self, make: Callable[..., T], *arguments: Any) -> T:
        """The value of make(view, *arguments), which is computed once per view and kept."""
        key = (make, arguments)
        if key not in self._known:
            self._known[key] = make(self, *arguments)
        return self._known[key]

    def L_area(self) -> np.ndarray:
        """L of a = m00, (6,)."""
        return self.shared(_area_row)

    def L_centroid(self) -> np.ndarray:
        """L of (xg, yg), (2, 6)."""
        return self.shared(_centroid_rows)

    def L_mu(self, i: int, j: int) -> np.ndarray:
        """L of mu_ij, (6,)."""
        return self.shared(_mu_row, i, j)

    def L_normalised(self) -> np.ndarray:
        """L of (xn, yn, an), (3, 6)."""
        return self.shared(_normalised_rows)


class Feature:
    """Base class of the features.

    Attributes:
        name: under which the feature is registered.  number: that of a member of a family.
        index: its place among features of one class (`register_each`).
        order: up to this order i + j its value and row need moments.
        angle: True if the value is an angle. Its errors are then taken modulo 2 pi, or modulo pi for a symmetric object
            unless the angle is `directed`.
        sees_tilt: True if it changes differently with a tilt of the camera than with a translation, so that a law can
            control the tilt by it.
        source: name of the `Source` that it comes from.
        also_from: names of other sources that provide its input; `servo.source` chooses one of them.
        settings_class, settings: its own settings, class and instance; None for a feature without.
        section: name of the section of these settings.
        overlay: how it is drawn into the camera's image, a file of `report.overlays`; "" for not at all.
        unit: of its value: "m", "rad", "1/m", "grey" (grey levels), ..., "-" for none.
        symbol: plain text with the subscript after the first underscore ("x_n", "α"); "" stands for the name.
        label: short description; "" stands for the name.
        colour: of its curves, "#rrggbb"; "" leaves the choice to `styles`. A family gives a range of hues (from, to)
            [deg] here, from which each member gets a shade of its own (`palette.shade`).
    In symbol and label of a family, "{number}" stands for the number.
    """

    name, number, index, order, angle, directed, sees_tilt = "", 0, 0, 2, False, False, False
    source, section, overlay, unit, symbol, label = "moments", "", "moments", "-", "", ""
    also_from: Tuple[str, ...] = ()
    settings_class: Optional[type] = None
    settings: Any = None
    colour: Union[str, Tuple[float, float]] = ""

    def value(self, view: View) -> float:
        """The feature in this view, a float in its unit. Raises DegenerateFeature: it does not exist in this view."""
        raise NotImplementedError

    def row(self, view: View) -> np.ndarray:
        """Its row of the interaction matrix, (6,), columns [v; w] in the camera frame; needs view.plane."""
        raise NotImplementedError


class FeatureSet:
    """The features that are servoed on, in this order.

    Attributes:
        names: tuple of their names.  order: up to this order they need moments.
        sees_tilt: whether any of them does.  source: name of the source that all of them come from.
    """

    def __init__(self, names: Iterable[str] = FEATURE_NAMES, settings: Optional[Mapping[str, Any]] = None,
                 source: str = "") -> None:
        """Args: names: of features, "pointsN" allowed.  settings: dict of section -> settings of the features that have
        their own; None takes the defaults.  source: name of the source that makes them; "" takes the features' own.

        Raises ParameterError: a name is unknown (the error lists the known ones) or given twice, there is no name, the
            features come from different sources, or a setting without a default is missing.
        """
        self.names = expand(names)
        classes = [feature_class(name) for name in self.names]
        faults = [unknown_name("features", name, known_features())
                  for name, found in zip(self.names, classes) if found is None]
        if len(set(self.names)) != len(self.names) or not self.names:
            faults.append(f"features: found {list(self.names)}, allowed different names, at least one")
        if faults:
            raise ParameterError(faults)
        others = [name for name, found in zip(self.names, classes)
                  if source not in ("", found.source, *found.also_from)]
        if others:
            raise ParameterError(f"source: found '{source}', which does not make {', '.join(others)}, allowed a source "
                                 "that makes every feature")
        sources = {source or found.source for found in classes}
        if len(sources) > 1:
            raise ParameterError(f"features: found {', '.join(self.names)}, which come from the sources "
                                 f"{' and '.join(sorted(sources))}, allowed features of one source")
        self._features: List[Feature] = [found() for found in classes if found is not None]
        self.source = sources.pop()
        for feature in self._features:
            if feature.settings_class is not None:
                feature.settings = settings_of(feature.section, feature.settings_class, settings or {},
                                               f"feature '{feature.name}'")
        self._values = [feature.value for feature in self._features]
        self._angles = [(feature.angle, not feature.directed) for feature in self._features]
        self.order = max(feature.order for feature in self._features)
        self.sees_tilt = any(feature.sees_tilt for feature in self._features)

    def __len__(self) -> int:
        return len(self.names)

    def values(self, view: View) -> Tuple[float, ...]:
        """s, tuple of k.

        Raises:
            DegenerateFeature: a feature does not exist in this view or its moments are missing.
            ShapeError: a value is no number; with the feature, its file and line.
        """
        try:
            s = tuple([value(view) for value in self._values])
        except KeyError as error:
            self._check_moment(error)
            raise
        try:
            tuple(map(isfinite, s))  # NaN is allowed here, but what is no number raises an error
        except (TypeError, ValueError):
            for feature, value in zip(self._features, s):
                _check(feature, "value", value, (), "a number")
        return s

    def error(self, s: Iterable[float], s_star: Iterable[float], symmetric: bool) -> Tuple[float, ...]:
        """e = s - s_star, tuple of k. Errors of angles go the short way round, modulo pi if the object is symmetric."""
        return tuple([wrapped(a - b, symmetric and half_turns) if angle else a - b
                      for a, b, (angle, half_turns) in zip(s, s_star, self._angles)])

    def matrix(self, view: View) -> np.ndarray:
        """L, (k, 6), columns [v; w] in the camera frame. Raises the errors of `values`, also for the rows."""
        try:
            rows = [feature.row(view) for feature in self._features]
        except KeyError as error:
            self._check_moment(error)
            raise
        try:
            L = np.array(rows, dtype=float)
        except (TypeError, ValueError):
            L = np.empty(0)
        if L.shape != (len(rows), *ROW_SHAPE):
            for feature, row in zip(self._features, rows):
                _check(feature, "row", row, ROW_SHAPE, f"numbers of shape {ROW_SHAPE}")
        return L

    def check_finite(self, method: str, numbers: Iterable[Any]) -> None:
        """Raises NotFiniteError if a feature's number is not finite; with the feature, its file and line.

        Args: method: "value" or "row", which made the numbers.  numbers: s, (k,), or L, (k, 6).
        """
        for feature, found in zip(self._features, numbers):
            if not np.isfinite(found).all():
                raise NotFiniteError(f"{_place(feature, method)}: found {np.asarray(found).tolist()}, allowed finite "
                                     "numbers")

    def _check_moment(self, error):
        """Raises DegenerateFeature if a KeyError is that of a moment, and not of a feature's own code."""
        if error.args and _MOMENT.fullmatch(str(error.args[0])):
            raise DegenerateFeature(f"features {', '.join(self.names)}: moment {error} is missing, set vision.order to "
                                    f"{self.order} or more") from None


def _check(feature, method, found, shape, allowed):
    """Raises ShapeError if `found`, which a method of a feature returned, does not consist of numbers of this shape."""
    try:
        fit = found is not None and not isinstance(found, str) and np.array(found, dtype=float).shape == shape
    except (TypeError, ValueError):
        fit = False
    if not fit:
        text = f"shape {found.shape}" if isinstance(found, np.ndarray) else reprlib.repr(found)
        raise ShapeError(f"{_place(feature, method)}: found {text}, allowed {allowed}")


def _place(feature, method):
    """Returns "FILE:LINE: feature 'NAME': METHOD", FILE and LINE of the method in the feature's class."""
    code = getattr(inspect.unwrap(getattr(type(feature), method)), "__code__", None)
    return (f"{code.co_filename}:{code.co_firstlineno}: " if code else "") + f"feature '{feature.name}': {method}"


def wrapped(angle: float, symmetric: bool = False) -> float:
    """The angle in [-pi, pi), or in [-pi/2, pi/2) for an object that is the same after half a turn [rad]."""
    half = 0.5 * np.pi if symmetric else np.pi
    return (angle + half) % (2.0 * half) - half
