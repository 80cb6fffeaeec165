"""Scenarios: the one file that says what a run is. Loaded and checked without ROS and without a master.

`load_scenario("experiment_1")` reads config/scenarios/experiment_1.yaml of this package, `load_scenario(PATH)` any
other file. Everything is checked against the schema first (schema.py); every fault is listed with its path and the line
of the file. A scenario may extend another one (extends.py); what is loaded is the whole.
"""

import copy
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import yaml

from ..ground.errors import ParameterError
from .check import check
from .extends import anchored, load_resolved, with_lines
from .files import find_scenario
from ..config.files import load_yaml, resolve_uri
from ..runs.settings import place_of

SECTIONS = ("robot", "sim", "time", "vision", "servo", "experiment")
OPTIONAL_SECTIONS = ("sweep", "real")


@dataclass(frozen=True)
class Scenario:
    """A checked scenario. The sections are plain dicts, as in the file: one per consumer.

    Attributes:
        name, description: of the file.  path: the file, or None if made from a dict.
        robot: urdf, controllers (resolvable URIs or paths), base_link, tip_link.
        sim: section of the simulator.  time: of its node only.  vision: of the moment extractor.
        servo: law, gains, stop rule, redundancy.  experiment: goal, start, reference depth, judge thresholds.
        sweep: what a sweep varies, see docs/sweeps.md; {} if the file has none.
        real: how a real arm is driven; {} if the file has none.
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
    real: dict = field(default_factory=dict)
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

    def believed_camera_info(self, camera_info):
        """Intrinsics with which the moments are computed: the true ones, unless a sweep perturbs them."""
        return camera_info

    def controllers(self):
        """The joint controllers, ros_control layout: dict of controller name -> {type, joint, pid, ...}."""
        return load_yaml(self.controllers_path)

    def goal_posture(self, kinematics):
        """Joint positions at the goal, (n,), in the order of `kinematics.joint_names`.

        A joint that the goal does not name stays where the simulator starts it: at `sim.initial_positions`, else at
        zero, within the joint's limits.
        """
        stay = np.clip(np.zeros(len(kinematics.joint_names)), kinematics.lower, kinematics.upper)
        return self._placed(kinematics, kinematics.by_name(stay), self.sim.get("initial_positions", {}),
                            place_of(self.experiment["goal"], "experiment/goal", kinematics).joints)

    def start_posture(self, kinematics):
        """Joint positions at the start of the servo, (n,); a joint that the start does not name stays at the goal's."""
        goal = self.goal_posture(kinematics)
        start = place_of(self.experiment["start"], "experiment/start", kinematics, goal)
        return self._placed(kinematics, kinematics.by_name(goal), start.joints)

    @staticmethod
    def _placed(kinematics, *places):
        """Joint vector; each joint has the position of the last place that names it."""
        return kinematics.vector({name: q for joints in places for name, q in joints.items()})

    def as_dict(self):
        """Nested dict, as in the file; a deep copy."""
        result = {"name": self.name, "description": self.description}
        result.update({section: copy.deepcopy(getattr(self, section)) for section in SECTIONS})
        result.update({section: copy.deepcopy(getattr(self, section))
                       for section in OPTIONAL_SECTIONS if getattr(self, section)})
        return result

    def as_yaml(self):
        """Text of a file that is this scenario, whole and from any folder: with nothing that it extends, and with files
        by their absolute paths where they are relative to its own."""
        document = self.as_dict()
        return yaml.safe_dump(anchored(document, self._base) if self._base else document, sort_keys=False)

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
    document, files = load_resolved(path)
    faults = faults_of(document, path.parent)
    if faults:
        raise ParameterError(with_lines(faults, files, document))
    scenario = _scenario(document, path.parent, path)
    return scenario.with_overrides(overrides) if overrides else scenario


def scenario_from_dict(document, source="scenario", base=None, path=None):
    """Check a nested dict (as in the file, without `extends`) and make a Scenario of it; relative file names start at
    `base`."""
    faults = faults_of(document, base)
    if faults:
        raise ParameterError([f"{source}: {fault}" for fault in faults])
    return _scenario(document, base, path)


def faults_of(document, base=None):
    """Faults of a scenario document, `dotted.path: what, allowed` each; of files that are missing too."""
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
    return faults


def _scenario(document, base, path):
    sections = {section: copy.deepcopy(document.get(section, {})) for section in SECTIONS + OPTIONAL_SECTIONS}
    return Scenario(name=document["name"], description=document.get("description", ""), path=path, _base=base,
                    **sections)
