"""Settings of the servo: the scenario's section `servo`, checked as a whole."""

from dataclasses import dataclass, field, replace
from typing import Any, Dict, Mapping, Optional, Tuple

from ..config.reader import ConfigReader, Names, read
from ..config.settings import required_keys
from ..ground.errors import ParameterError
from .feed_forward import FeedForwardConfig
from ..features.base import expand, feature_settings, is_known, known_features
from ..laws.base import INTERACTIONS, POINT_DEPTHS, POSES, LawSetup, known_laws, law_settings, make_law
from .lost_target import LostTargetConfig
from ..arm.settings import LimitsConfig, read_motion
from ..config.plugins import load_plugins
from ..config.files import load_yaml, resolve_uri
from ..target.target_pose import PlanarTarget
from ..ground.types import FEATURE_NAMES
from .visibility import VisibilityConfig

MODES = ("continuous", "look_then_move")


@dataclass(frozen=True)
class ServoConfig:
    """Keys of the section, with their defaults. Gains and thresholds are in the order of `features`."""

    law: str
    mode: str
    gains_per_s: Tuple[float, ...]  # > 0 [1/s]
    thresholds: Tuple[float, ...]  # of |e|, > 0 [m, m, m, rad]
    time_limit_s: float  # of simulated time
    features: Tuple[str, ...] = FEATURE_NAMES
    interaction: str = "desired"  # which interaction matrix law ibvs inverts: desired, current, mean
    point_depth: str = "plane"  # of followed points: plane (of the target), goal (always that at the goal)
    pose_from: str = "moments"  # what laws of the pose measure: moments, points
    sections: Mapping[str, Any] = field(default_factory=dict)  # of laws and features with settings of their own
    target_normal_C: Tuple[float, ...] = (0.0, 0.0, 1.0)  # of the target's plane, in the camera frame at the goal
    symmetric_target: bool = False  # the target is the same after half a turn
    adaptive_gain: Optional[Tuple[float, float]] = None  # section: infinity_part, slope, see laws.adaptive_factor
    smooth_start_per_s: float = 0.0  # 0: the first twist comes at once
    target_model: Optional[PlanarTarget] = None  # file of the known target, for law pbvs
    plugins: Tuple[str, ...] = ()  # Python modules that register features and laws of their own
    hold_s: float = 0.2  # converged when |e| is below all thresholds for this long
    input_timeout_s: float = 0.2  # a longer gap between images stops the arm
    tilt_gain_per_s: float = 3.0  # 0: tilt is not held
    sample_time_s: float = 0.01  # look_then_move: a look moves the set-point by gain * sample_time_s of the error
    settle_speed: float = 0.002  # look_then_move: joints slower than this have settled [m/s, rad/s] ...
    settle_tolerance: float = 0.02  # ... and are this close to their set-points, friction included [m, rad] ...
    settle_limit_s: float = 1.0  # ... or have had this long
    acceleration: float = 2.0  # look_then_move: of the moves [m/s^2, rad/s^2]
    method: str = "damped"  # section inverse, see redundancy.py
    at_limits: str = "scale"  # the whole motion, or saturate: the joints that are not at a limit go on
    length_m: float = 0.05
    singular_value_threshold: float = 0.02
    damping: float = 0.02
    joint_weights: Dict[str, float] = None  # section inverse/joint_weights: cost of moving a joint, default 1
    posture_gain_per_s: float = 2.0  # section null_space: return to the taught posture
    joint_limit_gain_per_s: float = 1.0  # section null_space: away from joint limits
    manipulability_gain_per_s: float = 0.0  # section null_space: away from singularities [m^2/s, rad^2/s]
    max_speed: float = 0.2  # section null_space: of any joint [m/s, rad/s]
    large_from: Optional[Tuple[float, float]] = None  # section null_space: projection onto the norm, from this twist on
    limits: LimitsConfig = LimitsConfig()
    visibility: Optional[VisibilityConfig] = None
    joint_limit_margin: float = 0.01  # kept to every joint limit [m, rad]
    feed_forward: Optional[FeedForwardConfig] = None  # of the motion of the target
    track: bool = False  # the goal is followed until the time limit
    lost_target: LostTargetConfig = LostTargetConfig()  # keys on_lost and lost_target

    @classmethod
    def from_dict(cls, source, joint_names=()):
        """Read the section. Raises ParameterError listing every fault."""
        reader = ConfigReader(source, "servo")
        values = {"plugins": reader.texts("plugins", ())}
        for fault in load_plugins(values["plugins"]):
            reader.fault(fault)
        values.update({"law": reader.choice("law", known_laws()), "mode": reader.choice("mode", MODES)})
        features = values["features"] = expand(reader.texts("features", FEATURE_NAMES))
        for name in features:
            if not is_known(name):
                reader.fault(f"features: found {name}, allowed {', '.join(known_features())}")
        for key in ("gains_per_s", "thresholds"):
            values[key] = tuple(reader.section(key, True).spread(expand).numbers(features, above=0.0))
        values["point_depth"] = reader.choice("point_depth", POINT_DEPTHS, cls.point_depth)
        values["pose_from"] = reader.choice("pose_from", POSES, cls.pose_from)
        values["interaction"] = reader.choice("interaction", INTERACTIONS, cls.interaction)
        values["target_normal_C"] = reader.vector("target_normal_C", 3, cls.target_normal_C)
        if not values["target_normal_C"][2] > 0.0:
            reader.fault(f"target_normal_C: found {values['target_normal_C']}, allowed z > 0 (away from the camera)")
        values["symmetric_target"] = reader.flag("symmetric_target", cls.symmetric_target)
        values["smooth_start_per_s"] = reader.number("smooth_start_per_s", 0.0, at_least=0.0)
        target = reader.texts("target_model", (), single=True)
        if target:
            try:
                values["target_model"] = PlanarTarget(load_yaml(resolve_uri(target, key="target_model"))["outlines_m"])
            except (ParameterError, KeyError, ValueError) as error:
                reader.fault(f"target_model: found {target}, allowed the file of a planar target: {error}")
        values["sections"] = _own_sections(reader, Names(features, tuple(joint_names), expand))
        adaptive = reader.section("adaptive_gain")
        if adaptive.keys():
            part = adaptive.number("infinity_part", above=0.0)
            if part is not None and not part < 1.0:
                adaptive.fault(f"infinity_part: found {part}, allowed < 1")
            values["adaptive_gain"] = (part, adaptive.number("slope", above=0.0))
        adaptive.close()
        values["time_limit_s"] = reader.number("time_limit_s", above=0.0)
        for key in ("hold_s", "tilt_gain_per_s", "joint_limit_margin"):
            values[key] = reader.number(key, getattr(cls, key), at_least=0.0)
        settling = ("settle_speed", "settle_tolerance", "settle_limit_s")
        for key in ("input_timeout_s", "sample_time_s", "acceleration", *settling):
            values[key] = reader.number(key, getattr(cls, key), above=0.0)

        values["lost_target"] = LostTargetConfig.read(reader)
        values["feed_forward"] = FeedForwardConfig.read(reader)
        values["track"] = reader.flag("track", cls.track)
        if values["mode"] == "look_then_move" and (values["feed_forward"] is not None or values["track"]):
            reader.fault("feed_forward, track: found with mode look_then_move, allowed with mode continuous")
        values["visibility"] = VisibilityConfig.read(reader)
        values.update(read_motion(reader, joint_names, cls))
        if values["mode"] == "look_then_move" and None not in (*values["gains_per_s"], values["sample_time_s"]):
            for name, value in zip(features, values["gains_per_s"]):
                if value * values["sample_time_s"] >= 2.0:
                    reader.fault(f"gains_per_s/{name}: found {value}, allowed < 2 / sample_time_s (it would diverge)")
        reader.finish()
        config = cls(**values)
        config._check_law(config.law)
        return config

    def _check_law(self, name):
        """Raises ParameterError when law, features and mode do not fit."""
        law = make_law(name, self.gains_per_s, self.law_setup)
        if law.continuous_only and self.mode != "continuous":
            raise ParameterError(f"mode: found {self.mode}, allowed with law '{name}': continuous")

    @property
    def law_setup(self):
        """`LawSetup` of these settings."""
        return LawSetup(self.features, self.interaction, self.adaptive_gain, self.smooth_start_per_s,
                        self.target_model, self.target_normal_C, self.point_depth, self.pose_from,
                        self.symmetric_target, self.sections)

    def with_overrides(self, law="", gains_per_s=(), thresholds=(), time_limit_s=0.0):
        """Copy with the values of a goal of VisualServo.action; empty or 0 keeps. Raises ParameterError."""
        faults, changes = [], {}
        for key, values in (("gains_per_s", gains_per_s), ("thresholds", thresholds)):
            values = tuple(float(value) for value in values)
            fit = len(values) == len(self.features) and all(0.0 < value < float("inf") for value in values)
            if values and not fit:
                faults.append(f"{key}: found {values}, allowed {len(self.features)} numbers > 0")
            elif values:
                changes[key] = values
        if not 0.0 <= time_limit_s < float("inf"):
            faults.append(f"time_limit_s: found {time_limit_s}, allowed >= 0")
        elif time_limit_s:
            changes["time_limit_s"] = float(time_limit_s)
        if law:
            changes["law"] = law
        try:
            self._check_law(law or self.law)
        except ParameterError as error:
            faults += error.faults
        if faults:
            raise ParameterError(faults)
        return replace(self, **changes)


def own_sections():
    """Sections of the laws and features that have settings of their own: name -> settings class.

    Raises ParameterError: two of them want the same section, or one that the servo has already.
    """
    laws, features = law_settings(), feature_settings()
    taken = [name for name in features if name in laws]
    taken += [name for name in (*laws, *features) if name in ServoConfig.__dataclass_fields__]
    if taken:
        raise ParameterError([f"servo/{name}: found a law or feature of this name with settings, allowed a name that "
                              "no other section has" for name in taken])
    return {**laws, **features}


def _own_sections(reader, names):
    """Name -> settings, of the sections that are there and of those that need not be."""
    found, faults = {}, []
    for name, cls in own_sections().items():
        given = reader.value(name)
        if given is not None:
            found[name] = read(cls, given, f"servo/{name}", names, faults=faults)
        elif not required_keys(cls):
            found[name] = cls()
    for fault in faults:
        reader.fault(fault[len("servo/"):])
    return found
