"""Changes of a scenario while it runs: put values into it, and tell what acts at once and what after a reset."""

import copy
import re
from typing import Any, Dict, Sequence

from aras_visual_servo import FEATURE_NAMES, ParameterError, Scenario, expand, feature_class, scenario_from_dict

#: Settings that act on the next image; the others wait for a reset.
AT_ONCE = (r"servo\..*", r"sim\.cameras\.\d+\.(noise_mean|noise_stddev|drop_probability|latency_s|exposure_s"
           r"|exposure_samples|sensor|sampling|renderer|quality|gl|exact_targets|near_m|far_m)(\..*)?",
           r"sim\.scene\.(background_rgb|light_direction|lighting).*", r"experiment\..*", r"name", r"description")
#: Where a feature that has just been chosen begins, until it is changed: its gain and its threshold by unit.
GAIN_PER_S, THRESHOLDS = 1.0, {"m": 5e-4, "rad": 1e-3}
THRESHOLD = 1e-3


def acts_at_once(path: str, patterns: Sequence[str] = AT_ONCE) -> bool:
    """Whether a change of this setting acts on the next image."""
    return any(re.fullmatch(pattern, path) for pattern in patterns)


def changed(scenario: Scenario, values: Any) -> Scenario:
    """The scenario with these values put in, checked as a whole.

    Args: values: dict of dotted path -> value; a number in a path is the place in a list; None takes a key out.
    Raises: ParameterError: a path leads nowhere, or a value is not allowed.
    """
    if not isinstance(values, dict) or not values:
        raise ParameterError(f"set.values: found {values!r}, allowed an object of path -> value")
    document = scenario.as_dict()
    for path, value in values.items():
        put(document, path, copy.deepcopy(value))
    if "servo.features" in values:
        _complete(document["servo"])
    return scenario_from_dict(document, source="settings", base=scenario._base, path=scenario.path)


def put(document: Dict[str, Any], path: str, value: Any) -> None:
    """Put a value into nested dicts and lists. Raises ParameterError: the path leads nowhere."""
    *parents, key = path.split(".")
    node = document
    for parent in parents:
        if isinstance(node, list):
            node = node[int(parent)] if parent.isdigit() and int(parent) < len(node) else None
        elif isinstance(node, dict):
            node = node.setdefault(parent, {})
        if not isinstance(node, (dict, list)):
            raise ParameterError(f"{path}: found an unknown path, allowed section.key")
    if isinstance(node, list):
        if not (key.isdigit() and int(key) < len(node)):
            raise ParameterError(f"{path}: found place {key} of a list of {len(node)}, allowed 0 to {len(node) - 1}")
        node[int(key)] = value
    elif value is None:
        node.pop(key, None)
    else:
        node[key] = value


def _complete(servo):
    """Give each feature a gain and a threshold, and take out those of features that are no longer there."""
    names = servo.get("features", FEATURE_NAMES)
    single = expand(names if isinstance(names, (list, tuple)) else ())
    for section, default in (
            ("gains_per_s", lambda _: GAIN_PER_S),
            ("thresholds", lambda name: THRESHOLDS.get(getattr(feature_class(name), "unit", "-"), THRESHOLD))):
        given = servo.get(section, {})
        kept = {key: value for key, value in given.items() if set(expand((key,))) <= set(single)}
        have = {name for key in kept for name in expand((key,))}
        usual = min((value for value in given.values()), default=None) if section == "gains_per_s" else None
        for name in names:
            if not set(expand((name,))) <= have:
                kept[name] = usual or default(name)
        servo[section] = kept
