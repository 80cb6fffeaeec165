"""Where the links, joints and frames of an SDF model are."""
import dataclasses
import typing
import xml.etree.ElementTree as ElementTree

import numpy

from aras_visual_servo_sim import ModelError

from ..faults import told
from ..urdf.mend import numbers_in
from .document import pose_of

MODEL = "__model__"


@dataclasses.dataclass(frozen=True)
class Part:
    """A link, joint, frame or nested model; names in a nested model begin with its name and ::."""
    name: str
    element: ElementTree.Element
    scope: str  #: "" or the name of the nested model that it is in, with ::


class Frames:
    """The parts of a model by name, and their poses in the model's frame."""

    def __init__(self, model: ElementTree.Element, warnings: typing.List[str]) -> None:
        """Args: model: <model>.  warnings: list, given a line for each frame that is not there."""
        self.links, self.joints, self.models, self._others = {}, {}, {}, {}
        self._warnings, self._known = warnings, {}
        self._add(model, "")

    def _add(self, model: ElementTree.Element, scope: str) -> None:
        """Yields in the order of the document, as sdformat's addNestedModel orders the includes of a model."""
        kinds = {"link": self.links, "joint": self.joints, "frame": self._others, "model": self.models}
        for element in model:
            parts = kinds.get(element.tag)
            name = scope + element.get("name", "")
            if parts is None:
                continue
            if name in parts:
                self._warnings.append("<%s name='%s'>: is there twice: the second is ignored" % (element.tag, name))
                continue
            parts[name] = Part(name, element, scope)
            if element.tag == "model":
                self._add(element, name + "::")

    def pose(self, name: str, under: typing.Tuple[str, ...] = ()) -> numpy.ndarray:
        """Returns X_MA of a link, joint, frame or nested model A, (4, 4). An unknown A counts as the model itself."""
        if name in ("", MODEL):
            return numpy.eye(4)
        if name.endswith("::" + MODEL):
            return self.pose(name[:-len(MODEL) - 2], under)
        if name not in self._known:
            part = next((parts[name] for parts in (self.links, self.joints, self._others, self.models)
                         if name in parts), None)
            if part is None or name in under:
                self._warnings.append("frame '%s' %s: the model's is taken" %
                                      (name, "hangs from itself" if part else "does not exist"))
                return numpy.eye(4)
            self._known[name] = self.pose(self._parent(part), (*under, name)) @ self._own_pose(part.element, name)
        return self._known[name]

    def _own_pose(self, element: ElementTree.Element, name: str) -> numpy.ndarray:
        try:
            return pose_of(element, name)
        except ModelError as error:
            self._warnings.append(told("origin", "<%s name='%s'>" % (element.tag, name), error))
            return numpy.eye(4)

    def _parent(self, part: Part) -> str:
        """Name of the frame that a part's pose is given in."""
        pose = part.element.find("pose")
        relative_to = pose.get("relative_to", "") if pose is not None else ""
        if not relative_to and part.element.tag == "joint":
            relative_to = self.end(part, "child")
            return relative_to if relative_to in self.links else part.scope + MODEL
        relative_to = relative_to or part.element.get("attached_to", "") or MODEL
        return part.scope + relative_to

    @staticmethod
    def end(joint: Part, tag: str) -> str:
        """Name of the link at a joint's <parent> or <child>; "world" belongs to no model."""
        name = (joint.element.findtext(tag) or "").strip()
        return name if name == "world" else joint.scope + name

    def axis(self, joint: Part) -> numpy.ndarray:
        """Unit vector of a joint's axis in its own frame, (3,); z if there is none."""
        xyz = joint.element.find("axis/xyz")
        if xyz is None:
            return numpy.array((0.0, 0.0, 1.0))
        axis = numpy.array(numbers_in(xyz.text, 3) or (0.0, 0.0, 0.0))
        frame = xyz.get("expressed_in", "")
        if frame:
            axis = self.pose(joint.name)[:3, :3].T @ self.pose(joint.scope + frame)[:3, :3] @ axis
        length = numpy.linalg.norm(axis)
        return axis / length if length > 0.0 else numpy.array((0.0, 0.0, 1.0))
