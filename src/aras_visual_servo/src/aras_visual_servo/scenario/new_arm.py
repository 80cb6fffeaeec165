"""Makes the files of an arm from its URDF: joint controllers, and a scenario with a task that others are put under."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, List, Optional, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np
import yaml

from ..arm.home import find_home, points_of
from ..arm.kinematics import Kinematics
from ..arm.reach import reach
from ..arm.urdf_check import hardware_interfaces, moved_links, root_link, shortcomings
from ..ground.errors import ParameterError
from ..ground.registry import one_of
from ..spatial import rotation_rpy, rpy_of

#: From the goal camera to the start, in the goal camera's frame [m], and the turn about its axis [rad].
AWAY_M, AWAY_RAD = (-0.03, 0.025, -0.04), 0.2
#: Tilts at the start, of arms that can [rad].
AWAY_TILT_RAD = (0.08, -0.06)
#: PIDs of joints that take efforts: error that asks for the largest effort [m, rad], and d / p [s].
FULL_EFFORT_AT, DAMPED_S = 0.02, 0.025
SIX_AXES, FIVE_AXES = "six_dof_rectangle", "experiment_1"


@dataclass(frozen=True)
class NewArm:
    """Inputs of the files of a new arm.

    Attributes:
        name: of the arm and its scenario.  urdf: as the scenario names it.  controllers: as the scenario names them.
        tip_link: flange.  camera_link: optical frame; z_star_m: distance of the target from it at the goal [m].
        driver: name of the trajectory controller of the arm's driver, "" if there is none.
        home: joint -> position to begin the search of a home with, 0 where not named; or None.
    """

    name: str
    urdf: str
    controllers: str
    tip_link: str
    camera_link: str
    z_star_m: float = 0.45
    driver: str = ""
    home: Optional[Mapping[str, float]] = None


def with_camera_link(urdf_xml: str, tip_link: str, camera_link: str, xyz_m: Sequence[float],
                     rpy_rad: Sequence[float]) -> str:
    """Returns the URDF with one more link, the camera's optical frame at a place of the tip link [m, rad].

    Raises ParameterError: this is no XML, or it has a link of the camera's name.
    """
    try:
        robot = ElementTree.fromstring(urdf_xml)
    except ElementTree.ParseError as error:
        raise ParameterError(f"URDF: found no XML ({error}), allowed a URDF") from error
    links = [link.get("name") for link in robot.findall("link")]
    if camera_link in links:
        raise ParameterError(f"camera: found {camera_link} in the URDF already, allowed the name of a new link, or no "
                             "place for it")
    ElementTree.SubElement(robot, "link", name=camera_link)
    joint = ElementTree.SubElement(robot, "joint", name=f"{camera_link}_joint", type="fixed")
    ElementTree.SubElement(joint, "parent", link=tip_link)
    ElementTree.SubElement(joint, "child", link=camera_link)
    ElementTree.SubElement(joint, "origin", xyz=" ".join(map(repr, map(float, xyz_m))),
                           rpy=" ".join(map(repr, map(float, rpy_rad))))
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding="unicode") + "\n"


def arm_files(arm: NewArm, urdf_xml: str, folder: Optional[Path] = None) -> Tuple[str, str]:
    """Returns the texts of the scenario and of the joint controllers of an arm.

    Args:
        urdf_xml: the robot.  folder: where relative names of mesh files start.
    Raises:
        ParameterError: everything that the URDF lacks, as of `shortcomings`; or no start near the home is in reach.
    """
    faults = shortcomings(urdf_xml, arm.tip_link, arm.camera_link, folder)
    if faults:
        raise ParameterError(faults)
    base = root_link(urdf_xml)
    kinematics = Kinematics(urdf_xml, base, arm.camera_link)
    near = None if arm.home is None else _near(arm.home, kinematics)
    points = points_of(urdf_xml, base, moved_links(urdf_xml, arm.camera_link), kinematics.joint_names)
    goal, _ = find_home(kinematics, arm.z_star_m, near, points)
    if goal is None:
        raise ParameterError("home: found no posture near it in which the camera looks down, allowed one")
    goal = np.round(goal, 6)
    start = np.round(_start(kinematics, goal), 4)
    return (_yaml(_scenario(arm, base, kinematics, goal, start)),
            _yaml(_controllers(kinematics.joint_names, urdf_xml)))


def _near(home, kinematics):
    unknown = [name for name in home if name not in kinematics.joint_names]
    if unknown:
        raise ParameterError([f"home: found joint {name}, allowed {one_of(kinematics.joint_names, name)}"
                              for name in unknown])
    return np.array([home.get(name, 0.0) for name in kinematics.joint_names], dtype=float)


def _start(kinematics, goal):
    X, six = kinematics.pose(goal), len(goal) >= 6
    for part in (1.0, -1.0, 0.5, -0.5):
        away = np.eye(4)
        away[:3, :3] = rotation_rpy([part * angle for angle in (*(AWAY_TILT_RAD if six else (0.0, 0.0)), AWAY_RAD)])
        away[:3, 3] = part * np.array(AWAY_M)
        joints, _ = reach(kinematics, goal, X @ away)
        q = None if joints is None else kinematics.vector(joints)
        if q is not None and np.all((q >= kinematics.lower) & (q <= kinematics.upper)):
            return q
    raise ParameterError(f"start: found no posture {1e3 * float(np.linalg.norm(AWAY_M)):.0f} mm from the home in reach,"
                         " allowed one; name another home")


def _scenario(arm, base, kinematics, goal, start) -> Dict[str, Any]:
    X, n = kinematics.pose(goal), len(goal)
    down = X[:3, :3] @ np.diag([1.0, -1.0, -1.0])  # the target's face is seen, its x is the image's
    target = {"name": "target", "position_m": _list(X[:3, 3] + arm.z_star_m * X[:3, 2]), "rpy_rad": _list(rpy_of(down))}
    document: Dict[str, Any] = {
        "name": arm.name, "description": f"The arm {arm.name}: {n} joints, the camera on {arm.tip_link}.",
        "task": SIX_AXES if n >= 6 else FIVE_AXES,
        "robot": {"urdf": arm.urdf, "controllers": arm.controllers, "base_link": base, "tip_link": arm.camera_link},
        "sim": {"initial_positions": _joints(kinematics, goal), "scene": {"models": [target]}}}
    if arm.camera_link != "camera_optical_frame":
        document["sim"]["cameras"] = [{"name": "camera", "frame": arm.camera_link}]
    if n > 6:
        document["servo"] = {"null_space": {"manipulability_gain_per_s": 0.05}}
    document["experiment"] = {"goal": {"joints": _joints(kinematics, goal)},
                              "start": {"joints": _joints(kinematics, start)}, "z_star_m": arm.z_star_m}
    if arm.driver:
        document["real"] = {"command": "trajectory", "controller": arm.driver}
    return document


def _controllers(names, urdf_xml) -> Dict[str, Any]:
    joints: Dict[str, Dict[str, Any]] = {}
    interfaces = hardware_interfaces(urdf_xml)
    efforts = {joint.get("name"): float(joint.find("limit").get("effort", "0"))
               for joint in ElementTree.fromstring(urdf_xml).findall("joint") if joint.get("name") in names}
    for name in names:
        kind = "effort" if interfaces.get(name) == "EffortJointInterface" else "position"
        joints[f"{name}_position_controller"] = {"type": f"{kind}_controllers/JointPositionController", "joint": name}
        if kind == "effort":
            p = efforts[name] / FULL_EFFORT_AT
            joints[f"{name}_position_controller"]["pid"] = {"p": p, "i": p / 10, "d": p * DAMPED_S,
                                                            "i_clamp": efforts[name]}
    return {"joint_state_controller": {"type": "joint_state_controller/JointStateController", "publish_rate": 100},
            **joints}


def _joints(kinematics, q) -> Dict[str, float]:
    return {name: float(value) + 0.0 for name, value in zip(kinematics.joint_names, q)}


def _list(values) -> List[float]:
    return [round(float(value), 6) + 0.0 for value in values]


def _yaml(document):
    return yaml.safe_dump(document, sort_keys=False, default_flow_style=None, width=120)
