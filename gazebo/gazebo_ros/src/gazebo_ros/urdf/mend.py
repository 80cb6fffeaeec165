"""Mends the parts of a URDF that the simulator refuses and Gazebo does not, with a warning for each (faults.py)."""
import math
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from ..faults import told
from .tree import Tree, link_of

UNLIMITED_EFFORT, UNLIMITED_SPEED = 1e6, 1e3  #: [N or N m], [m/s or rad/s]
FARTHEST = 1e4            #: of joints whose position has no limit [m or rad]
LARGEST = 1e4             #: coordinates and sizes [m], as the simulator allows them
LARGEST_ANGLE = 1e4       #: [rad]
LARGEST_SCALE = 1e6
HEAVIEST, STIFFEST = 1e9, 1e12  #: [kg], [kg m^2]
LARGEST_DAMPING = 1e9
LARGEST_FACTOR = 1e6      #: of a mimic
WRITTEN_DIGITS = 1e-3     #: a part of the largest moment of inertia: rounding of the digits of a file
TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating")
BOUNDED = ("revolute", "prismatic")
SIZES = {"box": (("size", 3),), "cylinder": (("radius", 1), ("length", 1)), "sphere": (("radius", 1),), "mesh": ()}
MOMENTS, PRODUCTS = ("ixx", "iyy", "izz"), ("ixy", "ixz", "iyz")
Warnings = typing.List[str]


def numbers_in(text: typing.Optional[str], count: int, most: float = math.inf) -> typing.Optional[typing.List[float]]:
    """Returns the numbers of a text, None unless there are so many finite ones of at most this size."""
    try:
        values = [float(word) for word in (text or "").split()]
    except ValueError:
        return None
    fine = len(values) == count and all(math.isfinite(each) and abs(each) <= most for each in values)
    return values if fine and "_" not in (text or "") else None


def number_in(element: ElementTree.Element, key: str, most: float = math.inf) -> typing.Optional[float]:
    """Returns the number of an attribute, None unless it is a finite one of at most this size."""
    values = numbers_in(element.get(key), 1, most)
    return None if values is None else values[0]


def mend(robot: ElementTree.Element, warnings: Warnings) -> None:
    """Repairs the links and joints of a URDF whose tree was checked.

    Args: robot: root element, changed.  warnings: gets a line for each fault.
    """
    if not robot.get("name", "").strip():
        robot.set("name", "robot")
    for link in robot.findall("link"):
        what = "link '%s'" % link.get("name")
        for inertial in link.findall("inertial"):
            _mend_inertial(link, inertial, what, warnings)
        for tag in ("visual", "collision"):
            for shape in link.findall(tag):
                _mend_shape(link, shape, what, warnings)
    root = Tree(robot).root
    for joint in robot.findall("joint"):
        _mend_joint(robot, joint, root, warnings)
    _drop_massless(robot, warnings)
    _mend_mimics(robot, warnings)


def _shown(element: typing.Optional[ElementTree.Element], key: str) -> str:
    found = None if element is None else element.get(key)
    return "no %s" % key if found is None else "%s '%s'" % (key, found)


def _mend_origin(part: ElementTree.Element, what: str, warnings: Warnings) -> None:
    for origin in part.findall("origin"):
        for key, most in (("xyz", LARGEST), ("rpy", LARGEST_ANGLE)):
            if origin.get(key) is not None and numbers_in(origin.get(key), 3, most) is None:
                nearest = _first_three(origin.get(key, ""), most)
                warnings.append(told("origin", "%s: <origin>" % what, _shown(origin, key), nearest))
                origin.set(key, nearest or "0 0 0")


def _first_three(text: str, most: float) -> str:
    """Returns the first three numbers of a text that has more, or commas between them; "" where there are none."""
    words = text.replace(",", " ").split()[:3]
    return " ".join(words) if numbers_in(" ".join(words), 3, most) is not None else ""


# --- inertia


def _mend_inertial(link: ElementTree.Element, inertial: ElementTree.Element, what: str, warnings: Warnings) -> None:
    _mend_origin(inertial, what + ": <inertial>", warnings)
    mass = _child(inertial, "mass")
    value = number_in(mass, "value", HEAVIEST)
    if value is None:
        warnings.append(told("mass", what + ": mass", _shown(mass, "value")))
        mass.set("value", "1.0")
    elif value < 0.0:
        warnings.append(told("no mass", what + ": mass", "%g kg" % value))
        link.remove(inertial)
        return
    inertia = _child(inertial, "inertia")
    for key in MOMENTS + PRODUCTS:
        if number_in(inertia, key, STIFFEST) is None:
            instead = "1.0" if key in MOMENTS else "0.0"
            warnings.append(told("inertia", what + ": <inertia>", _shown(inertia, key), instead))
            inertia.set(key, instead)
    xx, yy, zz, xy, xz, yz = (number_in(inertia, key) or 0.0 for key in MOMENTS + PRODUCTS)
    if value == 0.0:
        return  # the simulator says that it counts for nothing
    moments, axes = numpy.linalg.eigh(numpy.array(((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))
    slack = WRITTEN_DIGITS * abs(moments).max()
    if moments[0] >= -slack and moments[2] <= moments[0] + moments[1] + slack:
        return
    nearest = nearest_moments(moments)
    tensor = axes @ numpy.diag(nearest) @ axes.T
    warnings.append(told("moments", what + ": <inertia>", "the principal moments %s kg m^2" % _listed(moments),
                         "the nearest that a body can have, %s" % _listed(nearest)))
    for key, row, column in (("ixx", 0, 0), ("iyy", 1, 1), ("izz", 2, 2), ("ixy", 0, 1), ("ixz", 0, 2), ("iyz", 1, 2)):
        inertia.set(key, repr(float(tensor[row, column])))


def nearest_moments(moments: numpy.ndarray) -> numpy.ndarray:
    """Returns the nearest principal moments of inertia that a body can have, (3,), each at most the sum of the others.

    With m_i = d_j + d_k the set is d >= 0, d the second moments of the mass along the axes. The nearest point is that
    of the face on which some d are 0: all eight are tried.

    Args: moments: (3,) [kg m^2].
    """
    sums = numpy.ones((3, 3)) - numpy.eye(3)
    best, least = numpy.zeros(3), float(numpy.sum(numpy.square(moments)))
    for face in range(1, 8):
        free = [k for k in range(3) if face >> k & 1]
        along = numpy.linalg.lstsq(sums[:, free], moments, rcond=None)[0]
        nearest = sums[:, free] @ along
        distance = float(numpy.sum(numpy.square(nearest - moments)))
        if numpy.all(along >= 0.0) and distance < least:
            best, least = nearest, distance
    return best


def _listed(values: numpy.ndarray) -> str:
    return ", ".join("%.6g" % each for each in values)


def _drop_massless(robot: ElementTree.Element, warnings: Warnings) -> None:
    """Takes out links that a joint moves and that have no mass, with all that hangs from them."""
    masses = {link.get("name", ""): _mass_of(link) for link in robot.findall("link")}
    gone: typing.Set[str] = set()
    tree = Tree(robot)
    for link in tree.below(tree.root):
        joint = tree.joints.get(link)
        if joint is None or joint.get("type") in ("fixed", "floating") or link in gone:
            continue
        below = tree.below(link)
        if any(masses[each] > 0.0 for each in below):
            continue
        found = "no mass" + (", nor have its children (%s)" % ", ".join(below[1:]) if below[1:] else "")
        warnings.append(told("massless", "link '%s' at joint '%s'" % (link, joint.get("name")), found))
        gone.update(below)
    drop_links(robot, gone)


def _mass_of(link: ElementTree.Element) -> float:
    mass = link.find("inertial/mass")
    return 0.0 if mass is None else number_in(mass, "value") or 0.0


def drop_links(robot: ElementTree.Element, names: typing.Iterable[str]) -> None:
    """Takes links out of a URDF with the joints that hold them."""
    names = set(names)
    for joint in robot.findall("joint"):
        if link_of(joint, "child") in names or link_of(joint, "parent") in names:
            robot.remove(joint)
    for link in robot.findall("link"):
        if link.get("name") in names:
            robot.remove(link)


def base_mass(robot: ElementTree.Element) -> float:
    """Returns the mass [kg] of the root link with all that fixed joints hold at it."""
    masses = {link.get("name", ""): _mass_of(link) for link in robot.findall("link")}
    tree = Tree(robot)
    root = tree.root
    floating = [link for link in tree.children[root] if tree.joints[link].get("type") == "floating"]
    return sum(masses[each] for each in tree.body(floating[0] if floating else root))


# --- shapes


def _mend_shape(link: ElementTree.Element, part: ElementTree.Element, owner: str, warnings: Warnings) -> None:
    what = "%s: <%s>" % (owner, part.tag)
    _mend_origin(part, what, warnings)
    geometry = part.find("geometry")
    shape = None if geometry is None else next(iter(geometry), None)
    found = "no shape"
    if shape is not None and shape.tag not in SIZES:
        found = "the shape <%s>" % shape.tag
    elif shape is not None:
        found = ""
        for key, count in SIZES[shape.tag]:
            sizes = numbers_in(shape.get(key), count, LARGEST)
            if sizes is None or min(sizes) <= 0.0:
                found = "<%s> with %s" % (shape.tag, _shown(shape, key))
        if shape.tag == "mesh":
            if not shape.get("filename", "").strip():
                found = "<mesh> without a filename"
            scale = shape.get("scale")
            factors = None if scale is None else numbers_in(scale, 3, LARGEST_SCALE)
            if scale is not None and (factors is None or 0.0 in factors):
                found = "<mesh> with %s" % _shown(shape, "scale")
    if found:
        link.remove(part)
        warnings.append(told("shape", what, found))


# --- joints


def _mend_joint(robot: ElementTree.Element, joint: ElementTree.Element, root: str, warnings: Warnings) -> None:
    what = "joint '%s'" % joint.get("name")
    _mend_origin(joint, what, warnings)
    kind = joint.get("type", "")
    alone = sum(link_of(each, "parent") == root for each in robot.findall("joint")) == 1
    if kind not in TYPES or kind == "floating" and not (alone and link_of(joint, "parent") == root):
        warnings.append(told("joint type", what, "the type '%s'" % kind))
        hold(joint)
    if joint.get("type") in ("fixed", "floating"):
        return
    for axis in joint.findall("axis"):
        xyz = numbers_in(axis.get("xyz"), 3)
        if xyz is None or not any(xyz) or not math.isfinite(math.hypot(*xyz)):
            warnings.append(told("axis", what + ": <axis>", _shown(axis, "xyz")))
            axis.set("xyz", "1 0 0")
    _mend_limit(joint, what, warnings)
    for dynamics in joint.findall("dynamics"):
        for key in ("damping", "friction"):
            value = number_in(dynamics, key, LARGEST_DAMPING)
            if dynamics.get(key) is not None and (value is None or value < 0.0):
                warnings.append(told("dynamics", what + ": <dynamics>", _shown(dynamics, key)))
                dynamics.set(key, "0.0")
    for safety in joint.findall("safety_controller"):
        fault = _safety_fault(safety)
        if fault:
            warnings.append(told("safety", what + ": <safety_controller>", fault))
            joint.remove(safety)


def hold(joint: ElementTree.Element) -> None:
    """Makes a joint a fixed one."""
    joint.set("type", "fixed")
    for tag in ("axis", "limit", "dynamics", "mimic", "safety_controller", "calibration"):
        for element in joint.findall(tag):
            joint.remove(element)


def _mend_limit(joint: ElementTree.Element, what: str, warnings: Warnings) -> None:
    kind, limit = joint.get("type"), joint.find("limit")
    if limit is None:
        if kind in BOUNDED:
            warnings.append(told("no limit", what, "no <limit>"))
            _free(joint, _limit(joint))
        return
    for key, fault, most in (("effort", "effort", UNLIMITED_EFFORT), ("velocity", "velocity", UNLIMITED_SPEED)):
        value = number_in(limit, key)
        if value is None or value < 0.0 or key == "velocity" and value == 0.0:
            warnings.append(told(fault, what + ": <limit>", _shown(limit, key)))
            limit.set(key, repr(most))
    lower, upper = (number_in(limit, key) if limit.get(key) is not None else 0.0 for key in ("lower", "upper"))
    if lower is None or upper is None:
        warnings.append(told("no limit", what + ": <limit>", _shown(limit, "lower" if lower is None else "upper")))
        _free(joint, limit)
    elif kind in BOUNDED and lower > upper:
        warnings.append(told("limits swapped", what + ": <limit>", "lower %g > upper %g" % (lower, upper)))
        limit.set("lower", repr(upper))
        limit.set("upper", repr(lower))


def _limit(joint: ElementTree.Element) -> ElementTree.Element:
    return ElementTree.SubElement(joint, "limit", effort=repr(UNLIMITED_EFFORT), velocity=repr(UNLIMITED_SPEED))


def _free(joint: ElementTree.Element, limit: ElementTree.Element) -> None:
    """Lets a joint move as far as it can."""
    for key in ("lower", "upper"):
        limit.attrib.pop(key, None)
    if joint.get("type") == "revolute":
        joint.set("type", "continuous")
    elif joint.get("type") == "prismatic":
        limit.set("lower", repr(-FARTHEST))
        limit.set("upper", repr(FARTHEST))


def _safety_fault(safety: ElementTree.Element) -> str:
    """Returns the reason why the simulator rejects it, "" if it accepts it."""
    values = {}
    for key in ("k_velocity", "k_position", "soft_lower_limit", "soft_upper_limit"):
        value = number_in(safety, key) if safety.get(key) is not None else None if key == "k_velocity" else 0.0
        if value is None or key.startswith("k_") and value < 0.0:
            return _shown(safety, key)
        values[key] = value
    lower, upper = values["soft_lower_limit"], values["soft_upper_limit"]
    return "soft_lower_limit %g > soft_upper_limit %g" % (lower, upper) if lower > upper else ""


# --- mimics


def _mend_mimics(robot: ElementTree.Element, warnings: Warnings) -> None:
    joints = {joint.get("name", ""): joint for joint in robot.findall("joint")}
    for joint in joints.values():
        for mimic in joint.findall("mimic"):
            wrong = _mimic_fault(joint, mimic, joints)
            if wrong:
                warnings.append(told("mimic", "joint '%s': <mimic>" % joint.get("name"), wrong))
                joint.remove(mimic)
    ranges = {name: _range_of(joint) for name, joint in joints.items()}
    for name, joint in joints.items():
        own = joint.find("mimic")
        if own is None or joint.get("type") in ("fixed", "floating"):
            continue
        leader, multiplier, offset = _followed(joint, joints)
        if multiplier == 0.0:
            continue
        ends = sorted((each - offset) / multiplier for each in ranges[name])
        lower, upper = max(ends[0], ranges[leader][0]), min(ends[1], ranges[leader][1])
        if lower > upper:
            warnings.append(told("mimic", "joint '%s': <mimic>" % name,
                                 "limits of the two joints that exclude each other"))
            joint.remove(own)
        else:
            ranges[leader] = (lower, upper)


def _mimic_fault(joint: ElementTree.Element, mimic: ElementTree.Element,
                 joints: typing.Dict[str, ElementTree.Element]) -> str:
    """Returns the reason why the simulator rejects it, "" if it accepts it."""
    name = mimic.get("joint")
    if name is None or name not in joints:
        return "the joint '%s', which is not there" % (name or "")
    if joint.get("type") in ("fixed", "floating"):
        return ""
    if joints[name].get("type") in ("fixed", "floating"):
        return "the joint '%s', which does not move" % name
    for key in ("multiplier", "offset"):
        if mimic.get(key) is not None and number_in(mimic, key, LARGEST_FACTOR) is None:
            return _shown(mimic, key)
    passed, at = {joint.get("name")}, name
    while at in joints:
        if at in passed:
            return "the joint '%s', which follows this one" % name
        passed.add(at)
        further = joints[at].find("mimic")
        at = "" if further is None else further.get("joint", "")
    return ""


def _followed(joint: ElementTree.Element, joints: typing.Dict[str, ElementTree.Element]
              ) -> typing.Tuple[str, float, float]:
    """Returns the joint at the end of a chain of mimics, and multiplier and offset to it."""
    multiplier, offset, name = 1.0, 0.0, joint.get("name", "")
    mimic = joint.find("mimic")
    while mimic is not None:
        own = number_in(mimic, "multiplier")
        offset += multiplier * (number_in(mimic, "offset") or 0.0)
        multiplier *= 1.0 if own is None else own
        name = mimic.get("joint", "")
        mimic = joints[name].find("mimic")
    return name, multiplier, offset


def _range_of(joint: ElementTree.Element) -> typing.Tuple[float, float]:
    limit = joint.find("limit")
    if limit is None or joint.get("type") not in BOUNDED:
        return -math.inf, math.inf
    return number_in(limit, "lower") or 0.0, number_in(limit, "upper") or 0.0


def _child(element: ElementTree.Element, tag: str) -> ElementTree.Element:
    found = element.find(tag)
    return ElementTree.SubElement(element, tag) if found is None else found
