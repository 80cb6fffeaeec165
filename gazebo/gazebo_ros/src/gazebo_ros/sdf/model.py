"""A model of SDF as a URDF for the simulator, with the other properties in <gazebo> tags."""
import copy
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..faults import told
from ..world.poses import rpy_of
from ..urdf.tree import DESCRIBED_BY
from .document import NoFolders, found, number, numbers, pose_of
from .frames import Frames, Part

#: Ends the name of a link without mass that a joint moves, which stands where the joint is, when its child does not.
JOINT_FRAME = "::joint_frame"
UNLIMITED = 1e15             #: a position limit from here on is none [m or rad]
FARTHEST_M = 1e4             #: of joints that slide without a limit
STRONGEST, FASTEST = 1e6, 1e3  #: of joints that limit neither effort [N or N m] nor speed [m/s or rad/s]
SLAB_M = 0.01                #: thickness of the box that shows a plane
MOVING = ("revolute", "prismatic", "continuous")
#: Tags of a link and a model that are used, or have no effect here.
LINK_TAGS = {"pose", "inertial", "collision", "visual", "sensor", "light", "gravity", "self_collide", "kinematic",
             "velocity_decay", "must_be_base_link", "enable_wind", "projector", "audio_sink", "audio_source"}
MODEL_TAGS = {"pose", "link", "joint", "frame", "model", "plugin", "static", "self_collide", "allow_auto_disable",
              "enable_wind"}


@dataclasses.dataclass(frozen=True)
class SdfModel:
    """
    Attributes:
        name: its own.
        urdf: the document.
        pose: its <pose>, (4, 4).
        X_MR: root link in the model's frame, (4, 4).
        planes: X_MP of the planes that it can be touched at, z their normal, each (4, 4).
        warnings: about ignored parts, a line each.
    """
    name: str
    urdf: str
    pose: numpy.ndarray
    X_MR: numpy.ndarray
    planes: tuple
    warnings: tuple


def model_of(element: ElementTree.Element, folders: NoFolders) -> SdfModel:
    """Args: element: <model>, of an expanded document.  folders: as World has them.
    Returns: SdfModel
    """
    return Writer(element, folders).written()


class Writer:
    """Writes one URDF."""

    def __init__(self, model: ElementTree.Element, folders: NoFolders) -> None:
        self._model, self._folders, self._warnings, self._planes = model, folders, [], []
        self._frames = Frames(model, self._warnings)
        self._static = model.findtext("static", "").strip() in ("true", "1")
        self._robot = ElementTree.Element("robot", {"name": model.get("name", "model"), DESCRIBED_BY: "sdf"})

    def written(self) -> SdfModel:
        links, name = self._frames.links, self._model.get("name", "")
        if not links:
            self._warn("has no links: it cannot be seen")
            ElementTree.SubElement(self._robot, "link", name="link")
        joints = {} if self._static else self._joints()
        roots = [link for link in links if link not in joints]
        held = any(self._frames.end(joint, "parent") == "world" for joint in joints.values())
        if held:
            ElementTree.SubElement(self._robot, "link", name="world")
        for link in links.values():
            self._link(link)
        for joint in joints.values():
            self._joint(joint)
        X_MR = numpy.eye(4) if held or not roots else self._frames.pose(roots[0])
        first = "world" if held else roots[0] if roots else ""
        for link in roots if held else roots[1:]:
            if not self._static:
                self._warn("link '%s' hangs from no joint: it is held at '%s'" % (link, first))
            self._hung(link + "::held", "fixed", first, link, numpy.linalg.inv(X_MR) @ self._frames.pose(link))
        self._extras()
        pose = self._pose(self._model, name)
        return SdfModel(name, ElementTree.tostring(self._robot, encoding="unicode"), pose, X_MR, tuple(self._planes),
                        tuple(dict.fromkeys(self._warnings)))

    def _warn(self, text: str) -> None:
        self._warnings.append(text)

    def _number(self, element: ElementTree.Element, path: str, otherwise: float, what: str) -> float:
        """A number in the text of a descendant, with a warning the default where it is none."""
        try:
            return number(element, path, otherwise, what)
        except ModelError as error:
            self._warn(told("element", what, error, "%g" % otherwise))
            return otherwise

    def _pose(self, element: ElementTree.Element, what: str) -> numpy.ndarray:
        """(4, 4) of an element's <pose>, with a warning that of the element it stands in where it is none."""
        try:
            return pose_of(element, what)
        except ModelError as error:
            self._warn(told("origin", what, error))
            return numpy.eye(4)

    def _gazebo(self, reference: str, *children: ElementTree.Element) -> ElementTree.Element:
        """A <gazebo> tag about a link, or about the model."""
        tag = ElementTree.SubElement(self._robot, "gazebo", **({"reference": reference} if reference else {}))
        tag.extend(copy.deepcopy(child) for child in children)
        return tag

    def _extras(self) -> None:
        if self._static:
            ElementTree.SubElement(self._gazebo(""), "static").text = "true"
        models = [(self._model, "")] + [(part.element, part.name) for part in self._frames.models.values()]
        for model, scope in models:
            for child in model:
                if child.tag == "plugin":
                    self._gazebo("", child)
                elif child.tag not in MODEL_TAGS:
                    self._warn("<%s> in <model%s>: ignored" % (child.tag, " name='%s'" % scope if scope else ""))

    # --- joints

    def _joints(self) -> typing.Dict[str, Part]:
        """Returns dict of child link -> its joint. Warns about impossible joints."""
        links, joints = self._frames.links, {}
        for joint in self._frames.joints.values():
            parent, child = self._frames.end(joint, "parent"), self._frames.end(joint, "child")
            if child not in links or parent not in links and parent != "world":
                stranger = child if child not in links else parent
                self._warn("joint '%s': there is no link '%s': ignored" % (joint.name, stranger))
            elif child in joints:
                self._warn("joint '%s': link '%s' hangs from joint '%s' already, loops are not simulated: ignored" %
                           (joint.name, child, joints[child].name))
            elif self._loops(joint, child, joints):
                self._warn("joint '%s' closes a loop, loops are not simulated: ignored" % joint.name)
            else:
                joints[child] = joint
        return joints

    def _loops(self, joint: Part, child: str, joints: typing.Dict[str, Part]) -> bool:
        at = self._frames.end(joint, "parent")
        while at in joints and at != child:
            at = self._frames.end(joints[at], "parent")
        return at == child

    def _joint(self, joint: Part) -> None:
        kind, name = joint.element.get("type", ""), joint.name
        parent, child = self._frames.end(joint, "parent"), self._frames.end(joint, "child")
        if kind not in (*MOVING, "fixed"):
            self._warn("joint '%s' of type %s is not simulated: it is held" % (name, kind))
            kind = "fixed"
        X_MP = numpy.eye(4) if parent == "world" else self._frames.pose(parent)
        X_MC, X_MJ = self._frames.pose(child), self._frames.pose(name)
        if kind == "fixed":
            self._hung(name, kind, parent, child, numpy.linalg.inv(X_MP) @ X_MC)
            return
        offset = numpy.linalg.inv(X_MJ) @ X_MC
        moved = child
        if not numpy.allclose(offset, numpy.eye(4), atol=1e-12):
            moved = name + JOINT_FRAME
            ElementTree.SubElement(self._robot, "link", name=moved)
            self._hung(moved + "::child", "fixed", moved, child, offset)
        lower = self._number(joint.element, "axis/limit/lower", -1e16, name)
        upper = self._number(joint.element, "axis/limit/upper", 1e16, name)
        free = lower <= -UNLIMITED or upper >= UNLIMITED
        if kind == "revolute" and free:
            kind = "continuous"
        made = self._hung(name, kind, parent, moved, numpy.linalg.inv(X_MP) @ X_MJ)
        ElementTree.SubElement(made, "axis", xyz=spaced(self._frames.axis(joint)))
        effort = self._number(joint.element, "axis/limit/effort", -1.0, name)
        velocity = self._number(joint.element, "axis/limit/velocity", -1.0, name)
        ElementTree.SubElement(made, "limit", lower=repr(max(lower, -FARTHEST_M)), upper=repr(min(upper, FARTHEST_M)),
                               effort=repr(effort if 0.0 <= effort < STRONGEST else STRONGEST),
                               velocity=repr(velocity if 0.0 < velocity < FASTEST else FASTEST))
        ElementTree.SubElement(made, "dynamics", **{
            key: repr(max(0.0, self._number(joint.element, "axis/dynamics/" + key, 0.0, name)))
            for key in ("damping", "friction")})
        for key in ("spring_stiffness", "spring_reference"):
            if self._number(joint.element, "axis/dynamics/" + key, 0.0, name):
                self._warn("joint '%s': <%s> is ignored" % (name, key))

    def _hung(self, name: str, kind: str, parent: str, child: str, X_PC: numpy.ndarray) -> ElementTree.Element:
        made = ElementTree.SubElement(self._robot, "joint", name=name, type=kind)
        ElementTree.SubElement(made, "origin", **origin(X_PC))
        ElementTree.SubElement(made, "parent", link=parent)
        ElementTree.SubElement(made, "child", link=child)
        return made

    # --- links

    def _link(self, part: Part) -> None:
        made = ElementTree.SubElement(self._robot, "link", name=part.name)
        self._inertial(part, made)
        if self._collides_itself(part):
            ElementTree.SubElement(self._gazebo(part.name), "selfCollide").text = "true"
        for kind in ("visual", "collision"):
            for k, element in enumerate(part.element.findall(kind)):
                try:
                    self._shape(part, element, made, "%s %d" % (element.get("name", kind), k))
                except ModelError as error:
                    self._warn(told("shape", "<%s> of link '%s'" % (kind, part.name), error))
        for child in part.element:
            if child.tag in ("sensor", "light"):
                self._gazebo(part.name, plain(child))
            elif child.tag == "gravity" and (child.text or "").strip() in ("false", "0"):
                self._gazebo(part.name, child)
            elif child.tag not in LINK_TAGS:
                self._warn("<%s> in <link name='%s'>: ignored" % (child.tag, part.name))

    def _collides_itself(self, part: Part) -> bool:
        """Whether a link touches others of its model: as it says itself, else as its model does."""
        model = self._frames.models[part.scope[:-2]].element if part.scope else self._model
        said = part.element.findtext("self_collide") or model.findtext("self_collide") or "false"
        return said.strip() in ("true", "1")

    def _inertial(self, part: Part, made: ElementTree.Element) -> None:
        what = "<inertial> of link '%s'" % part.name
        inertial = part.element.find("inertial")
        inertial = ElementTree.Element("inertial") if inertial is None else inertial
        tag = ElementTree.SubElement(made, "inertial")
        ElementTree.SubElement(tag, "origin", **origin(self._pose(inertial, what)))
        ElementTree.SubElement(tag, "mass", value=repr(self._number(inertial, "mass", 1.0, what)))
        ElementTree.SubElement(tag, "inertia", **{
            key: repr(self._number(inertial, "inertia/" + key, 1.0 if key[1] == key[2] else 0.0, what))
            for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")})

    def _shape(self, part: Part, element: ElementTree.Element, made: ElementTree.Element, name: str) -> None:
        """A <visual> or <collision>."""
        what = "<%s> of link '%s'" % (element.tag, part.name)
        geometry = element.find("geometry")
        shape = next(iter(geometry), None) if geometry is not None else None
        if shape is None or shape.tag == "empty":
            return
        pose = self._pose(element, what)
        if shape.tag == "plane":
            normal = numbers(shape.findtext("normal") or "0 0 1", 3, what)
            pose = pose @ turned_up(normal)
            if element.tag == "collision":
                self._planes.append(self._frames.pose(part.name) @ pose)
                return
            slab = numpy.eye(4)
            slab[2, 3] = -SLAB_M / 2
            pose = pose @ slab
        tag = self._geometry(shape, what)
        if tag is None:
            return
        shown = ElementTree.SubElement(made, element.tag, name=name)
        ElementTree.SubElement(shown, "origin", **origin(pose))
        ElementTree.SubElement(shown, "geometry").append(tag)
        friction = element.find("surface/friction/ode/mu")
        if friction is not None:
            ElementTree.SubElement(self._gazebo(part.name), "mu1").text = friction.text
        retro = element.find("laser_retro")
        if retro is not None:
            ElementTree.SubElement(self._gazebo(part.name), "laserRetro").text = retro.text
        if element.tag == "visual":
            look = ElementTree.SubElement(self._gazebo(part.name), "visual", name=name)
            look.extend(copy.deepcopy(child) for child in element
                        if child.tag in ("material", "transparency", "cast_shadows"))

    def _geometry(self, shape: ElementTree.Element, what: str) -> typing.Optional[ElementTree.Element]:
        """A shape's tag in URDF, or None with a warning."""
        def sizes(tag: str, count: int) -> str:
            return spaced(numbers(shape.findtext(tag), count, "%s: <%s>" % (what, tag)))
        if shape.tag == "box":
            return ElementTree.Element("box", size=sizes("size", 3))
        if shape.tag == "plane":
            return ElementTree.Element("box", size="%s %r" % (sizes("size", 2), SLAB_M))
        if shape.tag == "sphere":
            return ElementTree.Element("sphere", radius=sizes("radius", 1))
        if shape.tag == "cylinder":
            return ElementTree.Element("cylinder", radius=sizes("radius", 1), length=sizes("length", 1))
        if shape.tag != "mesh":
            named = "terrain (<heightmap>)" if shape.tag == "heightmap" else "<%s>" % shape.tag
            self._warn("%s: %s is not simulated: ignored, %s" %
                       (what, named, "cameras do not see it" if what.startswith("<visual>") else
                        "nothing can touch it or stand on it"))
            return None
        if shape.find("submesh") is not None:
            self._warn("%s: <submesh> is ignored: the whole mesh is taken" % what)
        uri = (shape.findtext("uri") or "").strip()
        path = found(uri, self._folders)
        if not path:
            self._warn("%s: mesh %s is not found: ignored" % (what, uri))
            return None
        scale = shape.findtext("scale") or "1 1 1"
        return ElementTree.Element("mesh", filename="file://" + path, scale=spaced(numbers(scale, 3, what)))


def plain(element: ElementTree.Element) -> ElementTree.Element:
    """Returns a sensor or light without the redundant elements that libsdformat adds."""
    element = copy.deepcopy(element)
    for child in list(element):
        if (child.text or "").strip() == "__default__":
            element.remove(child)
    return element


def turned_up(normal: typing.Sequence[float]) -> numpy.ndarray:
    """(4, 4) of a frame whose z is a normal."""
    z = numpy.asarray(normal, float)
    z = z / (numpy.linalg.norm(z) or 1.0)
    other = numpy.array((1.0, 0.0, 0.0)) if abs(z[0]) < 0.6 else numpy.array((0.0, 1.0, 0.0))
    y = numpy.cross(z, other)
    y = y / (numpy.linalg.norm(y) or 1.0)
    pose = numpy.eye(4)
    pose[:3, :3] = numpy.stack((numpy.cross(y, z), y, z), axis=1)
    return pose


def origin(pose: numpy.ndarray) -> typing.Dict[str, str]:
    return {"xyz": spaced(pose[:3, 3]), "rpy": spaced(rpy_of(pose))}


def spaced(values: typing.Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
