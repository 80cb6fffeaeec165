"""A URDF with other properties of a link or joint, as Gazebo's services set them."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

from aras_visual_servo_sim import ParameterError, UnknownNameError


GRAVITY_TAGS = ("turnGravityOff", "gravity")
INERTIA_KEYS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
#: Properties of a joint: damping [N s/m or N m s/rad], friction [N or N m], lower and upper limit [m or rad].
DYNAMICS, LIMITS = ("damping", "friction"), ("lower", "upper")


@dataclasses.dataclass(frozen=True)
class LinkProperties:
    """Mass, centre of mass in the link, and ixx ixy ixz iyy iyz izz about it, in the axes of the <inertial>."""
    mass_kg: float = 0.0
    com_m: tuple = (0.0, 0.0, 0.0)
    inertia_kg_m2: tuple = (0.0,) * 6
    gravity: bool = True  #: acts on the link


def properties_of(link: ElementTree.Element, gravity: bool) -> LinkProperties:
    """LinkProperties of a <link>."""
    inertial = link.find("inertial")
    if inertial is None:
        return LinkProperties(gravity=gravity)
    origin, inertia = inertial.find("origin"), inertial.find("inertia")
    com = (0.0, 0.0, 0.0) if origin is None else tuple(map(float, origin.get("xyz", "0 0 0").split()))
    return LinkProperties(float(inertial.find("mass").get("value")), com,
                          tuple(float(inertia.get(key, 0.0)) for key in INERTIA_KEYS), gravity)


def with_link(xml: str, link: str, properties: LinkProperties) -> str:
    """The document with other LinkProperties of a link. Raises: UnknownNameError."""
    robot = ElementTree.fromstring(xml)
    inertial = child(named(robot, "link", link), "inertial")
    child(inertial, "origin").set("xyz", " ".join(repr(float(each)) for each in properties.com_m))
    child(inertial, "mass").set("value", repr(float(properties.mass_kg)))
    inertia = child(inertial, "inertia")
    for key, value in zip(INERTIA_KEYS, properties.inertia_kg_m2):
        inertia.set(key, repr(float(value)))
    for gazebo in robot.findall("gazebo"):
        for tag in GRAVITY_TAGS if gazebo.get("reference") == link else ():
            for old in gazebo.findall(tag):
                gazebo.remove(old)
    if not properties.gravity:
        gazebo = ElementTree.SubElement(robot, "gazebo", reference=link)
        ElementTree.SubElement(gazebo, "turnGravityOff").text = "true"
    return ElementTree.tostring(robot, encoding="unicode")


def with_joint(xml: str, joint: str, properties: typing.Dict[str, float]) -> str:
    """The document with other properties of a joint, a dict. Raises: UnknownNameError, ParameterError."""
    robot = ElementTree.fromstring(xml)
    element = named(robot, "joint", joint)
    for key, value in properties.items():
        part = child(element, "dynamics") if key in DYNAMICS else element.find("limit")
        if key in LIMITS and (part is None or element.get("type") == "continuous"):
            raise ParameterError("joint '%s' has no limits of position, and cannot be given any" % joint)
        part.set(key, repr(float(value)))
    return ElementTree.tostring(robot, encoding="unicode")


def named(robot: ElementTree.Element, tag: str, name: str) -> ElementTree.Element:
    """Raises: UnknownNameError."""
    for element in robot.findall(tag):
        if element.get("name") == name:
            return element
    raise UnknownNameError("%s '%s' does not exist" % (tag, name))


def child(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    """Its child of this tag, made if there is none."""
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found
