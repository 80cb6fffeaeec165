"""Checks a URDF for visual servoing and lists all faults at once. No ROS."""

from math import isfinite
from pathlib import Path
from typing import Dict, Iterator, List, Optional
from xml.etree import ElementTree

import numpy as np

from ..config.files import resolve_uri
from ..ground.errors import ArasError, ParameterError
from ..ground.registry import one_of
from .home import SINGULAR, find_home, least_singular_value
from .kinematics import Kinematics

#: A position or limit beyond this is in degrees: no joint of an arm turns ten times around. [rad]
MOST_TURN_RAD = 20 * np.pi
#: Principal moments of a body fulfil a + b >= c; published figures are rounded to this part.
TRIANGLE = 1e-3
#: Hardware interfaces of transmissions for which there is a controller of positions.
INTERFACES = ("PositionJointInterface", "EffortJointInterface")
TURNING = ("revolute", "continuous", "prismatic")


def root_link(urdf_xml: str) -> str:
    """Returns the link without a parent. Raises ParameterError: no XML, or none or several such links."""
    robot = _parsed(urdf_xml)
    children = {joint.find("child").get("link") for joint in robot.iter("joint") if joint.find("child") is not None}
    roots = [name for name in _links(robot) if name not in children]
    if len(roots) != 1:
        raise ParameterError(f"root link: found {', '.join(roots) or 'none'}, allowed one link without a parent joint")
    return str(roots[0])


def moved_links(urdf_xml: str, camera_link: str) -> List[str]:
    """Returns the links that the joints of the chain to the camera move, from the root on."""
    parents = {joint.find("child").get("link"): joint for joint in _parsed(urdf_xml).findall("joint")}
    return [joint.find("child").get("link") for joint in _chain(parents, camera_link) if joint.get("type") != "fixed"]


def hardware_interfaces(urdf_xml: str) -> Dict[str, str]:
    """Returns joint -> hardware interface of its <transmission>, without `hardware_interface/`."""
    return {joint.get("name"): (joint.findtext("hardwareInterface") or "").strip().rpartition("/")[2]
            for transmission in _parsed(urdf_xml).findall("transmission") for joint in transmission.findall("joint")}


def shortcomings(urdf_xml: str, tip_link: str, camera_link: str, folder: Optional[Path] = None,
                 home: Optional[np.ndarray] = None) -> List[str]:
    """Returns a text for everything that the URDF lacks, [] for nothing.

    Args:
        tip_link: flange of the arm.  camera_link: optical frame, z along the view, x to the right of the image.
        folder: where relative names of mesh files start.
        home: (n,) posture in the order of the chain's sorted joint names; None searches one.
    """
    try:
        robot = _parsed(urdf_xml)
        base = root_link(urdf_xml)
    except ParameterError as error:
        return list(error.faults)
    parents = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    faults = [f"{what}: found no link {name}, allowed {one_of(_links(robot), name)}"
              for what, name in (("tip", tip_link), ("camera", camera_link)) if name not in _links(robot)]
    if camera_link in _links(robot) and tip_link in _links(robot) and not _rigid(parents, tip_link, camera_link):
        faults.append(f"camera: found {camera_link}, which moves against {tip_link}, allowed a link fixed to it")
    ends = [name for name in (camera_link, tip_link) if name in _links(robot)]
    chain = _chain(parents, ends[0]) if ends else list(parents.values())
    moving = [joint for joint in chain if joint.get("type") != "fixed"]
    faults += [fault for joint in moving for fault in _limit_faults(joint)]
    faults += [fault for joint in moving for fault in _inertia_faults(robot, joint.find("child").get("link"))]
    faults += [f"joint {name}: transmission: found {interface}, allowed {', '.join(INTERFACES)}"
               for name, interface in hardware_interfaces(urdf_xml).items()
               if interface not in ("", *INTERFACES) and name in [joint.get("name") for joint in moving]]
    faults += _mesh_faults(robot, folder)
    if not moving:
        faults.append(f"chain: found no moving joint from {base} to {tip_link}, allowed at least 4")
    elif not any(fault.startswith(("tip", "camera", "joint")) for fault in faults):
        faults += _home_faults(urdf_xml, base, camera_link, home)
    return faults


def _parsed(urdf_xml):
    try:
        robot = ElementTree.fromstring(urdf_xml)
    except ElementTree.ParseError as error:
        raise ParameterError(f"URDF: found no XML ({error}), allowed a URDF; xacro files are expanded first") from error
    if robot.tag != "robot":
        raise ParameterError(f"URDF: found <{robot.tag}>, allowed <robot>")
    return robot


def _links(robot):
    return [link.get("name") for link in robot.findall("link")]


def _chain(parents, link):
    """Joints from the root to a link."""
    chain = []
    while link in parents and parents[link] not in chain:
        chain.append(parents[link])
        link = parents[link].find("parent").get("link")
    return chain[::-1]


def _rigid(parents, one, other):
    """Whether no joint moves one link against the other."""
    def carrier(link):
        moving = [joint for joint in _chain(parents, link) if joint.get("type") != "fixed"]
        return moving[-1].get("name") if moving else None
    return carrier(one) == carrier(other)


def _number(node, key):
    """The attribute as a number; None where it is missing or no finite number."""
    try:
        value = float(node.get(key)) if node is not None else None
    except (TypeError, ValueError):
        return None
    return value if value is not None and isfinite(value) else None


def _limit_faults(joint) -> Iterator[str]:
    name, kind, limit = f"joint {joint.get('name')}", joint.get("type"), joint.find("limit")
    if kind not in TURNING:
        yield f"{name}: found type {kind}, allowed {', '.join(TURNING)} or fixed"
        return
    if joint.find("mimic") is not None:
        yield f"{name}: found <mimic>, allowed a joint that moves by itself"
    for key, unit in (("velocity", "m/s" if kind == "prismatic" else "rad/s"),
                      ("effort", "N" if kind == "prismatic" else "N m")):
        value = _number(limit, key)
        if value is None or value <= 0.0:
            found = None if limit is None else limit.get(key)
            yield f"{name}: limit.{key}: found {found or 'nothing'}, allowed > 0 [{unit}]"
    if kind == "continuous":
        return
    lower, upper = _number(limit, "lower"), _number(limit, "upper")
    if lower is None or upper is None or lower >= upper:
        yield (f"{name}: limit: found lower {lower}, upper {upper}, allowed lower < upper "
               f"[{'m' if kind == 'prismatic' else 'rad'}]")
    elif kind == "revolute" and max(-lower, upper) > MOST_TURN_RAD:
        yield f"{name}: limit: found {lower:g} to {upper:g}, allowed radians; these look like degrees"


def _inertia_faults(robot, link) -> Iterator[str]:
    """Faults of the body that a joint moves: the link, with links fixed to it that have a mass."""
    bodies, group = {}, [link]
    for name in group:
        group += [joint.find("child").get("link") for joint in robot.findall("joint")
                  if joint.get("type") == "fixed" and joint.find("parent").get("link") == name]
    for name in group:
        node = next((each for each in robot.findall("link") if each.get("name") == name), None)
        if node is not None and node.find("inertial") is not None:
            bodies[name] = node.find("inertial")
    if not bodies:
        yield f"link {link}: inertial: found nothing, allowed mass and inertia of the link that the joint moves"
    for name, inertial in bodies.items():
        mass = _number(inertial.find("mass"), "value")
        if mass is None or mass <= 0.0:
            if name == link:
                yield f"link {name}: mass: found {mass}, allowed > 0 [kg]"
            continue
        xx, yy, zz, xy, xz, yz = (_number(inertial.find("inertia"), key) for key in
                                  ("ixx", "iyy", "izz", "ixy", "ixz", "iyz"))
        if None in (xx, yy, zz):
            yield f"link {name}: inertia: found ixx {xx}, iyy {yy}, izz {zz}, allowed numbers > 0 [kg m^2]"
            continue
        xy, xz, yz = (value or 0.0 for value in (xy, xz, yz))
        a, b, c = np.linalg.eigvalsh(np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))
        if a <= 0.0 or a + b < c * (1.0 - TRIANGLE):
            yield (f"link {name}: inertia: found principal moments {a:.3g}, {b:.3g}, {c:.3g}, allowed three > 0 of "
                   "which no one is larger than the other two together [kg m^2]")


def _mesh_faults(robot, folder) -> Iterator[str]:
    for name in dict.fromkeys(mesh.get("filename", "") for mesh in robot.iter("mesh")):
        try:
            resolve_uri(name, folder, "mesh")
        except ParameterError as error:
            yield str(error)


def _home_faults(urdf_xml, base, camera_link, home) -> Iterator[str]:
    try:
        kinematics = Kinematics(urdf_xml, base, camera_link)
    except ArasError as error:
        yield f"chain: {error}"
        return
    if len(kinematics.joint_names) < 4:
        yield f"chain: found {len(kinematics.joint_names)} moving joints, allowed at least 4"
        return
    q, sigma = (home, least_singular_value(kinematics, home)) if home is not None else find_home(kinematics)
    if q is None:
        yield "home: found no posture in which the camera looks down, allowed one: is z of the camera's link its view?"
    elif sigma < SINGULAR:
        yield (f"home: found least singular value {sigma:.2g} of the Jacobian"
               f"{' in the best posture' if home is None else ''}, allowed >= {SINGULAR:g}: the arm has lost a motion "
               "there")
