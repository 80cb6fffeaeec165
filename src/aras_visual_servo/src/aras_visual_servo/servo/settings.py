"""Settings of the servo: the scenario's section `servo`, checked as a whole."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Optional, Tuple

from ..arm.settings import InverseSettings, LimitsSettings, NullSpaceSettings
from ..config.files import load_yaml, resolve_uri
from ..config.plugins import load_plugins
from ..config.reader import Names, read
from ..config.schema import schema_of, with_sections
from ..config.settings import keys_of, required_keys, setting
from ..features.base import expand, feature_settings, is_known, known_features
from ..ground.errors import ParameterError
from ..ground.types import FEATURE_NAMES
from ..laws.base import LawSetup, known_laws, law_settings, make_law
from ..features.target.target_pose import PlanarTarget
from .feature_filter import FilterSettings
from .feed_forward import FeedForwardSettings
from .lost_target import ACTIONS, LostTargetSettings
from .stop_rule import StopSettings
from .visibility import VisibilitySettings

MODES = ("continuous", "look_then_move")


@dataclass(frozen=True, kw_only=True)
class ServoSettings(LawSetup):
    """Section `servo`; what all laws share it has from `LawSetup`. Gains, thresholds: in the order of `features`."""

    law: str = setting(
        not_empty=True,
        help="The control law by name: one of docs/features_and_laws.md, or one registered by you. A law that has "
             "settings of its own finds them in a section of its name.")
    plugins: Tuple[str, ...] = setting(
        (),
        help="Python modules that register_law features and laws of their own; they are imported first.")
    mode: str = setting(
        choices=MODES,
        help="`continuous`: a velocity for every image. `look_then_move`: one image, one move, settle, the next image.")
    gains_per_s: Tuple[float, ...] = setting(
        unit="1/s", above=0, by="feature", not_empty=True,
        help="Rate at which each feature decays (`points4: 2.0` for all of four points); look_then_move: gain times "
             "sample_time_s < 2.")
    thresholds: Tuple[float, ...] = setting(
        above=0, by="feature", not_empty=True,
        help="The servo has converged when the mean error of every feature over hold_s is below its threshold, and "
             "what `stop` asks for holds too: xn, yn and an in m, alpha in rad, the others as they are.")
    hold_s: float = setting(
        0.2, unit="s", at_least=0,
        help="The servo has converged when all that is judged was within its threshold for this long.")
    time_limit_s: float = setting(unit="s", above=0, help="Simulated time after which the servo ends.")
    stop: StopSettings = setting(
        StopSettings(), help="What else has to be within bounds before the servo has converged (T60, T61).")
    creep_rate_per_s: float = setting(
        2.0, unit="1/s", at_least=0,
        help="Rate at which the servo works off what joints creep against dry friction near the goal (T62); 0: not. "
             "Mode `continuous`, goals at rest.")
    input_timeout_s: float = setting(
        0.2, unit="s", above=0,
        help="A longer gap between images stops the arm for that image.")
    tilt_gain_per_s: float = setting(
        3.0, unit="1/s", at_least=0,
        help="Return of the optical axis to its taught direction, from the joint positions; 0: it is not held.")
    sample_time_s: float = setting(
        0.01, unit="s", above=0,
        help="look_then_move: a look asks for gain times this of the error.")
    settle_speed: float = setting(
        0.002, unit="m/s, rad/s", above=0,
        help="look_then_move: joints have settled when they are slower than this and within settle_tolerance.")
    settle_tolerance: float = setting(
        0.02, unit="m, rad", above=0,
        help="look_then_move: how near to its set-point a joint has settled, friction included.")
    settle_limit_s: float = setting(
        1.0, unit="s", above=0,
        help="look_then_move: joints that have not settled after this long are taken as they are.")
    acceleration: float = setting(
        2.0, unit="m/s^2, rad/s^2", above=0,
        help="look_then_move: acceleration of the moves.")
    inverse: InverseSettings = setting(InverseSettings(), help="From the twist of the camera to joint velocities.")
    null_space: NullSpaceSettings = setting(NullSpaceSettings(), help="Motion that leaves the camera where it is.")
    limits: LimitsSettings = setting(LimitsSettings(), help="Limits that are tighter than those of the URDF.")
    joint_limit_margin: float = setting(0.01, unit="m, rad", at_least=0, help="Kept to the limit of every joint.")
    visibility: Optional[VisibilitySettings] = setting(
        None,
        help="The object is kept in a view of this size (T43; 55 us).")
    feed_forward: Optional[FeedForwardSettings] = setting(
        None,
        help="The estimated motion of the target is fed forward (T45); mode `continuous` only.")
    filter: Optional[FilterSettings] = setting(
        None,
        help="The features are filtered, foreseen while the target is not seen, and foreseen by a latency; mode "
             "`continuous` only.")
    track: bool = setting(
        False,
        help="The goal is followed until the time limit; the servo has converged if every error is below its threshold "
             "then. Mode `continuous` only.")
    on_lost: str = setting(
        "hold", choices=ACTIONS,
        help="While the target is lost: `hold` still, `back_off` along the path travelled while it was seen, or "
             "`search` around the pose that saw it last.")
    lost_target: LostTargetSettings = setting(LostTargetSettings(), help="How `back_off` and `search` are done.")

    @classmethod
    def from_dict(cls, source, joint_names=()):
        """Read the section. Raises ParameterError listing every fault."""
        faults = [f"servo/{fault}" for fault in load_plugins(_names_in(source, "plugins"))]
        sections = own_sections()
        features = expand(_names_in(source, "features") or FEATURE_NAMES)
        law = source.get("law") if isinstance(source, Mapping) else None
        if isinstance(law, str) and law not in known_laws():
            faults.append(f"servo/law: found {law}, allowed {', '.join(known_laws())}")
        faults += [f"servo/features: found {name}, allowed {', '.join(known_features())}"
                   for name in features if not is_known(name)]
        names = Names(features, tuple(joint_names), expand=expand)
        config, settings = read(cls, source, "servo", names, sections, faults), {}
        for name, section in sections.items():
            if isinstance(source, Mapping) and name in source:
                settings[name] = read(section, source[name], f"servo/{name}", names, faults=faults)
            elif not required_keys(section):
                settings[name] = section()
        target = _target(config.target_model if config else "", faults)
        if faults:
            raise ParameterError(faults)
        config = replace(config, features=features, target=target, settings=settings)
        config._check_law(config.law)
        return config

    def check(self):
        """Yield a fault for each setting that does not fit the mode."""
        if self.mode != "look_then_move":
            return
        if self.filter is not None:
            yield "filter: found with mode look_then_move, allowed with mode continuous"
        if self.feed_forward is not None or self.track:
            yield "feed_forward, track: found with mode look_then_move, allowed with mode continuous"
        for name, gain in zip(expand(self.features), self.gains_per_s):
            if gain * self.sample_time_s >= 2.0:
                yield f"gains_per_s/{name}: found {gain}, allowed < 2 / sample_time_s (it would diverge)"

    def _check_law(self, name):
        """Raises ParameterError when law, features and mode do not fit."""
        law = make_law(name, self.gains_per_s, self)
        if law.continuous_only and self.mode != "continuous":
            raise ParameterError(f"mode: found {self.mode}, allowed with law '{name}': continuous")
        if self.filter is not None and not law.foresees:
            raise ParameterError(f"filter: found with law '{name}', which needs more of an image than its features")
        if self.filter is not None and self.point_depth == "image":
            raise ParameterError("filter: found with point_depth image, allowed with depths that can be foreseen: "
                                 "plane, goal")

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

    Raises ParameterError: two of them want the same section, or one that is a key of the servo already.
    """
    laws, features = law_settings(), feature_settings()
    taken = [name for name in features if name in laws]
    keys = {key.name for key in keys_of(ServoSettings)}
    taken += [name for name in (*laws, *features) if name in keys]
    if taken:
        raise ParameterError([f"servo/{name}: found a law or feature of this name with settings, allowed a name that "
                              "no other section and no key has" for name in taken])
    return {**laws, **features}


def servo_schema(sections):
    """JSON Schema of the section `servo`. Args: sections: as of `own_sections`."""
    return with_sections(schema_of(ServoSettings), sections)


def _names_in(source, key):
    """The names that a list holds, () if it is none; its faults are for the reader to tell."""
    names = source.get(key, ()) if isinstance(source, Mapping) else ()
    return tuple(name for name in names if isinstance(name, str)) if isinstance(names, (list, tuple)) else ()


def _target(uri, faults):
    """The planar target that a file describes, None for ""."""
    if not uri:
        return None
    try:
        return PlanarTarget(load_yaml(resolve_uri(uri, key="target_model"))["outlines_m"])
    except (ParameterError, KeyError, ValueError) as error:
        faults.append(f"servo/target_model: found {uri}, allowed the file of a planar target: {error}")
        return None
