"""The schema of a scenario: sections of this package, of the simulator and of the camera, put together."""

import functools
from dataclasses import dataclass
from typing import Any, Dict, Optional

from ..arm.settings import DynamicsSettings, HandEyeSettings
from ..config.files import package_path
from ..config.schema import schema_of, yaml_section
from ..config.settings import setting
from ..config.tables import part_of
from ..arm.real import RealSettings
from ..runs.settings import ExperimentSettings
from ..servo.settings import own_sections, servo_schema
from .sweep import Perturbations, SweepSection

#: Sections that other packages read and describe: name -> package.
ELSEWHERE = {"sim": "aras_visual_servo_sim", "time": "aras_visual_servo_sim", "vision": "aras_visual_servo_camera"}
REQUIRED = ("name", "robot", "sim", "vision", "servo", "experiment")
#: The name of a folder, and never that of the folder above.
NAME = r"^(?!\.+$)[A-Za-z0-9_.-]+$"


@dataclass(frozen=True)
class RobotSettings:
    """Section `robot`: the arm. Files are `package://PACKAGE/PATH`, absolute, or relative to the scenario."""

    urdf: str = setting(not_empty=True, help="File of the robot's URDF.")
    controllers: str = setting(not_empty=True, help="File of its joint controllers, in ros_control's layout.")
    base_link: str = setting(
        not_empty=True, help="First link of the chain that carries the camera or the target.")
    tip_link: str = setting(
        not_empty=True, help="Optical frame of the camera; last link of the chain if the arm carries the camera.")
    target_link: Optional[str] = setting(
        None, not_empty=True,
        help="Eye-to-hand: link that carries the target in front of a fixed camera. Camera poses "
             "(experiment.goal.camera) are then in its frame. None: the arm carries the camera.")
    hand_eye: Optional[HandEyeSettings] = setting(
        None,
        help="Calibrated camera pose, used by the controller instead of tip_link.")
    joint_offsets: Dict[str, float] = setting(
        {}, unit="m, rad", by="joint",
        help="True minus reported position by joint, from `aras-servo calibrate joint_offsets`. The controller "
             "corrects positions by it; set-points stay those of the arm.")
    dynamics: Optional[DynamicsSettings] = setting(
        None,
        help="Friction, loops and payload that replace those of URDF and controllers' file. `aras-servo identify` "
             "writes it.")


#: Sections that settings classes of this package describe; `servo` has those of laws and features too.
SECTIONS = {"robot": RobotSettings, "experiment": ExperimentSettings, "sweep": SweepSection, "real": RealSettings}


def scenario_schema() -> Dict[str, Any]:
    """Returns the JSON Schema (draft 7) of a scenario, with the sections of all laws and features registered so far.

    Raises ParameterError: a section is missing, or two describe the same.
    """
    return _schema(tuple(own_sections().items()), tuple(package_path(package) for package in ELSEWHERE.values()))


def default_of(name: str, schema: Optional[Dict[str, Any]] = None) -> Any:
    """Returns the default of a key, e.g. of "sim.cameras.rate_hz". KeyError: it has no default."""
    return part_of((schema or scenario_schema())["properties"], name)["default"]


@functools.lru_cache(maxsize=4)
def _schema(own, folders):
    properties = {
        "name": {"type": "string", "pattern": NAME, "description": "Name of the scenario, and of the folder "
                 "of its results: letters, digits, _ . -, not only dots."},
        "description": {"type": "string", "description": "What it is, in a line."},
        "robot": schema_of(RobotSettings),
        **{name: yaml_section(package, name) for name, package in ELSEWHERE.items()},
        "servo": servo_schema(dict(own)),
        **{name: schema_of(section) for name, section in SECTIONS.items() if name != "robot"},
    }
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": "ARAS Visual Servo scenario",
            "type": "object", "additionalProperties": False, "required": list(REQUIRED), "properties": properties}


def described_sections() -> Dict[str, Dict[str, Any]]:
    """Returns the schema of every section that has a table in some page. Names with a dot are parts of a section."""
    return {**scenario_schema()["properties"], "sweep.perturb": schema_of(Perturbations)}
