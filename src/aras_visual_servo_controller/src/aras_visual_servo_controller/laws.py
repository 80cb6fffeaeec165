"""Control laws: from image features to a camera twist, behind one small interface, found by name.

A new law is a subclass with one method and a name:

    @register("proportional")
    class Proportional(Law):
        def _twist(self, s, e, dt_s):
            return np.array([...])                  # V_C, (6,), [v; w]

    law = make_law("proportional", [1.0, 1.0, 1.0, 1.0])
    law.reset(s_star)
    V_C = law.step(features, dt_s)                  # once per image

s = (xn, yn, an [m], alpha [rad]), e = s - s_star, gains one per feature [1/s]. dt_s is the time the twist will be held;
0 asks for the instantaneous twist, which look-then-move multiplies by its sample time.
"""

from math import expm1, isfinite, pi, sin

import numpy as np

from .errors import NotFiniteError, ParameterError, ShapeError
from .types import FEATURE_NAMES

_LAWS = {}


def register(name):
    """Class decorator: make a law known by name."""

    def add(law):
        _LAWS[name] = law
        law.name = name
        return law

    return add


def known_laws():
    """Names of the registered laws, sorted."""
    return sorted(_LAWS)


def make_law(name, gains_per_s):
    """Law of that name. Raises ParameterError: unknown name (lists the known ones) or a gain that is not > 0."""
    if name not in _LAWS:
        raise ParameterError(f"law: found '{name}', allowed {', '.join(known_laws())}")
    return _LAWS[name](gains_per_s)


def wrapped(angle, symmetric=False):
    """Angle in [-pi, pi), or in [-pi/2, pi/2) for an object whose orientation is known modulo pi only [rad]."""
    half = 0.5 * pi if symmetric else pi
    return (angle + half) % (2.0 * half) - half


class Law:
    """Base of the laws: checks, feature error, then `_twist` of the subclass.

    Attributes: name; gains_per_s: tuple of 4; s, e: tuples of 4, of the last step.
    """

    name = ""

    def __init__(self, gains_per_s):
        """Args: gains_per_s: (4,), > 0, in the order of FEATURE_NAMES [1/s]. Raises ParameterError."""
        self.gains_per_s = tuple(float(gain) for gain in gains_per_s)
        if len(self.gains_per_s) != len(FEATURE_NAMES):
            raise ParameterError(f"gains_per_s: found {len(self.gains_per_s)} gains, allowed {len(FEATURE_NAMES)}")
        faults = [
            f"gains_per_s/{name}: found {gain}, allowed > 0"
            for name, gain in zip(FEATURE_NAMES, self.gains_per_s)
            if not (isfinite(gain) and gain > 0.0)
        ]
        if faults:
            raise ParameterError(faults)
        self.s = self.e = self._s_star = None

    def reset(self, reference):
        """Forget the past; servo to `reference`, s_star (4,) or an object with that attribute."""
        s_star = tuple(float(value) for value in getattr(reference, "s_star", reference))
        if len(s_star) != len(FEATURE_NAMES):
            raise ShapeError(f"s_star: {len(s_star)} values, expected {len(FEATURE_NAMES)}")
        if not all(map(isfinite, s_star)):
            raise NotFiniteError(f"s_star: {s_star}")
        self.s = self.e = None
        self._s_star = s_star

    def step(self, features, dt_s):
        """Camera twist for this image.

        Args:
            features: object with xn, yn, an [m], alpha [rad] and symmetric.  dt_s: time the twist is held, >= 0 [s].
        Returns:
            V_C, (6,), [v; w] in the camera frame [m/s; rad/s].
        Raises:
            NotFiniteError: a feature or dt_s is not finite.
        """
        star = self._s_star
        s = (features.xn, features.yn, features.an, features.alpha)
        if not (isfinite(sum(s)) and isfinite(dt_s)):
            raise NotFiniteError(f"features {s}, dt_s {dt_s}")
        self.s = s
        self.e = (s[0] - star[0], s[1] - star[1], s[2] - star[2], wrapped(s[3] - star[3], features.symmetric))
        return self._twist(self.s, self.e, dt_s)

    def _twist(self, s, e, dt_s):
        raise NotImplementedError


@register("paper")
class Paper(Law):
    """The published eq. (17) and (18): v = -Lambda L^-1 e, L of eq. (16) (docs/theory.md T12). Unequal gains couple."""

    def _twist(self, s, e, dt_s):
        kx, ky, kz, ka = self.gains_per_s
        return np.array([kx * (e[0] + s[1] * e[3]), ky * (e[1] - s[0] * e[3]), kz * e[2], 0.0, 0.0, ka * e[3]])


@register("decoupled")
class Decoupled(Law):
    """v = -L^-1 Lambda e: each feature decays on its own as exp(-lambda t), exactly so when sampled (T13, T14).

    The gain is (1 - exp(-lambda dt)) / dt, and v is corrected for the camera turning while the twist is held: with
    phi = wz dt a point P of the target moves to Rz(-phi) P - dt S v, where S = [[sin phi, 1 - cos phi],
    [cos phi - 1, sin phi]] / phi; solved for v. Exact for a target parallel to the image.
    """

    def _twist(self, s, e, dt_s):
        gains = self.gains_per_s
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
