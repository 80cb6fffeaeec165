"""Checks a scenario: the schema's errors in our words, and the checks that a schema cannot express."""

import functools
import re

from ..config.plugins import load_plugins
from ..config.reader import is_number
from ..features.base import expand, source_of
from ..features.sources import known_sources, source_named
from ..ground.errors import ParameterError
from ..ground.types import FEATURE_NAMES
from ..servo.settings import ServoSettings
from .schema import default_of, scenario_schema, sources


def check(document):
    """Faults of a scenario document, `path: what, allowed` each, sorted by path; [] if there are none."""
    missing, faults = load_plugins(_plugins(document)), []
    try:
        validator, schema = _validator(sources())
    except ParameterError as error:
        return error.faults
    for error in validator.iter_errors(document):
        faults.extend(_describe(error))
    if faults:  # a missing plugin may be the cause; if it is the only fault, setting up the servo reports it
        faults += [f"servo.{fault}" for fault in missing]
    return sorted(set(faults or _feature_faults(document) + _latency_faults(document, schema)
                      + _place_faults(document) + _eye_to_hand_faults(document)))


def _plugins(document):
    """Modules to import before it is known what the section `servo` may say; () where there is no list of names."""
    servo = document.get("servo") if isinstance(document, dict) else None
    names = servo.get("plugins") if isinstance(servo, dict) else None
    return [name for name in names if isinstance(name, str)] if isinstance(names, list) else ()


def _feature_faults(document):
    """Faults of features: each needs a gain and a threshold by its name, and a camera that makes its source."""
    servo = document["servo"]
    names, faults = expand(servo.get("features", FEATURE_NAMES)), []
    for section in ("gains_per_s", "thresholds"):
        given = expand(servo[section])
        faults += [f"servo.{section}.{name}: missing" for name in names if name not in given]
        faults += [f"servo.{section}.{key}: unknown key, known are {', '.join(names)}"
                   for key in given if key not in names]
    chosen = servo.get("source", "")
    if chosen and chosen not in [source.name for source in known_sources()]:
        return faults + [f"servo.source: found '{chosen}', allowed {', '.join(one.name for one in known_sources())}"]
    for name in names:
        source = chosen or source_of(name)
        section = "" if source is None else source_named(source).section
        if section and section not in document["vision"]:
            faults.append(f"vision.{section}: missing, the feature '{name}' is made there; {{}} for its defaults")
    return faults or _depth_faults(document, chosen or source_of(names[0]))


def _depth_faults(document, source):
    """Faults of depths: who takes them from the depth image needs one."""
    servo, vision = document["servo"], document["vision"]
    asked = [f"servo.{key}: {value}" for key, value in (("point_depth", "image"), ("pose_from", "depth"))
             if servo.get(key) == value]
    if not asked or source_named(source).wants_depth(vision):
        return []
    section = source_named(source).section
    return [f"vision.{section + '.' if section else ''}depth: missing, {' and '.join(asked)} takes depths from there; "
            "{} for its defaults"]


def _place_faults(document):
    """Faults of goal and start: each is given by joints or by the camera's pose."""
    faults = []
    for name in ("goal", "start"):
        given = [key for key in ("joints", "camera") if document["experiment"][name].get(key)]
        if len(given) != 1:
            faults.append(f"experiment.{name}: found {' and '.join(given) or 'neither'}, allowed joints or camera")
    return faults


def _eye_to_hand_faults(document):
    """Faults of a scenario in which the arm carries the target: it is not where `robot.target_link` says, or something
    is asked for that has no meaning when the camera stands still."""
    link, servo = document["robot"].get("target_link"), document["servo"]
    if link is None:
        return []
    models, faults = document["sim"].get("scene", {}).get("models", []), []
    if models and models[0].get("attached_to") != link:
        faults.append(f"sim.scene.models[0].attached_to: found {models[0].get('attached_to', 'nothing')}, allowed "
                      f"{link}, the robot.target_link that carries the target")
    if servo.get("feed_forward") is not None:
        faults.append("servo.feed_forward: found with robot.target_link, allowed without: a target in the hand has no "
                      "motion of its own")
    faults += [f"servo.{law}.walls: found with robot.target_link, allowed without: walls are for a camera that moves"
               for law in ("qp", "mpc") if (servo.get(law) or {}).get("walls")]
    whole = [name for name in expand(servo.get("features", FEATURE_NAMES)) if source_of(name) == "photometric"]
    faults += [f"servo.features: found {name} with robot.target_link, allowed features of the target alone: what "
               "stands behind the target does not move with it" for name in whole]
    return faults


def _latency_faults(document, schema):
    """Faults of latencies: an image must be answered before it is stale, also one that comes a frame later, with the
    rounding of its time to ticks."""
    sim, faults = document["sim"], []
    timeout_s = document["servo"].get("input_timeout_s", ServoSettings.input_timeout_s)
    period_s = sim.get("period_s", default_of("sim.period_s", schema))
    rate_hz = default_of("sim.cameras.rate_hz", schema)
    for i, camera in enumerate(sim.get("cameras", [])):
        latency_s, frame_s = camera.get("latency_s", 0.0), 1.0 / camera.get("rate_hz", rate_hz)
        longest_s = timeout_s - frame_s - 2.0 * period_s
        if latency_s > max(0.0, longest_s):
            faults.append(f"sim.cameras[{i}].latency_s: found {latency_s:g}, allowed <= servo.input_timeout_s - "
                          f"1 / rate_hz - 2 sim.period_s = {longest_s:.4g}")
    return faults


@functools.lru_cache(maxsize=4)
def _validator(made_of):
    """(validator, schema). Args: made_of: `sources` of the schema."""
    import jsonschema  # slow to import
    # YAML knows .nan and .inf, JSON does not: a number is a finite one.
    checker = jsonschema.Draft7Validator.TYPE_CHECKER.redefine("number", lambda _, value: is_number(value))
    schema = scenario_schema()
    return jsonschema.validators.extend(jsonschema.Draft7Validator, type_checker=checker)(schema), schema


def _describe(error):
    """Lines for one jsonschema error, in our words."""
    where = _dotted(error.absolute_path)
    if error.validator == "additionalProperties":
        known = sorted(error.schema.get("properties", {}))
        unknown = sorted(set(error.instance) - set(known), key=str)
        return [f"{_dotted(list(error.absolute_path) + [key])}: unknown key, known are {', '.join(known)}"
                for key in unknown]
    if error.validator == "required":
        missing = [key for key in error.validator_value if key not in error.instance]
        return [f"{_dotted(list(error.absolute_path) + [key])}: missing" for key in missing]
    if error.validator in ("anyOf", "oneOf"):
        return _describe_kinds(error, where)
    allowed = {
        "type": lambda v: "a finite number" if v == "number" else v,
        "enum": lambda v: " | ".join(map(str, v)), "const": str,
        "minimum": lambda v: f">= {v}", "maximum": lambda v: f"<= {v}",
        "exclusiveMinimum": lambda v: f"> {v}", "exclusiveMaximum": lambda v: f"< {v}",
        "minItems": lambda v: f"at least {v} entries", "maxItems": lambda v: f"at most {v} entries",
        "minProperties": lambda v: f"at least {v} key(s)", "pattern": lambda v: f"text like {v}",
    }.get(error.validator, lambda v: f"{error.validator} {v}")(error.validator_value)
    return [f"{where}: found {_short(error.instance)}, allowed {allowed}{_number_hint(error.instance)}"]


def _describe_kinds(error, where):
    """Lines for a value of which there are several kinds. Maps are told apart by keys that have one fixed value, other
    values by their type."""
    told_by = set.intersection(*({key for key, value in kind.get("properties", {}).items() if "const" in value}
                                 for kind in error.validator_value))
    if isinstance(error.instance, dict) and told_by - set(error.instance):
        return [f"{_dotted(list(error.absolute_path) + [key])}: missing" for key in told_by - set(error.instance)]
    kinds, differing = {}, {}  # differing: place -> (what stands there, what the kinds have there)
    for fault in error.context:
        kinds.setdefault(fault.schema_path[0], []).append(fault)
    for number, faults in list(kinds.items()):
        for fault in faults:
            if fault.validator == "const" or (fault.validator in ("type", "enum") and not fault.path):
                del kinds[number]
                value = fault.validator_value if isinstance(fault.validator_value, list) else [fault.validator_value]
                differing.setdefault(_dotted(fault.absolute_path), (fault.instance, []))[1].extend(map(str, value))
                break
    if kinds:  # the faults of the kind that is meant, or of all kinds that it may be
        return [line for faults in kinds.values() for fault in faults for line in _describe(fault)]
    if not differing:
        return [f"{where}: found {_short(error.instance)}, which is of two kinds at once"]
    return [f"{place}: found {_short(found)}, allowed {' | '.join(dict.fromkeys(allowed))}{_number_hint(found)}"
            for place, (found, allowed) in differing.items()]


def _number_hint(value):
    """YAML 1.1 takes 5e-5 for text: say how to write it."""
    if isinstance(value, str) and re.fullmatch(r"[+-]?\d+[eE][+-]?\d+", value):
        mantissa, exponent = re.split("[eE]", value)
        return f"; to YAML this is text, write {mantissa}.0e{int(exponent):+d}"
    return ""


def _dotted(path):
    text = "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in path)
    return text.lstrip(".") or "scenario"


def _short(value):
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
