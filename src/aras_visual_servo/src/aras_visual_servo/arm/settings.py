"""Settings of the arm's motion: sections `inverse`, `null_space` and `limits` of the section `servo`.

Also the calibrated pose of the camera on the arm and the differences of this robot from its model: sections
`robot.hand_eye` and `robot.dynamics`."""

from dataclasses import dataclass
from math import inf
from typing import Dict, Iterator, Optional, Tuple

from ..config.settings import setting
from .damping import METHODS

RISING = ("two numbers, 0 <= first < second", lambda ends: ends[0] < ends[1])


@dataclass(frozen=True)
class InverseSettings:
    """Section `servo.inverse`: how a twist of the camera becomes velocities of the joints."""

    length_m: float = setting(
        0.05, unit="m", above=0,
        help="Length that scales metres to radians: it divides the linear rows of the Jacobian.")
    singular_value_threshold: float = setting(
        0.02, above=0, help="Smaller singular values are damped, others inverted exactly.")
    damping: float = setting(0.02, above=0, help="Damping at a singular value of 0.")
    joint_weights: Dict[str, float] = setting(
        {}, above=0, by="joint",
        help="Cost of moving a joint, by name, e.g. `{J1: 5.0}`; else 1.")
    method: str = setting("damped", choices=METHODS, help="Method for small singular values (T40).")
    at_limits: str = setting(
        "scale", choices=("scale", "saturate"),
        help="At a joint limit: `scale` slows the whole motion, `saturate` continues with the other joints (T44).")


@dataclass(frozen=True)
class NullSpaceSettings:
    """Section `servo.null_space`: use of the joint motion that does not move the camera."""

    posture_gain_per_s: float = setting(2.0, unit="1/s", at_least=0, help="Return to the taught posture.")
    joint_limit_gain_per_s: float = setting(1.0, unit="1/s", at_least=0, help="Away from joint limits.")
    manipulability_gain_per_s: float = setting(
        0.0, unit="rad^2/s", at_least=0,
        help="Away from singularities, up the logarithm of the manipulability (T42).")
    max_speed: float = setting(0.2, unit="m/s, rad/s", above=0, help="Largest joint speed of this motion.")
    projection: str = setting(
        "gradient", choices=("gradient", "large"),
        help="`large`: far from the goal, any motion that keeps the rate of approach is free (T41).")
    large_from: Tuple[float, ...] = setting(
        (0.05, 0.3), unit="rad/s", at_least=0, size=2, condition=RISING,
        help="With `projection: large`: sizes of the twist, linear part over length_m, between which it takes over.")

    def check(self) -> Iterator[str]:
        """The sizes are for the larger projection only."""
        if self.projection != "large" and self.large_from != NullSpaceSettings.large_from:
            yield f"large_from: found {self.large_from}, allowed with projection: large"


@dataclass(frozen=True)
class LimitsSettings:
    """Section `servo.limits`: limits that are tighter than those of the URDF."""

    camera_speed_m_s: float = setting(
        inf, unit="m/s", above=0, help="Of the camera; scales the whole twist.")
    camera_turn_rad_s: float = setting(
        inf, unit="rad/s", above=0, help="Of the camera; scales the whole twist.")
    joint_acceleration: Dict[str, float] = setting(
        {}, unit="m/s^2, rad/s^2", above=0, by="joint",
        help="By joint, e.g. `{J1: 5.0}`. One factor slows all joints, and they brake in time before a limit. Stops "
             "are immediate.")


@dataclass(frozen=True)
class HandEyeSettings:
    """Section `robot.hand_eye`: where a calibration found the camera on the arm."""

    link: str = setting(not_empty=True, help="The link that carries the camera, usually the arm's flange.")
    position_m: Tuple[float, ...] = setting(size=3, unit="m", help="The optical centre in the frame of that link.")
    rpy_rad: Tuple[float, ...] = setting(
        size=3, unit="rad", help="Roll, pitch and yaw of the optical frame in the frame of that link, as in a URDF.")


@dataclass(frozen=True)
class LoopSettings:
    """Entry of `robot.dynamics.loops`: PID gains of a joint, with the meaning that they have in control_toolbox."""

    p: float = setting(above=0, help="Proportional gain.")
    i: float = setting(0.0, at_least=0, help="Integral gain.")
    d: float = setting(0.0, at_least=0, help="Derivative gain.")
    i_clamp: float = setting(0.0, at_least=0, help="Bound of the integral part; 0 switches it off.")


@dataclass(frozen=True)
class PayloadSettings:
    """Section `robot.dynamics.payload`: a point mass on a link, beyond the inertia that the URDF has."""

    link: str = setting(not_empty=True, help="The link that carries it.")
    mass_kg: float = setting(unit="kg", above=0, help="Its mass.")
    position_m: Tuple[float, ...] = setting(size=3, unit="m", help="Where it is in the frame of that link.")


@dataclass(frozen=True)
class DynamicsSettings:
    """Section `robot.dynamics`: differences of this robot from its URDF and its controllers' file."""

    damping: Dict[str, float] = setting(
        {}, unit="N s/m, N m s/rad", at_least=0, by="joint",
        help="Viscous friction by joint, in place of the URDF's.")
    friction: Dict[str, float] = setting(
        {}, unit="N, N m", at_least=0, by="joint", help="Coulomb friction by joint, in place of the URDF's.")
    static_friction: Dict[str, float] = setting(
        {}, unit="N, N m", at_least=0, by="joint",
        help="Friction at rest by joint, at least the Coulomb friction. What it adds fades as "
             "exp(-(speed / stribeck_velocity)^2).")
    stribeck_velocity: Dict[str, float] = setting(
        {}, unit="m/s, rad/s", above=0, by="joint",
        help="Speed by joint over which static friction fades to Coulomb friction; required by static_friction.")
    loops: Dict[str, LoopSettings] = setting(
        {}, by="joint",
        help="Gains `{p:, i:, d:, i_clamp:}` by joint. An effort PID replaces the joint's controller, which commands "
             "the same quantity: position or velocity.")
    payload: Optional[PayloadSettings] = setting(None, help="What the arm carries.")
