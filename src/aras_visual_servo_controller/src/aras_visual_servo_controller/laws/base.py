"""Control laws: from image features to a camera twist, behind one small interface, found by name.

A new law is a subclass with one method and a name:

    @register("proportional")
    class Proportional(Law):
        def _twist(self, look, s, e):
            return np.array([...])                  # V_C, (6,), [v; w]

    law = make_law("proportional", [1.0, 1.0, 1.0, 1.0])
    law.reset(s_star)
    answer = law.step(Look(View(features), dt_s))   # once per image: answer.twist, answer.s, answer.e, ...

s are the features of the scenario (`features.FeatureSet`), e = s - s_star, gains one per feature [1/s]; by default
s = (xn, yn, an [m], alpha [rad]). A `Look` is all that a law is given of an image, an `Answer` all that it says. A law
that inverts an interaction matrix sets `needs_plane` and takes `self.invert(self.features.matrix(look.view))`:
docs/extending.md.

A law with settings of its own describes them as a frozen dataclass (config/settings.py) and finds them as
`self.settings`; they are read from the section `servo.NAME` of the scenario:

    @register("proportional", settings=ProportionalSettings)
"""

from math import exp, expm1, isfinite, sin

import numpy as np

from ..config.plugins import load_room
from ..config.settings import keys_of, settings_of
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError, ShapeError
from ..features.base import FeatureSet, View
from ..features.interaction import parallel_condition
from ..ground.types import FEATURE_NAMES, Reference
from .look import Answer
from .setup import INTERACTIONS, POINT_DEPTHS, POSES, LawSetup

#: A matrix with a larger condition number is not inverted: the view does not tell six motions apart.
MAX_CONDITION = 1e6
_LAWS = {}


def register(name, settings=None):
    """Class decorator: make a law known by name.

    Args: settings: settings class of the law's own section `servo.NAME`. ParameterError if it does not describe one.
    """

    def add(law):
        if settings is not None:
            keys_of(settings)
        _LAWS[name] = law
        law.name, law.settings_class = name, settings
        return law

    return add


def known_laws():
    """Names of the registered laws, sorted."""
    load_room(__package__)
    return sorted(_LAWS)


def law_settings():
    """Laws with settings of their own: name -> settings class, sorted by name."""
    return {name: _LAWS[name].settings_class for name in known_laws() if _LAWS[name].settings_class is not None}


def make_law(name, gains_per_s, setup=LawSetup()):
    """Law of that name.

    Raises ParameterError: unknown name (lists the known ones), a gain that is not > 0, features it does not work on.
    """
    known = known_laws()
    if name not in known:
        raise ParameterError(f"law: found '{name}', allowed {', '.join(known)}")
    return _LAWS[name](gains_per_s, setup)


def adaptive_factor(size, part, slope):
    """Factor on the gains for an error of this size: 1 at zero, `part` far away, falling at first by `slope` (T22).

    Args: size: largest |e_i|, in the units of the features.  part: 0 < part < 1.  slope: > 0, per unit of e.
    """
    return (1.0 - part) * exp(-slope / (1.0 - part) * size) + part


def sampled_gains(gains_per_s, dt_s):
    """Gains that let a twist held for dt_s do what the rates do in that time (T14)."""
    return [-expm1(-gain * dt_s) / dt_s for gain in gains_per_s] if dt_s > 0.0 else gains_per_s


class Law:
    """Base of the laws: checks, feature error, then `_twist` of the subclass.

    Attributes:
        name.  works_on: the features it is made for, None: any.  continuous_only: not for look-then-move.
        needs_plane, needs_pose: what it wants of each `Look`: the target's plane, X_CgC.
        settings: its own, an instance of settings_class; None: it has none.
        features: `FeatureSet`.  gains_per_s: tuple of k, made smaller far from the goal where the setup says so.
    """

    name, settings_class, works_on, needs_plane, needs_pose = "", None, FEATURE_NAMES, False, False
    continuous_only = False

    def __init__(self, gains_per_s, setup=LawSetup()):
        """Args: gains_per_s: (k,), > 0, in the order of the features [1/s]. setup: `LawSetup`. ParameterError."""
        self.features, self._setup = FeatureSet(setup.features, setup.settings), setup
        names = self.features.names
        self.gains_per_s = tuple(float(gain) for gain in gains_per_s)
        faults = []
        if self.works_on is not None and names != tuple(self.works_on):
            faults.append(f"features: found {', '.join(names)}, allowed with law '{self.name}': "
                          f"{', '.join(self.works_on)}")
        if len(self.gains_per_s) != len(names):
            faults.append(f"gains_per_s: found {len(self.gains_per_s)} gains, allowed {len(names)}")
        faults += [
            f"gains_per_s/{name}: found {gain}, allowed > 0"
            for name, gain in zip(names, self.gains_per_s)
            if not (isfinite(gain) and gain > 0.0)
        ]
        if setup.interaction not in INTERACTIONS:
            faults.append(f"interaction: found '{setup.interaction}', allowed {', '.join(INTERACTIONS)}")
        if setup.point_depth not in POINT_DEPTHS:
            faults.append(f"point_depth: found '{setup.point_depth}', allowed {', '.join(POINT_DEPTHS)}")
        if setup.pose_from not in POSES:
            faults.append(f"pose_from: found '{setup.pose_from}', allowed {', '.join(POSES)}")
        if faults:
            raise ParameterError(faults)
        self.settings = None
        if self.settings_class is not None:
            self.settings = settings_of(self.name, self.settings_class, setup.settings, f"law '{self.name}'")
        self._rates = self.gains_per_s
        self._s_star = self._inverse_depths = None
        self._first, self._t_s, self._condition = None, 0.0, float("nan")

    def reset(self, reference):
        """Forget the past; servo to `reference`, s_star (k,) or an object with that attribute (`Reference`)."""
        s_star = tuple(float(value) for value in getattr(reference, "s_star", reference))
        if len(s_star) != len(self.features):
            raise ShapeError(f"s_star: {len(s_star)} values, expected {len(self.features)}")
        if not all(map(isfinite, s_star)):
            raise NotFiniteError(f"s_star: {s_star}")
        self._s_star = s_star
        self._first, self._t_s = None, 0.0
        if self._setup.point_depth == "goal":
            view, (A, B, C) = self.taught_view(reference)
            self._inverse_depths = [A * x + B * y + C for x, y in zip(view.point_x, view.point_y)]

    def step(self, look):
        """`Answer` to one `Look`.

        Raises:
            NotFiniteError: a feature or dt_s is not finite.  DegenerateFeature: a feature does not exist in this view.
        """
        look = self._see(look)
        s = self.features.values(look.view)
        if not (isfinite(sum(s)) and isfinite(look.dt_s)):
            raise NotFiniteError(f"features {s}, dt_s {look.dt_s}")
        symmetric = getattr(look.view.features, "symmetric", False) or self._setup.symmetric_target
        e = self.features.error(s, self._s_star, symmetric)
        adaptive = self._setup.adaptive_gain
        if adaptive is not None:
            factor = adaptive_factor(max(map(abs, e)), adaptive.infinity_part, adaptive.slope)
            self.gains_per_s = tuple([factor * rate for rate in self._rates])
        twist = self._twist(look, s, e)
        settled = self._settled(twist)
        if self._setup.smooth_start_per_s > 0.0:
            twist = self._let_in(twist, look.dt_s)
        return Answer(twist, s, e, self._condition_at(s), settled)

    def _see(self, look):
        """The look with what this law knows of the view besides."""
        if self._inverse_depths is None:
            return look
        return look._replace(view=View(look.view.features, look.view.plane, None, self._inverse_depths))

    def _twist(self, look, s, e):
        """V_C, (6,). Args: look: `Look`.  s, e: tuples of k, the features and their errors."""
        raise NotImplementedError

    def _settled(self, twist):
        """Whether this twist, before it is let in smoothly, is no motion worth mentioning."""
        return True

    def _condition_at(self, s):
        """Condition number of the interaction matrix that the twist rests on; the one inverted last, if any."""
        return self._condition

    def taught_view(self, reference):
        """(view, plane_C) of a `Reference`. Raises ParameterError when it has none."""
        if not isinstance(reference, Reference) or reference.view is None or reference.plane_C is None:
            raise ParameterError(f"law '{self.name}': the reference holds no view with its moments: teach it again")
        return reference.view, reference.plane_C

    def _let_in(self, twist, dt_s):
        """Take the first twist away, and give it back at the rate smooth_start_per_s (T23)."""
        if self._first is None:
            self._first = np.array(twist, dtype=float)
        self._t_s += dt_s  # to the end of the time the twist is held: the first image moves already
        return twist - exp(-self._setup.smooth_start_per_s * self._t_s) * self._first

    def goal_matrix(self, view, plane):
        """L, (k, 6), of the taught view and plane."""
        return self.features.matrix(View(view, plane))

    def invert(self, L):
        """Pseudo-inverse (6, k) of an interaction matrix (k, 6) of these features.

        Features that do not see tilt leave w_x, w_y alone: the servo holds the attitude from the joint positions.
        Raises: DegenerateFeature: (nearly) singular.  NotFiniteError.
        """
        if not isfinite(float(L.sum())):
            raise NotFiniteError("interaction matrix is not finite")
        sees_tilt, columns = self.features.sees_tilt, [0, 1, 2, 5]
        U, sigmas, Vt = np.linalg.svd(L if sees_tilt else L[:, columns], full_matrices=False)
        largest, least = float(sigmas[0]), float(sigmas[-1])
        self._condition = largest / least if least > 0.0 else float("inf")
        if not self._condition < MAX_CONDITION:
            raise DegenerateFeature(f"features {', '.join(self.features.names)}: condition number of their interaction "
                                    f"matrix is {self._condition:.3g}, allowed < {MAX_CONDITION:g}")
        seen = (Vt.T / sigmas) @ U.T
        if sees_tilt:
            return seen
        inverse = np.zeros((6, len(L)))
        inverse[columns] = seen
        return inverse


@register("paper")
class Paper(Law):
    """The published eq. (17) and (18): v = -Lambda L^-1 e, L of eq. (16) (docs/theory.md T12). Unequal gains couple."""

    def _condition_at(self, s):
        return parallel_condition(s[0], s[1])

    def _twist(self, look, s, e):
        kx, ky, kz, ka = self.gains_per_s
        return np.array([kx * (e[0] + s[1] * e[3]), ky * (e[1] - s[0] * e[3]), kz * e[2], 0.0, 0.0, ka * e[3]])


@register("decoupled")
class Decoupled(Law):
    """v = -L^-1 Lambda e: each feature decays on its own as exp(-lambda t), exactly so when sampled (T13, T14).

    The gain is (1 - exp(-lambda dt)) / dt, and v is corrected for the camera turning while the twist is held: with
    phi = wz dt a point P of the target moves to Rz(-phi) P - dt S v, where S = [[sin phi, 1 - cos phi],
    [cos phi - 1, sin phi]] / phi; solved for v. Exact for a target parallel to the image.
    """

    def _condition_at(self, s):
        return parallel_condition(s[0], s[1])

    def _twist(self, look, s, e):
        gains, dt_s = self.gains_per_s, look.dt_s
        if dt_s > 0.0:
            gains = [-expm1(-gain * dt_s) / dt_s for gain in gains]
        x, y = s[0], s[1]
        wz = gains[3] * e[3]
        dx, dy = gains[0] * e[0] + y * wz, gains[1] * e[1] - x * wz
        phi = wz * dt_s
        if abs(phi) > 1e-6:  # below, S = 1 and the second-order terms of Rz vanish in rounding
            one_minus_c, sine = 2.0 * sin(0.5 * phi) ** 2, sin(phi)
            dx = gains[0] * e[0] + (y * sine - x * one_minus_c) / dt_s
            dy = gains[1] * e[1] - (x * sine + y * one_minus_c) / dt_s
            a, b = sine / phi, one_minus_c / phi
            scale = 1.0 / (a * a + b * b)
            dx, dy = scale * (a * dx - b * dy), scale * (b * dx + a * dy)
        return np.array([dx, dy, gains[2] * e[2], 0.0, 0.0, wz])
