"""A URDF with other properties of a link or joint, as Gazebo's services set them."""
import dataclasses
import xml.etree.ElementTree as ElementTree

from ..world.errors import BadValueError, UnknownEntityError

GRAVITY_TAGS = ("turnGravityOff", "gravity")


@dataclasses.dataclass(frozen=True)
class LinkProperties:
    """Mass, centre of mass in the link, and ixx ixy ixz iyy iyz izz about it."""
    mass_kg: float
    com_m: tuple
    inertia_kg_m2: tuple
    gravity: bool


@dataclasses.dataclass(frozen=True)
class JointProperties:
    """None: as it is."""
    damping: float = None   #: [N s/m or N m s/rad]
    friction: float = None  #: [N or N m]
    lower: float = None     #: [m or rad]
    upper: float = None


def with_link(xml, link, properties):
    """The document with other properties of a link. Raises: UnknownEntityError."""
    robot = ElementTree.fromstring(xml)
    element = named(robot, "link", link)
    inertial = child(element, "inertial")
    origin = child(inertial, "origin")
    origin.set("xyz", " ".join(repr(float(each)) for each in properties.com_m))
    child(inertial, "mass").set("value", repr(float(properties.mass_kg)))
    inertia = child(inertial, "inertia")
    for key, value in zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), properties.inertia_kg_m2):
        inertia.set(key, repr(float(value)))
    for gazebo in robot.findall("gazebo"):
        for tag in GRAVITY_TAGS if gazebo.get("reference") == link else ():
            for old in gazebo.findall(tag):
                gazebo.remove(old)
    if not properties.gravity:
        gazebo = ElementTree.SubElement(robot, "gazebo", reference=link)
        ElementTree.SubElement(gazebo, "turnGravityOff").text = "true"
    return ElementTree.tostring(robot, encoding="unicode")


def with_joint(xml, joint, properties):
    """The document with other properties of a joint. Raises: UnknownEntityError, BadValueError."""
    robot = ElementTree.fromstring(xml)
    element = named(robot, "joint", joint)
    for key in ("damping", "friction"):
        value = getattr(properties, key)
        if value is not None:
            child(element, "dynamics").set(key, repr(float(value)))
    limit = element.find("limit")
    for key in ("lower", "upper"):
        value = getattr(properties, key)
        if value is None:
            continue
        if limit is None or element.get("type") == "continuous":
            raise BadValueError("joint '%s' has no limits of position, and cannot be given any" % joint)
        limit.set(key, repr(float(value)))
    return ElementTree.tostring(robot, encoding="unicode")


def named(robot, tag, name):
    for element in robot.findall(tag):
        if element.get("name") == name:
            return element
    raise UnknownEntityError("%s '%s' does not exist" % (tag, name))


def child(element, tag):
    """Its child of this tag, made if there is none."""
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found
