"""Applies the section `robot.dynamics` of a scenario to the robot's URDF and to its controllers."""

from dataclasses import fields
from typing import Any, Dict, Iterator, Mapping
from xml.etree import ElementTree

from ..ground.errors import ModelError, ParameterError
from ..ground.registry import one_of
from .settings import DynamicsSettings

PAYLOAD_LINK = "payload"
#: Keys of the section that are attributes of <dynamics>; the last two are ours and no URDF's.
FRICTION = ("damping", "friction", "static_friction", "stribeck_velocity")
#: Types of controllers that drive one joint, by what they command.
TYPES = {"JointPositionController": "effort_controllers/JointPositionController",
         "JointVelocityController": "effort_controllers/JointVelocityController"}
EFFORT = "hardware_interface/EffortJointInterface"


def with_dynamics(urdf_xml: str, dynamics: DynamicsSettings) -> str:
    """Returns the URDF with this friction, this payload, and effort interfaces for the joints of `loops`.

    Raises:
        ModelError: the URDF is no XML.
        ParameterError: the URDF lacks a joint or link that the section names, each as "key: found X, allowed Y".
    """
    try:
        robot = ElementTree.fromstring(urdf_xml)
    except ElementTree.ParseError as error:
        raise ModelError(f"the URDF is no XML: {error}") from error
    joints = {joint.get("name", ""): joint for joint in robot.findall("joint")}
    links = [link.get("name", "") for link in robot.findall("link")]
    faults = [f"{key}.{name}: found an unknown joint, allowed {one_of(tuple(joints), name)}"
              for key in (*FRICTION, "loops") for name in getattr(dynamics, key) if name not in joints]
    payload = dynamics.payload
    if payload is not None and payload.link not in links:
        faults.append(f"payload.link: found {payload.link}, allowed {one_of(tuple(links), payload.link)}")
    if payload is not None and PAYLOAD_LINK in links:
        faults.append(f"payload: found a link {PAYLOAD_LINK} in the URDF, allowed a URDF without it")
    if faults:
        raise ParameterError(faults)
    for key in FRICTION:
        for name, value in getattr(dynamics, key).items():
            _child(joints[name], "dynamics").set(key, repr(float(value)))
    faults = [fault for name in {**dynamics.static_friction, **dynamics.stribeck_velocity}
              for fault in _static_faults(name, _child(joints[name], "dynamics"))]
    if faults:
        raise ParameterError(faults)
    for each in (each for transmission in robot.findall("transmission") for each in transmission.findall("joint")):
        if each.get("name") in dynamics.loops:
            _child(each, "hardwareInterface").text = EFFORT
    if payload is not None:
        link = ElementTree.SubElement(robot, "link", name=PAYLOAD_LINK)
        inertial = ElementTree.SubElement(link, "inertial")
        ElementTree.SubElement(inertial, "mass", value=repr(float(payload.mass_kg)))
        ElementTree.SubElement(inertial, "inertia", dict.fromkeys(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), "0"))
        joint = ElementTree.SubElement(robot, "joint", name=PAYLOAD_LINK + "_joint", type="fixed")
        ElementTree.SubElement(joint, "parent", link=payload.link)
        ElementTree.SubElement(joint, "child", link=PAYLOAD_LINK)
        ElementTree.SubElement(joint, "origin", xyz=" ".join(repr(float(value)) for value in payload.position_m))
    return ElementTree.tostring(robot, encoding="unicode")


def _static_faults(name: str, dynamics: ElementTree.Element) -> Iterator[str]:
    friction, at_rest = (float(dynamics.get(key, 0.0)) for key in ("friction", "static_friction"))
    if dynamics.get("static_friction") is None:
        yield f"static_friction.{name}: found none, allowed beside stribeck_velocity.{name} a friction at rest"
    elif dynamics.get("stribeck_velocity") is None:
        yield f"stribeck_velocity.{name}: found none, allowed beside static_friction.{name} a speed"
    elif at_rest < friction:
        yield f"static_friction.{name}: found {at_rest:g}, allowed >= {friction:g}, the Coulomb friction"


def with_loops(controllers: Mapping[str, Any], dynamics: DynamicsSettings) -> Dict[str, Any]:
    """Returns the controllers, name -> section, with the PIDs of `loops`. Raises ParameterError as `loop_faults`."""
    faults = list(loop_faults(controllers, dynamics))
    if faults:
        raise ParameterError(faults)
    return {name: _with_pid(section, dynamics.loops[section["joint"]])
            if isinstance(section, Mapping) and section.get("joint") in dynamics.loops else section
            for name, section in controllers.items()}


def loop_faults(controllers: Mapping[str, Any], dynamics: DynamicsSettings) -> Iterator[str]:
    """Yields a fault for each joint of `loops` that no controller of its own drives by position or velocity."""
    driven = {section.get("joint"): str(section.get("type")) for section in controllers.values()
              if isinstance(section, Mapping)}
    for name in dynamics.loops:
        if driven.get(name, "").rpartition("/")[2] not in TYPES:
            yield (f"loops.{name}: found {driven.get(name, 'no controller of this joint alone')}, allowed a joint with "
                   f"a {' or '.join(TYPES)}")


def _with_pid(section, loop):
    pid = {field.name: getattr(loop, field.name) for field in fields(loop)}
    return {**section, "type": TYPES[section["type"].rpartition("/")[2]], "pid": {**section.get("pid", {}), **pid}}


def _child(element, tag):
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found
