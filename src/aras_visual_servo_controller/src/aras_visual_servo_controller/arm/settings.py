"""Settings of the arm's motion: sections `inverse`, `null_space` and `limits` of the section `servo`."""

from math import inf
from typing import Dict, NamedTuple

from .redundancy import METHODS

PROJECTIONS = ("gradient", "large")
AT_LIMITS = ("scale", "saturate")
#: Twist above which the projection onto the norm takes over, and from where on it is the only one [rad/s].
LARGE_FROM = (0.05, 0.3)


class LimitsConfig(NamedTuple):
    """Section `limits`. Joints that are not named, and the camera by default, have none but the URDF's."""

    camera_speed_m_s: float = inf
    camera_turn_rad_s: float = inf
    joint_acceleration: Dict[str, float] = {}  # by name, > 0 [m/s^2, rad/s^2]


def _by_joint(section, key, joint_names):
    """Numbers > 0 by joint name."""
    table = section.section(key)
    names = table.keys()
    for name in names:
        if joint_names and name not in joint_names:
            section.fault(f"{key}/{name}: no such joint, allowed {', '.join(joint_names)}")
    return dict(zip(names, table.numbers(names, above=0.0)))


def read_motion(reader, joint_names, defaults):
    """Values of the three sections, by the fields of `ServoConfig`.

    Args:
        reader: `ConfigReader` of the section `servo`.  joint_names: of the arm, () if unknown.
        defaults: `ServoConfig`.
    """
    inverse = reader.section("inverse")
    values = {"method": inverse.choice("method", METHODS, defaults.method)}
    values["at_limits"] = inverse.choice("at_limits", AT_LIMITS, defaults.at_limits)
    for key in ("length_m", "singular_value_threshold", "damping"):
        values[key] = inverse.number(key, getattr(defaults, key), above=0.0)
    values["joint_weights"] = _by_joint(inverse, "joint_weights", joint_names)
    inverse.close()

    null_space = reader.section("null_space")
    for key in ("posture_gain_per_s", "joint_limit_gain_per_s", "manipulability_gain_per_s"):
        values[key] = null_space.number(key, getattr(defaults, key), at_least=0.0)
    values["max_speed"] = null_space.number("max_speed", defaults.max_speed, above=0.0)
    large = null_space.choice("projection", PROJECTIONS, "gradient") == "large"
    values["large_from"] = null_space.vector("large_from", 2, LARGE_FROM) if large else None
    if large and not 0.0 <= values["large_from"][0] < values["large_from"][1]:
        null_space.fault(f"large_from: found {values['large_from']}, allowed two numbers, 0 <= first < second")
    null_space.close()

    limits = reader.section("limits")
    camera = [limits.number(key, inf, above=0.0) for key in ("camera_speed_m_s", "camera_turn_rad_s")]
    values["limits"] = LimitsConfig(*camera, _by_joint(limits, "joint_acceleration", joint_names))
    limits.close()
    return values
