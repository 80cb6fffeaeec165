"""Removes the parts of a URDF that the simulator rejects. It checks documents of one link or joint each.

This finds faults that only the simulator detects, such as an unreadable mesh. A URDF that the simulator accepts as a
whole needs no such checks.
"""
import copy
import typing
import xml.etree.ElementTree as ElementTree

from ..faults import told
from .mend import MOMENTS, Warnings, hold
from .plain_mesh import plain_copy

SCHEME = "file://"
WHITE = "1 1 1 1"  #: visuals without a material
BALL_M = 0.01  #: radius of the ball whose inertia stands for none
#: Asks the simulator: what it says of a document, "" where it takes it. The second is whether it is the whole model,
#: else it is a part of it, whose root has a mass.
Ask = typing.Callable[[ElementTree.Element, bool], str]


def without_refused(robot: ElementTree.Element, ask: Ask) -> typing.Tuple[ElementTree.Element, Warnings]:
    """Returns a copy of a URDF without the parts that the simulator refuses, and a line for each of them.

    The copy may still be rejected, for a fault that no single part causes.

    Args: robot: root element, whose tree was checked.  ask: returns the fault of a document, "" if there is none.
    """
    mended = copy.deepcopy(robot)
    warnings: Warnings = []
    for link in mended.findall("link"):
        _ask_shapes(link, ask, warnings)
    for gazebo in mended.findall("gazebo"):
        _ask_tags(mended, gazebo, ask, warnings)
    for joint in mended.findall("joint"):
        _ask_joint(joint, ask, warnings)
    for transmission in mended.findall("transmission"):
        _ask_transmission(mended, transmission, ask, warnings)
    if ask(mended, True):
        _fill_inertia(mended, ask, warnings)
    _leave_out(mended, ask, warnings)
    return mended, warnings


def cause(fault: str, what: str) -> str:
    """Returns the simulator's message about a part, without the leading name."""
    return fault.replace(what + ": ", "", 1)


def _document(*elements: ElementTree.Element) -> ElementTree.Element:
    robot = ElementTree.Element("robot", name="part")
    robot.extend(elements)
    return robot


def _bare(name: str, *children: ElementTree.Element) -> ElementTree.Element:
    """A <link> of 1 kg."""
    link = ElementTree.Element("link", name=name)
    inertial = ElementTree.SubElement(link, "inertial")
    ElementTree.SubElement(inertial, "mass", value="1")
    ElementTree.SubElement(inertial, "inertia", ixx="1", ixy="0", ixz="0", iyy="1", iyz="0", izz="1")
    link.extend(children)
    return link


def _ask_shapes(link: ElementTree.Element, ask: Ask, warnings: Warnings) -> None:
    name = link.get("name", "")
    for part in link.findall("visual") + link.findall("collision"):
        fault = ask(_document(_bare(name, part)), False)
        if not fault:
            continue
        what = "link '%s': <%s>" % (name, part.tag)
        for mend in (_without_material, _without_pictures):
            plain = mend(part)
            if plain is not None and not ask(_document(_bare(name, plain)), False):
                link.insert(list(link).index(part), plain)
                warnings.append(told("texture", what, cause(fault, what)))
                break
        else:
            warnings.append(told("shape", what, cause(fault, what)))
        link.remove(part)


def _without_material(part: ElementTree.Element) -> typing.Optional[ElementTree.Element]:
    if part.find("material/texture") is None:
        return None
    plain = copy.deepcopy(part)
    for material in plain.findall("material"):
        plain.remove(material)
    ElementTree.SubElement(ElementTree.SubElement(plain, "material", name=""), "color", rgba=WHITE)
    return plain


def _without_pictures(part: ElementTree.Element) -> typing.Optional[ElementTree.Element]:
    mesh = part.find("geometry/mesh")
    path = None if mesh is None else plain_copy(mesh.get("filename", "").replace(SCHEME, "", 1))
    if path is None:
        return None
    plain = copy.deepcopy(part)
    for mesh in plain.findall("geometry/mesh"):
        mesh.set("filename", SCHEME + path)
    return plain


def _ask_tags(robot: ElementTree.Element, gazebo: ElementTree.Element, ask: Ask, warnings: Warnings) -> None:
    """Checks each child of a <gazebo> tag of a link."""
    reference = gazebo.get("reference", "")
    link = next((each for each in robot.findall("link") if each.get("name") == reference), None)
    if link is None:
        return
    alone = _bare(reference, *link.findall("visual"))
    for child in list(gazebo):
        tag = ElementTree.Element("gazebo", reference=reference)
        tag.append(child)
        fault = ask(_document(alone, tag), False)
        if fault:
            gazebo.remove(child)
            key = child.tag if child.tag in ("sensor", "light") else "look"
            name = " '%s'" % child.get("name") if child.get("name") else ""
            warnings.append(told(key, "link '%s': <%s>%s" % (reference, child.tag, name), fault))


def _ask_joint(joint: ElementTree.Element, ask: Ask, warnings: Warnings) -> None:
    ends = [joint.find(tag) for tag in ("parent", "child")]
    links = [_bare("" if end is None else end.get("link", "")) for end in ends]
    alone = copy.deepcopy(joint)
    for mimic in alone.findall("mimic"):
        alone.remove(mimic)
    fault = ask(_document(*links, alone), False)
    if fault:
        hold(joint)
        warnings.append(told("joint", "joint '%s'" % joint.get("name"), fault))


def _ask_transmission(robot: ElementTree.Element, transmission: ElementTree.Element, ask: Ask, warnings: Warnings
                      ) -> None:
    named = {end.get("name") for end in transmission.findall("joint")}
    elements: typing.List[ElementTree.Element] = [_bare("world")]
    for joint in robot.findall("joint"):
        if joint.get("name") in named:
            made = ElementTree.Element("joint", name=joint.get("name", ""), type="continuous")
            ElementTree.SubElement(made, "parent", link="world")
            ElementTree.SubElement(made, "child", link="end of " + joint.get("name", ""))
            elements += [_bare("end of " + joint.get("name", "")), made]
    fault = ask(_document(*elements, transmission), False)
    if fault:
        robot.remove(transmission)
        warnings.append(told("look", "<transmission name='%s'>" % transmission.get("name"), fault))


def _fill_inertia(robot: ElementTree.Element, ask: Ask, warnings: Warnings) -> None:
    """Gives links with a mass and no inertia that of a small ball, if that helps."""
    tried, lines = copy.deepcopy(robot), []
    for link in tried.findall("link"):
        mass, inertia = link.find("inertial/mass"), link.find("inertial/inertia")
        if mass is None or inertia is None or any(float(value) != 0.0 for value in inertia.attrib.values()):
            continue
        moment = 0.4 * float(mass.get("value", "0")) * BALL_M ** 2
        if moment > 0.0:
            inertia.attrib.update({key: repr(moment) for key in MOMENTS})
            lines.append(told("no inertia", "link '%s': <inertia>" % link.get("name"), "zero"))
    if lines and not ask(tried, True):
        for each in list(robot):
            robot.remove(each)
        robot.extend(list(tried))
        warnings.extend(lines)


def _leave_out(robot: ElementTree.Element, ask: Ask, warnings: Warnings) -> None:
    """Takes out one part after the other that the robot can do without, until the simulator takes it."""
    fault = ask(robot, True)
    parts = [(gazebo, light, "light", "link '%s': <light>" % gazebo.get("reference"))
             for gazebo in robot.findall("gazebo") for light in gazebo.findall("light")][::-1]
    parts += [(joint, mimic, "mimic", "joint '%s': <mimic>" % joint.get("name"))
              for joint in robot.findall("joint") for mimic in joint.findall("mimic")]
    parts += [(gazebo, sensor, "sensor", "sensor '%s'" % sensor.get("name"))
              for gazebo in robot.findall("gazebo") for sensor in gazebo.findall("sensor")][::-1]
    for parent, part, key, what in parts if fault else ():
        place = list(parent).index(part)
        parent.remove(part)
        if not ask(robot, True):
            warnings.append(told(key, what, fault))
            return
        parent.insert(place, part)
    kept = copy.deepcopy(robot)
    lines = []
    for parent, part, key, what in parts:
        if not fault:
            break
        parent.remove(part)
        lines.append(told(key, what, fault))
        fault = ask(robot, True)
    if not fault:
        warnings.extend(lines)
        return
    for each in list(robot):  # they were not to blame
        robot.remove(each)
    robot.extend(list(kept))
