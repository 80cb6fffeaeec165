"""Control laws: from image features to a camera twist, behind one small interface, found by name.

    law = make_law("decoupled", [1.0, 1.0, 1.0, 1.0])
    law.reset(s_star)
    answer = law.step(Look(View(features), dt_s))   # once per image: answer.twist, answer.s, answer.e, ...

s are the features that the scenario names (`features.FeatureSet`), by default s = (xn, yn, an [m], alpha [rad]), and
e = s - s_star. There is one gain per feature [1/s]. For each image the servo gives the law one `Look` and takes one
`Answer`; nothing else goes between them. A new law is a subclass with a name and a `_twist`. One with settings of its
own, the section `servo.NAME` of the scenario, finds them as `self.settings` (docs/extending.md).
"""

from math import exp, expm1, isfinite, sin
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple, Type, TypeVar, Union

import numpy as np

from ..config.reader import faults_of
from ..config.settings import register, settings_of
from ..config.validate import validate
from ..ground.errors import DegenerateFeature, NotFiniteError, ParameterError, ShapeError
from ..features.base import FeatureSet, View
from ..features.interaction import parallel_condition
from ..features.points import depths_in_image
from ..ground.registry import Registry
from ..ground.types import FEATURE_NAMES, Features, Reference
from .look import Answer, Arm, Joints, Look
from .setup import LawSetup

#: An interaction matrix with a larger condition number is not inverted, because in such a view some camera motion
#: hardly changes the features.
MAX_CONDITION = 1e6
LAWS: Registry[Type["Law"]] = Registry("law", __package__)
L = TypeVar("L", bound="Law")


def register_law(name: str, settings: Optional[type] = None) -> Callable[[Type[L]], Type[L]]:
    """Returns a class decorator that makes a law known by name. Args and errors: of `settings.register`."""
    return register(LAWS, name, settings, name=name)


def known_laws() -> List[str]:
    """Returns the names of the registered laws, sorted."""
    return list(LAWS)


def works_on(name: str) -> Optional[Tuple[str, ...]]:
    """Returns the names of the features that a law is made for; None: it takes any features. Raises KeyError."""
    return LAWS[name].works_on


def law_settings() -> Dict[str, type]:
    """Returns name -> settings class of the laws that have settings of their own, sorted by name."""
    return {name: law.settings_class for name, law in LAWS.items() if law.settings_class is not None}


def make_law(name: str, gains_per_s: Sequence[float], setup: LawSetup = LawSetup()) -> "Law":
    """Makes the law of that name.

    Args: gains_per_s: (k,), > 0, one per feature, in the order of the features [1/s].
    Raises ParameterError: the name is unknown, a gain is not > 0, a setting is out of range, or the law does not work
        on the features of the setup.
    """
    return LAWS.find(name)(gains_per_s, setup)


def adaptive_factor(size: float, part: float, slope: float) -> float:
    """Factor on the gains for a feature error of this size (T22).

    It is 1 where the error is zero and falls towards `part` as the error grows; near zero it falls by `slope` per unit.
    Args: size: largest |e_i|, in the units of the features.  part: 0 < part < 1.  slope: > 0, per unit of e.
    """
    return (1.0 - part) * exp(-slope / (1.0 - part) * size) + part


def sampled_gains(gains_per_s: Sequence[float], dt_s: float) -> Sequence[float]:
    """Gains for a twist that is held for dt_s, which then reduces e as exp(-gain t) does in that time (T14).

    Args: gains_per_s: (k,) [1/s].  dt_s: 0 gives the gains back as they are [s].
    """
    return [-expm1(-gain * dt_s) / dt_s for gain in gains_per_s] if dt_s > 0.0 else gains_per_s


class Law:
    """Base class of the laws. It checks gains and features, forms the feature error and calls `_twist` of the subclass.

    Attributes:
        name: under which the law is registered.
        works_on: names of the features that the law is made for; None: it takes any features.
        continuous_only: True for a law that does not work in mode look_then_move.
        needs_plane: True makes the servo put the target's plane into the view of each `Look`.
        needs_pose: True makes the servo put X_CgC into each `Look`.
        foresees: False for a law that needs more of an image than its features, so that they cannot be foreseen.
        moves_joints: True makes the servo ask `joint_velocity` for the velocities of the joints.
        settings_class, settings: the law's own settings, class and instance; None for a law without.
        features: `FeatureSet`.
        gains_per_s: tuple of k [1/s]; with `adaptive_gain` they are smaller far from the goal.
    """

    name, needs_plane, needs_pose, continuous_only, moves_joints, foresees = "", False, False, False, False, True
    works_on: Optional[Tuple[str, ...]] = FEATURE_NAMES
    settings_class: Optional[type] = None

    def __init__(self, gains_per_s: Sequence[float], setup: LawSetup = LawSetup()) -> None:
        """Args and errors: those of `make_law`."""
        self.features, self._setup = FeatureSet(setup.features, setup.settings, setup.source), setup
        names = self.features.names
        self.gains_per_s = tuple(float(gain) for gain in gains_per_s)
        faults: List[Any] = list(faults_of(setup))
        if self.works_on is not None and names != tuple(self.works_on):
            faults.append(f"features: found {', '.join(names)}, allowed with law '{self.name}': "
                          f"{', '.join(self.works_on)}")
        if len(self.gains_per_s) != len(names):
            faults.append(f"gains_per_s: found {len(self.gains_per_s)} gains, allowed {len(names)}")
        for name, gain in zip(names, self.gains_per_s):
            validate({"type": "number", "exclusiveMinimum": 0}, gain, ("gains_per_s", name), faults)
        if faults:
            raise ParameterError(faults)
        self.settings: Any = None
        if self.settings_class is not None:
            self.settings = settings_of(self.name, self.settings_class, setup.settings, f"law '{self.name}'")
        self._rates = self.gains_per_s
        self._s_star: Any = None
        self._inverse_depths: Optional[List[float]] = None
        self._condition = float("nan")
        self._prepare()

    def _prepare(self):
        """Sets up the subclass beyond features, gains and settings."""

    def reset(self, reference: Union[Reference, Sequence[float]]) -> None:
        """Forgets the past and servos to `reference` from now on.

        Args: reference: a `Reference`, or s_star alone, (k,); some laws need the taught view of a `Reference`.
        Raises:
            ShapeError, NotFiniteError: s_star has another length, or is not finite.  ParameterError: the law needs a
            view that the reference does not have.
        """
        s_star = tuple(float(value) for value in getattr(reference, "s_star", reference))
        if len(s_star) != len(self.features):
            raise ShapeError(f"s_star: {len(s_star)} values, expected {len(self.features)}")
        if not all(map(isfinite, s_star)):
            raise NotFiniteError(f"s_star: found {s_star}, allowed finite numbers")
        self._s_star = s_star
        if self._setup.point_depth == "goal":
            view, (A, B, C) = self.taught_view(reference)
            self._inverse_depths = [A * x + B * y + C for x, y in zip(view.point_x, view.point_y)]
        elif self._setup.point_depth == "image":
            depths_in_image(self.taught_view(reference)[0])  # a goal without them is refused
        self._reset(reference)

    def _reset(self, reference):
        """Makes the subclass forget its past and servo to `reference`."""

    def step(self, look: Look) -> Answer:
        """The `Answer` to one `Look`.

        Raises:
            NotFiniteError: a feature, dt_s or the interaction matrix is not finite.
            DegenerateFeature: a feature does not exist in this view, or the matrix of the features cannot be inverted.
        """
        tracker = look.tracker
        if tracker is None or tracker.seen:
            look = self._see(look)
            s = self.features.values(look.view)
            if tracker is not None:
                s = tracker.corrected(s, look.view)
        else:
            s = tracker.foreseen()
            look = self._foresee(look, s)
        if not (isfinite(sum(s)) and isfinite(look.dt_s)):
            self.features.check_finite("value", s)
            raise NotFiniteError(f"features: found {s} and dt_s {look.dt_s}, allowed finite numbers")
        e = self.features.error(s, self._s_star, self._symmetric(look.view))
        adaptive = self._setup.adaptive_gain
        if adaptive is not None:
            factor = adaptive_factor(max(abs(error) for error in e), adaptive.infinity_part, adaptive.slope)
            self.gains_per_s = tuple([factor * rate for rate in self._rates])
        twist = np.asarray(self._twist(look, s, e), dtype=float)
        return Answer(twist, s, e, self._condition_at(s), self._settled(twist), self._pose(look), self.gains_per_s)

    def joint_velocity(self, view: View, arm: "Arm", twist: np.ndarray) -> "Joints":
        """`Joints` of a law that `moves_joints`, after `step` has answered the same image.

        Args: view: `View` of the image.  arm: `Arm`.  twist: (6,) V_C of the answer with the additions of the servo.
        """
        raise NotImplementedError

    def _symmetric(self, view):
        """Whether the target is the same after half a turn; not every source of features says so."""
        return getattr(view.features, "symmetric", False) or self._setup.symmetric_target

    def _see(self, look):
        """Returns the look with the law's knowledge about the view: here the depths of followed points."""
        depths = self._inverse_depths
        if self._setup.point_depth == "image":
            depths = 1.0 / depths_in_image(look.view.features)
        return look if depths is None else look._replace(view=View(look.view.features, look.view.plane, None, depths))

    def _foresee(self, look, s):
        """Returns the look with the law's knowledge about a view without the target, whose s is predicted."""
        return Law._see(self, look)

    def _twist(self, look, s, e):
        """The subclass's twist V_C, (6,), [v; w] in the camera frame [m/s; rad/s].

        Args: look: `Look`.  s, e: tuples of k, the features and their errors.
        """
        raise NotImplementedError

    def _settled(self, twist):
        """Whether the law itself regards the goal as reached. A law may want more for that than small errors.

        Args: twist: (6,) of `_twist`.
        """
        return True

    def _pose(self, look):
        """(6,) displacement of the camera from the goal, [p_CgC; theta u], None where the law does not know it."""
        return look.view.displacement

    def _condition_at(self, s):
        """Condition number of the interaction matrix of the twist, here of the one inverted last; NaN before any."""
        return self._condition

    def taught_view(self, reference: Any) -> Tuple[Features, Any]:
        """(view, plane_C) of a `Reference`: its `Features`, and (A, B, C) of its plane, (3,) [1/m].

        Raises ParameterError: the reference has no view or no plane.
        """
        if not isinstance(reference, Reference) or reference.view is None or reference.plane_C is None:
            raise ParameterError(f"law '{self.name}': needs the moments and the plane of the goal's view, but the "
                                 "reference was stored without them: teach the goal again")
        return reference.view, reference.plane_C

    def goal_matrix(self, view: Features, plane: Sequence[float]) -> np.ndarray:
        """L, (k, 6), at the goal. Args: view: taught `Features`.  plane: its (A, B, C), (3,) [1/m]."""
        depths = 1.0 / depths_in_image(view) if self._setup.point_depth == "image" else None
        return self.features.matrix(View(view, plane, None, depths))

    def invert(self, L: np.ndarray) -> np.ndarray:
        """Pseudo-inverse, (6, k), of an interaction matrix L, (k, 6), of these features.

        Features that do not see tilt get no w_x and w_y: the servo holds the attitude from the joint positions.
        Raises:
            NotFiniteError: L is not finite.  DegenerateFeature: its condition number is MAX_CONDITION or more.
        """
        if not isfinite(float(L.sum())):
            self.features.check_finite("row", L)
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


@register_law("paper")
class Paper(Law):
    """The published law, eq. (17) and (18): v = -Lambda L^-1 e with L of eq. (16) (docs/theory.md T12).

    The gains multiply the twist, so unequal gains let the error of one feature disturb the others.
    """

    def _condition_at(self, s):
        return parallel_condition(s[0], s[1])

    def _twist(self, look, s, e):
        kx, ky, kz, ka = self.gains_per_s
        return np.array([kx * (e[0] + s[1] * e[3]), ky * (e[1] - s[0] * e[3]), kz * e[2], 0.0, 0.0, ka * e[3]])


@register_law("decoupled")
class Decoupled(Law):
    """v = -L^-1 Lambda e: each feature decays on its own as exp(-lambda t), also from image to image (T13, T14).

    The twist is held until the next image. Therefore the gain is (1 - exp(-lambda dt)) / dt, and v allows for the
    camera's turn in that time: with phi = wz dt a point P of the target moves to Rz(-phi) P - dt S v, where
    S = [[sin phi, 1 - cos phi], [cos phi - 1, sin phi]] / phi, and this is solved for v. It is exact for a target
    parallel to the image.
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
        if abs(phi) > 1e-6:  # for smaller turns S is 1, and the second-order terms of Rz are lost in rounding anyway
            one_minus_c, sine = 2.0 * sin(0.5 * phi) ** 2, sin(phi)
            dx = gains[0] * e[0] + (y * sine - x * one_minus_c) / dt_s
            dy = gains[1] * e[1] - (x * sine + y * one_minus_c) / dt_s
            a, b = sine / phi, one_minus_c / phi
            scale = 1.0 / (a * a + b * b)
            dx, dy = scale * (a * dx - b * dy), scale * (b * dx + a * dy)
        return np.array([dx, dy, gains[2] * e[2], 0.0, 0.0, wz])
