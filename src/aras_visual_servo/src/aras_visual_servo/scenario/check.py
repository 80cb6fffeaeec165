"""The check of a scenario: the schema, each section's own checks, and checks across sections. Lists every fault."""

import pathlib
from collections.abc import Iterator, Mapping
from typing import Any, Callable, List, Optional, Tuple

from ..arm.dynamics import FRICTION, loop_faults, with_dynamics
from ..arm.robot import kinematics_of
from ..arm.settings import DynamicsSettings
from ..config.files import load_yaml, resolve_uri
from ..config.plugins import load_plugins
from ..config.reader import Names, build, keyed
from ..config.validate import REMOVED, Fault, Path, shown, validate
from ..features.base import expand, source_of
from ..features.sources.base import known_sources, source_named
from ..ground.errors import ArasError, ParameterError
from ..ground.types import FEATURE_NAMES
from ..servo.settings import ServoSettings, names_in
from .schema import SECTIONS, default_of, scenario_schema


def check(document: Any, base: Optional[pathlib.Path] = None) -> List[Fault]:
    """Returns the faults of a scenario document, [] if there are none. Args: base: where relative file names start."""
    servo = document.get("servo") if isinstance(document, Mapping) else None
    faults = keyed(load_plugins(names_in(servo, "plugins")), ("servo",))
    try:
        schema = scenario_schema()
    except ParameterError as error:  # two plugins describe one section
        return faults + keyed(error.faults, ())
    validate(schema, document, (), faults)
    if isinstance(document, Mapping):
        value = _values(document, {fault.path for fault in faults})
        faults += _file_faults(value, base)
        joints = _joint_names(value, base)
        ServoSettings.checked(servo, faults, joints)
        read = {name: build(section, document.get(name, {}), (name,), faults, Names(joints=joints))
                for name, section in SECTIONS.items()}
        if read["robot"] is not None and read["robot"].dynamics is not None:
            faults += _dynamics_faults(read["robot"].dynamics, value, base)
        faults += [*_source_faults(value), *_eye_to_hand_faults(value), *_latency_faults(value, schema)]
    return list(dict.fromkeys(faults))


def _values(document, bad) -> Callable:
    """A function of a dotted key and a default: the value there, the default where it is missing or wrong."""
    def value(key, default=None):
        node, path = document, ()
        for part in key.split("."):
            path += (part,)
            if not isinstance(node, Mapping) or path in bad or node.get(part, REMOVED) in (None, REMOVED):
                return default
            node = node[part]
        return node
    return value


def _file_faults(value, base) -> Iterator[Fault]:
    files: List[Tuple[Path, Any]] = [(("robot", key), value(f"robot.{key}")) for key in ("urdf", "controllers")]
    files += [(("sim", "scene", "models", i, "file"), model["file"]) for i, model in _entries(value, "sim.scene.models")
              if "file" in model]
    for path, uri in files:
        try:
            if isinstance(uri, str) and uri:
                resolve_uri(uri, base, "")
        except ParameterError as error:
            yield Fault(path, error.faults[0])


def _entries(value, key):
    """(index, entry) of the tables of a list."""
    entries = value(key, [])
    return [(i, entry) for i, entry in enumerate(entries if isinstance(entries, list) else [])
            if isinstance(entry, Mapping)]


def _joint_names(value, base) -> Tuple[str, ...]:
    """Names of the arm's joints; () where robot and URDF do not tell them, which building the loop then reports."""
    try:
        urdf = resolve_uri(value("robot.urdf"), base).read_text(encoding="utf-8")
        robot = {key: value(f"robot.{key}") for key in ("base_link", "tip_link", "target_link")}
        return tuple(kinematics_of(urdf, robot, calibrated=False).joint_names)
    except (ArasError, OSError, ValueError, TypeError):
        return ()


def _dynamics_faults(dynamics: DynamicsSettings, value, base) -> Iterator[Fault]:
    """Checks the names of robot.dynamics against URDF and controllers; other faults of these are reported when
    the robot is made."""
    texts: List[str] = []
    try:
        texts += loop_faults(load_yaml(resolve_uri(value("robot.controllers"), base)), dynamics)
        with_dynamics(resolve_uri(value("robot.urdf"), base).read_text(encoding="utf-8"), dynamics)
    except ParameterError as error:
        texts += [fault for fault in error.faults if fault.startswith(("payload", "loops", *FRICTION))]
    except (ArasError, OSError, ValueError, TypeError):
        pass
    yield from keyed(texts, ("robot", "dynamics"))


def _source_faults(value) -> Iterator[Fault]:
    """Each feature needs the section of `vision` that makes it, and depths of the image need a depth camera."""
    chosen, vision = value("servo.source", ""), value("vision")
    names = [name for name in _features(value) if source_of(name) is not None]
    if not isinstance(vision, Mapping) or chosen not in ("", *(source.name for source in known_sources())):
        return
    for source in map(source_named, dict.fromkeys(chosen or str(source_of(name)) for name in names)):
        name = next(name for name in names if source.name in (chosen, source_of(name)))
        if source.section and source.section not in vision:
            yield Fault(("vision", source.section), f"found nothing, allowed a section, {{}} for its defaults: "
                                                    f"servo.features names {name}, which is made there", True)
        elif isinstance(vision.get(source.section, {}), Mapping) and not source.wants_depth(vision):
            for key, depths in (("point_depth", "image"), ("pose_from", "depth")):
                if value(f"servo.{key}") == depths:
                    path = ("vision", *([source.section] if source.section else []), "depth")
                    yield Fault(path, "found nothing, allowed a section, {} for its defaults: "
                                      f"servo.{key}: {depths} takes depths from there", True)


def _features(value):
    return expand(names_in({"features": value("servo.features", FEATURE_NAMES)}, "features"))


def _eye_to_hand_faults(value) -> Iterator[Fault]:
    """Where the arm carries the target, the target is there, and nothing is asked for that needs a moving camera."""
    link, without = value("robot.target_link"), "allowed without robot.target_link"
    if link is None:
        return
    for i, model in _entries(value, "sim.scene.models")[:1]:
        if model.get("attached_to") != link:
            yield Fault(("sim", "scene", "models", i, "attached_to"), f"found {shown(model.get('attached_to'))}, "
                        f"allowed {link}, which is the robot.target_link that carries the target", True)
    if value("servo.feed_forward") is not None:
        yield Fault(("servo", "feed_forward"), f"found a section, {without}: a target in the hand has no motion of its "
                    "own", True)
    for law in ("qp", "mpc"):
        if value(f"servo.{law}.walls"):
            yield Fault(("servo", law, "walls"), f"found walls, {without}: walls are for a camera that moves", True)
    for name in _features(value):
        if source_of(name) == "photometric":
            yield Fault(("servo", "features"), f"found {name}, {without}: the background does not move with the "
                        "target", True)


def longest_latencies(document: Mapping[str, Any]) -> List[float]:
    """Returns the longest `latency_s` that each camera of a checked document may have [s], >= 0."""
    value, schema = _values(document, ()), scenario_schema()
    return [_longest_latency_s(value, schema, _values(camera, ())) for _, camera in _entries(value, "sim.cameras")]


def _longest_latency_s(value, schema, here) -> float:
    """An image must be answered before it is stale, also one that comes a frame later, with the rounding of its time
    to ticks. Args: here: the values of the camera."""
    timeout_s = value("servo.input_timeout_s", ServoSettings.input_timeout_s)
    period_s = value("sim.period_s", default_of("sim.period_s", schema))
    return max(0.0, timeout_s - 1.0 / here("rate_hz", default_of("sim.cameras.rate_hz", schema)) - 2.0 * period_s)


def _latency_faults(value, schema) -> Iterator[Fault]:
    for i, camera in _entries(value, "sim.cameras"):
        here = _values(camera, ())
        try:
            latency_s, longest_s = here("latency_s", 0.0), _longest_latency_s(value, schema, here)
            if latency_s > longest_s:
                yield Fault(("sim", "cameras", i, "latency_s"), f"found {latency_s:g}, allowed <= {longest_s:.4g} s; "
                            "a longer input timeout allows more: servo.input_timeout_s - 1 / rate_hz - 2 sim.period_s",
                            True)
        except (TypeError, ArithmeticError, ValueError):  # one of them is no number: the schema says so
            continue
