"""Scenarios: the one file that says what a run is. Loaded and checked without ROS and without a master.

`load_scenario("experiment_1")` reads config/scenarios/experiment_1.yaml of this package, `load_scenario(PATH)` any
other file. Everything is checked against config/scenario.schema.json first; every fault is listed with its path.
"""

import copy
import functools
import json
import math
import os
import re
from dataclasses import dataclass, field
from pathlib import Path

import yaml

from .errors import ParameterError
from .features import expand
from .types import FEATURE_NAMES

PACKAGE = "aras_visual_servo_controller"
SECTIONS = ("robot", "sim", "time", "vision", "servo", "experiment")
OPTIONAL_SECTIONS = ("sweep",)


@dataclass(frozen=True)
class Scenario:
    """A checked scenario. The sections are plain dicts, as in the file: one per consumer.

    Attributes:
        name, description: of the file.  path: the file, or None if made from a dict.
        robot: urdf, controllers (resolvable URIs or paths), base_link, tip_link.
        sim: section of the simulator.  time: of its node only.  vision: of the moment extractor.
        servo: law, gains, stop rule, redundancy.  experiment: goal, start, reference depth, judge thresholds.
        sweep: what a sweep varies, see docs/sweeps.md; {} if the file has none.
    """

    name: str
    description: str
    robot: dict
    sim: dict
    time: dict
    vision: dict
    servo: dict
    experiment: dict
    sweep: dict = field(default_factory=dict)
    path: Path = None
    _base: Path = field(default=None, repr=False)

    @property
    def urdf_path(self):
        """Path of the robot's URDF. Raises ParameterError if it is missing."""
        return resolve_uri(self.robot["urdf"], self._base, "robot.urdf")

    @property
    def controllers_path(self):
        """Path of the joint controllers' YAML. Raises ParameterError if it is missing."""
        return resolve_uri(self.robot["controllers"], self._base, "robot.controllers")

    def urdf_xml(self):
        """The robot's URDF as text."""
        return self.urdf_path.read_text(encoding="utf-8")

    #: Images that an answer is late by: it takes effect when that many more have been taken. A sweep may vary it.
    latency_images = 0

    def believed_camera_info(self, camera_info):
        """Intrinsics that the moments are computed with, of the true ones: the same, unless a sweep says otherwise."""
        return camera_info

    def controllers(self):
        """The joint controllers, ros_control layout: dict of controller name -> {type, joint, pid, ...}."""
        return load_yaml(self.controllers_path)

    def as_dict(self):
        """Nested dict, as in the file; a deep copy."""
        result = {"name": self.name, "description": self.description}
        result.update({section: copy.deepcopy(getattr(self, section)) for section in SECTIONS})
        result.update({section: copy.deepcopy(getattr(self, section))
                       for section in OPTIONAL_SECTIONS if getattr(self, section)})
        return result

    def with_overrides(self, overrides):
        """The same scenario with some values replaced, checked again.

        Args:
            overrides: dict of dotted path -> value, e.g. {"servo.gains_per_s.xn": 2.0, "sim.seed": 7}.
        Raises:
            ParameterError: a path that leads through something that is no section, or a value not allowed.
        """
        document = self.as_dict()
        for path, value in overrides.items():
            *parents, key = path.split(".")
            node = document
            for parent in parents:
                node = node.setdefault(parent, {}) if isinstance(node, dict) else None
            if not isinstance(node, dict):
                raise ParameterError(f"{path}: found a path through a value, allowed is section.key")
            node[key] = copy.deepcopy(value)
        return scenario_from_dict(document, source=str(self.path or self.name), base=self._base, path=self.path)


def load_scenario(name_or_path, overrides=None):
    """Load and check a scenario.

    Args:
        name_or_path: name of a file of config/scenarios (without .yaml), or path of a YAML file.
        overrides: dict of dotted path -> value, or None.
    Raises:
        ParameterError: no such scenario, not YAML, or faults in it: all of them, one line each.
    """
    path = find_scenario(name_or_path)
    scenario = scenario_from_dict(load_yaml(path), source=str(name_or_path), base=path.parent, path=path)
    return scenario.with_overrides(overrides) if overrides else scenario


def scenario_from_dict(document, source="scenario", base=None, path=None):
    """Check a nested dict (as in the file) and make a Scenario of it; relative file names start at `base`."""
    faults = check(document)
    if not faults:
        robot, models = document["robot"], document["sim"].get("scene", {}).get("models", [])
        files = [("robot.urdf", robot["urdf"]), ("robot.controllers", robot["controllers"])]
        files += [(f"sim.scene.models[{i}].file", model["file"]) for i, model in enumerate(models) if "file" in model]
        for key, uri in files:
            try:
                resolve_uri(uri, base, key)
            except ParameterError as error:
                faults.append(str(error))
    if faults:
        raise ParameterError([f"{source}: {fault}" for fault in faults])
    sections = {section: copy.deepcopy(document.get(section, {})) for section in SECTIONS + OPTIONAL_SECTIONS}
    return Scenario(name=document["name"], description=document.get("description", ""), path=path, _base=base,
                    **sections)


def check(document):
    """Faults of a scenario document, `path: what, allowed` each, sorted by path; [] if there are none."""
    faults = []
    for error in _validator().iter_errors(document):
        faults.extend(_describe(error))
    return sorted(set(faults or _feature_faults(document)))


def _feature_faults(document):
    """Gains and thresholds are one per feature, by name; the camera is told to make what the features are of."""
    servo = document["servo"]
    names, faults = expand(servo.get("features", FEATURE_NAMES)), []
    for section in ("gains_per_s", "thresholds"):
        given = expand(servo[section])
        faults += [f"servo.{section}.{name}: missing" for name in names if name not in given]
        faults += [f"servo.{section}.{key}: unknown key, known are {', '.join(names)}"
                   for key in given if key not in names]
    if "photometric" in names and "photometric" not in document["vision"]:
        faults.append("vision.photometric: missing, the feature 'photometric' is made there; {} for its defaults")
    return faults


def find_scenario(name_or_path):
    """Path of a scenario given by name or path. Raises ParameterError listing the known names."""
    text = os.path.expanduser(str(name_or_path))
    if os.sep in text or text.endswith((".yaml", ".yml")):
        if not os.path.isfile(text):
            raise ParameterError(f"scenario '{text}': no such file")
        return Path(text).resolve()
    folder = share_dir() / "config" / "scenarios"
    path = folder / f"{text}.yaml"
    if not path.is_file():
        known = ", ".join(scenario_names()) or "none"
        raise ParameterError(f"scenario '{text}': not found, known are {known} (or give a path)")
    return path


def scenario_names():
    """Names of the scenarios that come with the package, sorted."""
    return sorted(path.stem for path in (share_dir() / "config" / "scenarios").glob("*.yaml"))


def load_yaml(path):
    """A YAML file's content. Raises ParameterError with file and line if it is no YAML or no mapping."""
    try:
        with open(path, encoding="utf-8") as stream:
            document = yaml.load(stream, Loader=_UniqueKeyLoader)
    except yaml.YAMLError as error:
        raise ParameterError(f"{path}: not YAML: {error}") from error
    if not isinstance(document, dict):
        raise ParameterError(f"{path}: found {type(document).__name__}, allowed is a mapping of sections")
    return document


def resolve_uri(uri, base=None, key="file"):
    """Path of `package://PACKAGE/REST`, `file://PATH`, an absolute path, or a path relative to `base`.

    Raises:
        ParameterError: no such package or file; the text starts with `key`.
    """
    text = str(uri)
    if text.startswith("package://"):
        name, _, rest = text[len("package://"):].partition("/")
        folder = package_path(name)
        if folder is None:
            raise ParameterError(f"{key}: found '{text}', package '{name}' is neither beside this one nor in "
                                 "ROS_PACKAGE_PATH")
        path = folder / rest
    else:
        path = Path(text[len("file://"):] if text.startswith("file://") else os.path.expanduser(text))
        if not path.is_absolute():
            path = Path(base or ".") / path
    if not path.is_file():
        raise ParameterError(f"{key}: found '{text}', no such file: {path}")
    return path


@functools.lru_cache(maxsize=None)
def _package_path(name, ros_package_path):
    folders = [Path(entry) for entry in ros_package_path.split(os.pathsep) if entry]
    for folder in folders + [share_dir().parent]:
        if (folder / name / "package.xml").is_file():
            return folder / name
    try:
        import rospkg  # the crawl through nested folders is slow: last
        return Path(rospkg.RosPack().get_path(name))
    except Exception:  # rospkg not installed, or ResourceNotFound: either way the package is not known
        return None


def package_path(name):
    """Folder of a ROS package: in ROS_PACKAGE_PATH, else beside this package; None if unknown."""
    return _package_path(name, os.environ.get("ROS_PACKAGE_PATH", ""))


def package_paths(*names):
    """Dict of package name -> folder (str) of the known ones, for `Simulation(package_paths=...)`."""
    names = names or ("aras_description", PACKAGE)
    return {name: str(package_path(name)) for name in names if package_path(name) is not None}


@functools.lru_cache(maxsize=None)
def share_dir():
    """Folder of this package's config: in the source tree, else PREFIX/share of the installed package."""
    for parent in Path(__file__).resolve().parents:
        if (parent / "package.xml").is_file() and (parent / "config").is_dir():
            return parent
        if (parent / "share" / PACKAGE / "config").is_dir():
            return parent / "share" / PACKAGE
    raise ParameterError(f"the config folder of {PACKAGE} is missing: the package is not installed whole")


@functools.lru_cache(maxsize=None)
def _validator():
    import jsonschema
    with open(share_dir() / "config" / "scenario.schema.json", encoding="utf-8") as stream:
        schema = json.load(stream)
    jsonschema.Draft7Validator.check_schema(schema)
    # YAML knows .nan and .inf, JSON does not: a number is a finite one.
    is_number = jsonschema.Draft7Validator.TYPE_CHECKER.is_type
    checker = jsonschema.Draft7Validator.TYPE_CHECKER.redefine(
        "number", lambda _, value: is_number(value, "number") and math.isfinite(value))
    return jsonschema.validators.extend(jsonschema.Draft7Validator, type_checker=checker)(schema)


def _describe(error):
    """Lines for one jsonschema error, in our words."""
    where = _dotted(error.absolute_path)
    if error.validator == "additionalProperties":
        known = sorted(error.schema.get("properties", {}))
        unknown = sorted(set(error.instance) - set(known))
        return [f"{_dotted(list(error.absolute_path) + [key])}: unknown key, known are {', '.join(known)}"
                for key in unknown]
    if error.validator == "required":
        missing = [key for key in error.validator_value if key not in error.instance]
        return [f"{_dotted(list(error.absolute_path) + [key])}: missing" for key in missing]
    allowed = {
        "type": lambda v: "a finite number" if v == "number" else v,
        "enum": lambda v: " | ".join(map(str, v)),
        "minimum": lambda v: f">= {v}", "maximum": lambda v: f"<= {v}",
        "exclusiveMinimum": lambda v: f"> {v}", "exclusiveMaximum": lambda v: f"< {v}",
        "minItems": lambda v: f"at least {v} entries", "maxItems": lambda v: f"at most {v} entries",
        "minProperties": lambda v: f"at least {v} key(s)", "pattern": lambda v: f"text like {v}",
    }.get(error.validator, lambda v: f"{error.validator} {v}")(error.validator_value)
    return [f"{where}: found {_short(error.instance)}, allowed {allowed}{_number_hint(error.instance)}"]


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


class _UniqueKeyLoader(yaml.SafeLoader):
    """SafeLoader that refuses a key given twice (YAML would silently take the last)."""

    def construct_mapping(self, node, deep=False):
        seen = set()
        for key_node, _ in node.value:
            key = self.construct_object(key_node, deep=True)
            if key in seen:
                raise yaml.constructor.ConstructorError(None, None, f"key '{key}' is given twice", key_node.start_mark)
            seen.add(key)
        return super().construct_mapping(node, deep=deep)
