"""Scenarios: files that define a run. Loaded and checked without ROS and without a master."""

import copy
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np
import yaml

from ..arm.dynamics import with_dynamics, with_loops
from ..arm.kinematics import RobotKinematics
from ..arm.robot import kinematics_of
from ..arm.settings import DynamicsSettings
from ..ground.errors import ParameterError
from .check import check, longest_latencies
from .extends import anchored, cleared, load_resolved, located, with_places
from ..config.files import find_scenario, load_yaml, resolve_uri
from ..config.reader import read
from ..config.validate import Fault
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
        sweep: variations of a sweep, see docs/sweeps.md; {} if the file has none.
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
    path: Optional[Path] = None
    _base: Optional[Path] = field(default=None, repr=False)
    _files: Tuple[Path, ...] = field(default=(), repr=False, compare=False)
    _overrides: Dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    @property
    def urdf_path(self) -> Path:
        """Path of the robot's URDF. Raises ParameterError if it is missing."""
        return resolve_uri(self.robot["urdf"], self._base, "robot.urdf")

    @property
    def controllers_path(self) -> Path:
        """Path of the joint controllers' YAML. Raises ParameterError if it is missing."""
        return resolve_uri(self.robot["controllers"], self._base, "robot.controllers")

    def urdf_xml(self) -> str:
        """Returns the robot's URDF as text, with `robot.dynamics` where the scenario has it."""
        text = self.urdf_path.read_text(encoding="utf-8")
        return text if self._dynamics is None else with_dynamics(text, self._dynamics)

    def kinematics(self, calibrated: bool = True) -> RobotKinematics:
        """Returns the robot's kinematics; `calibrated`: with the camera where `robot.hand_eye` has it, if it does."""
        return kinematics_of(self.urdf_xml(), self.robot, calibrated)

    def believed_camera_info(self, camera_info: Dict[str, Any]) -> Dict[str, Any]:
        """Returns the intrinsics (fields of CameraInfo) of the moments: the true ones, unless a sweep perturbs them."""
        return camera_info

    def controllers(self) -> Dict[str, Any]:
        """Reads the joint controllers, ros_control layout: controller name -> {type, joint, pid, ...}, with the loops
        of `robot.dynamics`."""
        controllers = load_yaml(self.controllers_path)
        return controllers if self._dynamics is None else with_loops(controllers, self._dynamics)

    @property
    def _dynamics(self):
        section = self.robot.get("dynamics")
        return None if section is None else read(DynamicsSettings, section, "robot.dynamics")

    @property
    def longest_latencies(self) -> Tuple[float, ...]:
        """Returns the longest `latency_s` that each camera may have [s]: its images must not be stale when answered."""
        return tuple(longest_latencies(self.as_dict()))

    def goal_posture(self, kinematics: RobotKinematics) -> np.ndarray:
        """Returns the joint positions at the goal, (n,), in the order of `kinematics.joint_names`.

        A joint that the goal does not name stays where the simulator starts it: at `sim.initial_positions`, else at
        zero, within the joint's limits.
        """
        stay = np.clip(np.zeros(len(kinematics.joint_names)), kinematics.lower, kinematics.upper)
        goal = place_of(self.experiment["goal"], "experiment.goal", kinematics)
        return kinematics.vector({**kinematics.by_name(stay), **self.sim.get("initial_positions", {}),
                                  **(goal.joints or {})})

    def start_posture(self, kinematics: RobotKinematics) -> np.ndarray:
        """Returns the joint positions at the start, (n,); a joint that the start does not name stays at the goal's."""
        goal = self.goal_posture(kinematics)
        start = place_of(self.experiment["start"], "experiment.start", kinematics, goal)
        return kinematics.vector({**kinematics.by_name(goal), **(start.joints or {})})

    def as_dict(self) -> Dict[str, Any]:
        """Returns a nested dict, as in the file; a deep copy."""
        sections = {section: getattr(self, section) for section in SECTIONS + OPTIONAL_SECTIONS}
        return {"name": self.name, "description": self.description, **copy.deepcopy(
            {section: value for section, value in sections.items() if value or section in SECTIONS})}

    def as_yaml(self) -> str:
        """Returns the text of a file that is this scenario, whole, with absolute paths; it extends nothing."""
        document = self.as_dict()
        return yaml.safe_dump(anchored(document, self._base) if self._base else document, sort_keys=False)

    def with_overrides(self, overrides: Mapping[str, Any]) -> "Scenario":
        """Returns the same scenario with some values replaced, checked again.

        Args:
            overrides: dotted path -> value, e.g. {"servo.gains_per_s.xn": 2.0, "sim.seed": 7}; None removes a key.
        Raises:
            ParameterError: a path through a value that is not a section, or a value that is not allowed.
        """
        return _checked(self.as_dict(), self._base, self.path, self._files, overrides, str(self.path or self.name),
                        self._overrides)


def load_scenario(name_or_path: Union[str, Path], overrides: Optional[Mapping[str, Any]] = None) -> Scenario:
    """Loads and checks a scenario.

    Args:
        name_or_path: name of a file of config/scenarios (without .yaml), or path of a YAML file.
        overrides: dotted path -> value, as of `Scenario.with_overrides`; "robot" may be the name of an arm.
    Raises:
        ParameterError: no such scenario, not YAML, or faults in it: all of them, one line each, with file and line.
    """
    path = find_scenario(name_or_path)
    overrides = dict(overrides or {})
    robot = overrides.pop("robot") if isinstance(overrides.get("robot"), str) else None
    document, files = load_resolved(path, robot)
    return _checked(document, path.parent, path, tuple(files), overrides)


def scenario_from_dict(document: Mapping[str, Any], source: str = "scenario", base: Optional[Path] = None,
                       path: Optional[Path] = None) -> Scenario:
    """Checks a nested dict and makes a scenario of it.

    Args:
        document: as in a file, without `extends`.  source: its name in faults.  base: where relative file names start.
        path: of the file that it comes from.
    Raises:
        ParameterError: every fault, a line each.
    """
    return _checked(document, base, path, (), {}, source)


def _checked(document, base, path, files, overrides, source="scenario", before={}):
    """The `Scenario` of a document with overrides; `before` are those that it has already. Raises ParameterError."""
    document, faults = copy.deepcopy(document) if overrides else document, []
    for key, value in overrides.items():
        keys = tuple(key.split("."))
        try:
            _override(document, keys, value)
        except LookupError as error:
            faults.append(Fault(keys, str(error.args[0])))
    document, overrides = with_places(document, base or Path()), {**before, **overrides}
    faults += check(document, base)
    if faults:
        raise ParameterError(located(faults, document, files, overrides, source))
    document = cleared(document)
    sections = {section: document.get(section, {}) for section in SECTIONS + OPTIONAL_SECTIONS}
    return Scenario(name=document["name"], description=document.get("description", ""), path=path, _base=base,
                    _files=files, _overrides=dict(overrides), **sections)


def _override(document, keys, value):
    """Replaces the value under keys, in place; None removes it. Raises LookupError: the keys lead nowhere."""
    *parents, last = keys
    node = document
    for parent in parents:
        if isinstance(node, list):
            node = node[_index_of(node, parent)]
        elif isinstance(node, dict):
            node = node.setdefault(parent, {})
        else:
            raise LookupError("found a path through a value, allowed section.key")
    if isinstance(node, list):
        last = _index_of(node, last)
    elif not isinstance(node, dict):
        raise LookupError("found a path through a value, allowed section.key")
    if value is None and (isinstance(node, list) or last in node):
        del node[last]
    else:
        node[last] = copy.deepcopy(value)


def _index_of(entries, name):
    """Place of the entry of a list that has this name, as in files that extend others. Raises LookupError."""
    names = [entry.get("name") if isinstance(entry, dict) else None for entry in entries]
    if name not in names:
        raise LookupError(f"found no entry named '{name}', allowed one of {', '.join(filter(None, names)) or 'none'}")
    return names.index(name)
