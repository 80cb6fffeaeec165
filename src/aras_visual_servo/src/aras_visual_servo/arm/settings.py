"""Settings of the arm's motion: sections `inverse`, `null_space` and `limits` of the section `servo`; and where a
calibration found the camera on the arm, and in what this robot differs from its model: sections `robot.hand_eye` and
`robot.dynamics`."""

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
        help="Length that makes metres comparable to radians: the linear rows of the Jacobian are divided by it.")
    singular_value_threshold: float = setting(
        0.02, above=0, help="Singular values below it are damped, the smaller the more; above it nothing is slowed.")
    damping: float = setting(0.02, above=0, help="Damping of a direction that the arm has lost.")
    joint_weights: Dict[str, float] = setting(
        {}, above=0, by="joint",
        help="What it costs to move a joint, by its name, e.g. `{J1: 5.0}`; 1 for a joint that is not named.")
    method: str = setting("damped", choices=METHODS, help="How small singular values are inverted (T40).")
    at_limits: str = setting(
        "scale", choices=("scale", "saturate"),
        help="When a joint reaches its limit: `scale` slows the whole motion, `saturate` lets the other joints go on "
             "without it (T44).")


@dataclass(frozen=True)
class NullSpaceSettings:
    """Section `servo.null_space`: what the arm does with the motion that leaves the camera where it is."""

    posture_gain_per_s: float = setting(2.0, unit="1/s", at_least=0, help="Return to the taught posture.")
    joint_limit_gain_per_s: float = setting(1.0, unit="1/s", at_least=0, help="Away from the limits of the joints.")
    manipulability_gain_per_s: float = setting(
        0.0, unit="rad^2/s", at_least=0,
        help="Up the logarithm of the manipulability, away from singularities (T42; 4 us).")
    max_speed: float = setting(0.2, unit="m/s, rad/s", above=0, help="Largest speed of a joint in this motion.")
    projection: str = setting(
        "gradient", choices=("gradient", "large"),
        help="`large`: far from the goal the spare motion may do all that leaves the rate of approach alone (T41).")
    large_from: Tuple[float, ...] = setting(
        (0.05, 0.3), unit="rad/s", at_least=0, size=2, condition=RISING,
        help="With `projection: large`: sizes of the twist, its linear part over length_m, between which that "
             "projection takes over.")

    def check(self) -> Iterator[str]:
        """The sizes are for the larger projection only."""
        if self.projection != "large" and self.large_from != NullSpaceSettings.large_from:
            yield f"large_from: found {self.large_from}, allowed with projection: large"


@dataclass(frozen=True)
class LimitsSettings:
    """Section `servo.limits`: limits that are tighter than those of the URDF."""

    camera_speed_m_s: float = setting(
        inf, unit="m/s", above=0, help="Of the camera; the twist is shortened as a whole.")
    camera_turn_rad_s: float = setting(
        inf, unit="rad/s", above=0, help="Of the camera; the twist is shortened as a whole.")
    joint_acceleration: Dict[str, float] = setting(
        {}, unit="m/s^2, rad/s^2", above=0, by="joint",
        help="By the name of the joint, e.g. `{J1: 5.0}`: all joints are slowed by one factor, so that the direction "
             "stays, and brake in time before a limit; stops are at once.")


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
    """Section `robot.dynamics`: in what this robot differs from its URDF and its controllers' file."""

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
        help="Gains `{p:, i:, d:, i_clamp:}` by joint. A PID that acts by effort takes the place of the joint's "
             "controller, which commands the same, position or velocity.")
    payload: Optional[PayloadSettings] = setting(None, help="What the arm carries.")
