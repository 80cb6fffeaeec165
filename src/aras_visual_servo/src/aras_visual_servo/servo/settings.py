"""Settings of the servo: the scenario's section `servo`, checked as a whole."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from math import inf
from types import SimpleNamespace
from typing import Any, Dict, List, Optional, Tuple

from ..arm.settings import InverseSettings, LimitsSettings, NullSpaceSettings
from ..config.files import load_yaml, resolve_uri
from ..config.plugins import load_plugins
from ..config.reader import Names, build, keyed
from ..config.schema import schema_of, with_sections
from ..config.settings import keys_of, required_keys, setting
from ..config.validate import Fault, validate
from ..features.sources.base import SOURCES
from ..features.base import expand, feature_settings, is_known, known_features
from ..ground.errors import ParameterError
from ..ground.registry import one_of, unknown_name
from ..ground.types import FEATURE_NAMES
from ..laws.base import LAWS, LawSetup, law_settings
from ..features.target.target_pose import PlanarTarget
from .feature_filter import FilterSettings
from .feed_forward import FeedForwardSettings
from .lost_target import ACTIONS, LostTargetSettings
from .nearest_point import OutOfReachSettings
from .stage import STAGES
from .stop_rule import StopSettings
from .visibility import VisibilitySettings

PATH = ("servo",)
MODES = ("continuous", "look_then_move")
OUTPUTS = ("joints", "twist")


@dataclass(frozen=True, kw_only=True)
class ServoSettings(LawSetup):
    """Section `servo`. Inherits the keys of all laws from `LawSetup`. Gains, thresholds: in the order of `features`."""

    law: str = setting(
        not_empty=True,
        help="Name of the control law (docs/features_and_laws.md, or your own). A law reads its settings from the "
             "section of its name.")
    plugins: Tuple[str, ...] = setting(
        (), help="Python modules with your features and laws, imported first.")
    mode: str = setting(
        choices=MODES,
        help="`continuous`: a velocity per image. `look_then_move`: image, move, settle, repeat.")
    output: str = setting(
        "joints", choices=OUTPUTS,
        help="Command to a real arm: `joints` (see `real.command`), or `twist` of the camera on `real.twist_topic`. A "
             "simulated arm needs `joints`.")
    gains_per_s: Tuple[float, ...] = setting(
        unit="1/s", above=0, by="feature", not_empty=True,
        help="Rate at which each feature decays; `points4: 2.0` sets all four points. look_then_move: gain times "
             "sample_time_s < 2.")
    thresholds: Tuple[float, ...] = setting(
        above=0, by="feature", not_empty=True,
        help="Converged when the mean error of every feature over hold_s is below its threshold and `stop` is met. "
             "Units: m for xn, yn, an; rad for alpha; else the feature's own.")
    hold_s: float = setting(
        0.2, unit="s", at_least=0,
        help="Time for which everything must stay within its threshold.")
    time_limit_s: float = setting(unit="s", above=0, help="Simulated time after which the servo ends.")
    stages: Tuple[str, ...] = setting(
        (),
        help="Your own stages by name. Each may change the twist or stop the arm. Mode `continuous` only.")
    stop: StopSettings = setting(
        StopSettings(), help="Further conditions of convergence (T60, T61).")
    creep_rate_per_s: float = setting(
        2.0, unit="1/s", at_least=0,
        help="Rate of compensation for joints that creep against dry friction near the goal (T62); 0: off. Mode "
             "`continuous`, goals at rest.")
    input_timeout_s: float = setting(
        0.2, unit="s", above=0, help="A longer gap between images stops the arm for that image.")
    tilt_gain_per_s: float = setting(
        3.0, unit="1/s", at_least=0,
        help="Gain that returns the optical axis to its taught direction, by the joint positions; 0: off.")
    sample_time_s: float = setting(
        0.01, unit="s", above=0, help="look_then_move: a move corrects gain times this of the error.")
    settle_speed: float = setting(
        0.002, unit="m/s, rad/s", above=0,
        help="look_then_move: a settled joint is slower than this and within settle_tolerance.")
    settle_tolerance: float = setting(
        0.02, unit="m, rad", above=0,
        help="look_then_move: largest distance of a settled joint from its set-point.")
    settle_limit_s: float = setting(
        1.0, unit="s", above=0,
        help="look_then_move: longest wait for joints to settle.")
    acceleration: float = setting(
        2.0, unit="m/s^2, rad/s^2", above=0, help="look_then_move: acceleration of the moves.")
    inverse: InverseSettings = setting(
        InverseSettings(),
        help="Inverse kinematics: from the camera's twist to joint velocities.")
    null_space: NullSpaceSettings = setting(NullSpaceSettings(), help="Motion that does not move the camera.")
    limits: LimitsSettings = setting(
        LimitsSettings(), help="Limits tighter than the URDF's; mode `continuous` only.")
    joint_limit_margin: float = setting(0.01, unit="m, rad", at_least=0, help="Margin to every joint limit.")
    visibility: Optional[VisibilitySettings] = setting(
        None, help="Keeps the object in a view of this size (T43); mode `continuous` only.")
    feed_forward: Optional[FeedForwardSettings] = setting(
        None, help="Feeds the estimated motion of the target forward (T45); mode `continuous` only.")
    out_of_reach: Optional[OutOfReachSettings] = setting(
        None,
        help="For a goal out of reach, the arm goes to the nearest point by its kinematics and the servo ends. With "
             "`inverse.method: damped` it also passes a limit or singularity near a reachable goal. Off: the arm "
             "rests after some seconds, and the servo lasts until its time limit. Mode `continuous` only.")
    filter: Optional[FilterSettings] = setting(
        None,
        help="Filters the features and predicts them over outages and latency; mode `continuous` only.")
    track: bool = setting(
        False,
        help="Follows the goal until the time limit. Converged when every error is below its threshold then. Mode "
             "`continuous` only.")
    on_lost: str = setting(
        "hold", choices=ACTIONS,
        help="While the target is lost: `hold` still, `back_off` along the path with the target visible, or `search` "
             "around the last such pose.")
    lost_target: LostTargetSettings = setting(LostTargetSettings(), help="Settings of `back_off` and `search`.")

    @property
    def follows(self) -> bool:
        """Whether the goal may move."""
        return self.track or self.feed_forward is not None

    def holds_tilt(self, sees_tilt: bool) -> bool:
        """Returns whether the joint positions hold the optical axis. Args: sees_tilt: the features do."""
        return self.tilt_gain_per_s > 0.0 and not sees_tilt

    @classmethod
    def from_dict(cls, source: Mapping, joint_names: Sequence[str] = ()) -> "ServoSettings":
        """Reads the section. Args: joint_names: of the arm; (): any. Raises ParameterError listing every fault."""
        faults = keyed(load_plugins(names_in(source, "plugins")), PATH)
        validate(servo_schema(own_sections()), source, PATH, faults)
        config = cls.checked(source, faults, joint_names)
        if config is None:
            raise ParameterError(faults)
        return config

    @classmethod
    def checked(cls, source: Any, faults: List[Fault], joint_names: Sequence[str] = ()) -> Optional["ServoSettings"]:
        """Returns the settings of a section that the schema has checked; None after a fault in it.

        Adds the faults that the schema does not tell: unknown names, and keys that do not fit each other.
        Args: faults: those of the schema.  joint_names: of the arm; (): any.
        """
        if not isinstance(source, Mapping):
            return None
        features = expand(names_in(source, "features") or FEATURE_NAMES)
        unknown = [name for name in features if not is_known(name)]
        faults += [Fault((*PATH, "features", i), f"found {name}, allowed {one_of(known_features(), name)}")
                   for i, name in enumerate(source["features"]) if name in unknown] if unknown else []
        if unknown:  # check the values of known features only
            features = tuple(name for name in features if name not in unknown)
            source = {**source, **{table: {name: value for name, value in source[table].items()
                                           if name in features or not (is_known(str(name)) or name in unknown)}
                                   for table in _BY_FEATURE if isinstance(source.get(table), Mapping)}}
        names = Names(features, tuple(joint_names), expand=expand)
        settings = {name: build(section, source.get(name, {}), (*PATH, name), faults, names)
                    for name, section in own_sections().items() if name in source or not required_keys(section)}
        target = _target(source.get("target_model"), faults)
        more = {"features": features, "target": target, "settings": settings}
        config = build(cls, source, PATH, faults, names)
        config = _partial(source, faults, more) if config is None else replace(config, **more)
        fits = not unknown and None not in settings.values()
        for fault in keyed([*cls.check(config), *(_law_faults(config) if fits else ())], PATH):
            if fault.path not in [known.path for known in faults]:
                faults.append(fault)
        return None if any(fault.path[:1] == PATH for fault in faults) else config

    def check(self) -> Iterator[str]:
        """Yields a fault for each setting that does not fit law, features or mode."""
        names, law = expand(self.features), LAWS.get(self.law)
        if law is None and self.law is not None:
            yield unknown_name("law", self.law, LAWS)
        if self.source and self.source not in SOURCES:
            yield unknown_name("source", self.source, SOURCES)
        yield from (unknown_name("stages", name, STAGES) for name in self.stages if name not in STAGES)
        if len(self.thresholds) != len(names) or not all(0.0 < value < inf for value in self.thresholds):
            yield f"thresholds: found {list(self.thresholds)}, allowed {len(names)} numbers > 0, as many as features"
        if self.filter is not None and law is not None and not law.foresees:
            yield f"filter: found with law '{self.law}', allowed with laws that need no more than features"
        if self.filter is not None and self.point_depth == "image":
            yield "filter: found with point_depth: image, allowed with depths that can be foreseen: plane, goal"
        if self.mode != "look_then_move":
            return
        if self.output != "joints":
            yield f"output: found {self.output} with mode: look_then_move, allowed joints: it moves to positions"
        if law is not None and law.continuous_only:
            yield f"mode: found look_then_move, allowed with law '{self.law}': continuous"
        for key in ("filter", "feed_forward", "track", "stages", "visibility", "limits", "out_of_reach"):
            if getattr(self, key) and getattr(self, key) != getattr(ServoSettings, key):
                yield f"{key}: found with mode: look_then_move, allowed with mode: continuous"
        for name, gain in zip(names, self.gains_per_s):
            if gain * self.sample_time_s >= 2.0:
                yield f"gains_per_s.{name}: found {gain}, allowed < 2 / sample_time_s (it would diverge)"

    def with_overrides(self, law: str = "", gains_per_s: Sequence[float] = (), thresholds: Sequence[float] = (),
                       time_limit_s: float = 0.0) -> "ServoSettings":
        """Returns a copy with the values of a goal of VisualServo.action; empty or 0 keeps. Raises ParameterError."""
        given = {"law": law, "gains_per_s": tuple(map(float, gains_per_s)), "thresholds": tuple(map(float, thresholds)),
                 "time_limit_s": time_limit_s}
        changed = replace(self, **{key: value for key, value in given.items() if value})
        faults = _law_faults(changed) or list(changed.check())
        if faults:
            raise ParameterError(faults)
        return changed


_BY_FEATURE = tuple(key.name for key in keys_of(ServoSettings) if key.by == "feature")


def _partial(source, faults, more):
    """Returns the valid settings, with defaults for the others and 1 for each invalid gain."""
    bad, values = {fault.path[:2] for fault in faults}, {}
    for key in keys_of(ServoSettings):
        right = key.name in source and (*PATH, key.name) not in bad
        values[key.name] = source[key.name] if right else None if key.required else key.default
    for table in _BY_FEATURE:
        given = {name: value for group, value in (values[table] or {}).items() for name in expand((group,))}
        values[table] = tuple(given.get(name, 1.0) for name in more["features"])
    return SimpleNamespace(**{**values, **more})


def _law_faults(config):
    """Faults that the law itself finds. Args: config: settings, or a part of them."""
    if config.law not in LAWS:
        return []
    setup = config if isinstance(config, LawSetup) else LawSetup(
        **{key.name: getattr(config, key.name) for key in fields(LawSetup)})
    try:
        LAWS[config.law](config.gains_per_s, setup)
    except ParameterError as error:
        return error.faults
    return []


def own_sections() -> Dict[str, type]:
    """Returns the sections of laws, features and stages that have settings of their own: name -> settings class.

    Raises ParameterError: two of them want the same section, or one that is a key of the servo already.
    """
    laws, features = law_settings(), feature_settings()
    stages = {name: stage.settings_class for name, stage in STAGES.items() if stage.settings_class}
    names = [*laws, *features, *stages]
    keys = {key.name for key in keys_of(ServoSettings)}
    taken = [name for name in dict.fromkeys(names) if name in keys or names.count(name) > 1]
    if taken:
        raise ParameterError([f"servo.{name}: found a law, feature or stage of this name with settings, allowed a name "
                              "that no other section and no key has" for name in taken])
    return {**laws, **features, **stages}


def servo_schema(sections: Mapping[str, type]) -> Dict[str, Any]:
    """Returns the JSON Schema of the section `servo`. Args: sections: as of `own_sections`."""
    return with_sections(schema_of(ServoSettings), sections)


def names_in(source: Any, key: str) -> Tuple[str, ...]:
    """Returns the names that a section's list holds, () if it is none; its faults are for the schema to tell."""
    names = source.get(key, ()) if isinstance(source, Mapping) else ()
    return tuple(name for name in names if isinstance(name, str)) if isinstance(names, (list, tuple)) else ()


def _target(uri, faults):
    """The planar target that a file describes, None for "" and after a fault."""
    if not uri or not isinstance(uri, str):
        return None
    try:
        return PlanarTarget(load_yaml(resolve_uri(uri, key="target_model"))["outlines_m"])
    except (ParameterError, KeyError, ValueError) as error:
        faults.append(Fault((*PATH, "target_model"), f"found {uri}, allowed the file of a planar target: {error}"))
        return None
