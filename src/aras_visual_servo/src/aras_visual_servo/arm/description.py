"""Puts the meshes of a vendor's description package on an arm, by path. No file is copied.

Both models are compared at zero joint positions, so that a description of another arm is rejected.
"""

import math
from pathlib import Path
from typing import Any, Dict, List, Optional, Tuple
from xml.etree import ElementTree

import numpy as np

from ..config.files import package_path
from ..ground.errors import ParameterError
from ..spatial import inverse, rotation_angle, rpy_of
from .free_camera import origin_pose

#: Frames of the two models may differ by this [m, rad].
SAME_M, SAME_RAD = 1e-3, 2e-3
PACKAGE = "package://"


def description_urdf(path: str) -> Tuple[Path, Path]:
    """Returns (URDF, package folder) of a description: an expanded URDF, or a package folder that holds one.

    Raises ParameterError: there is no such path, or the package holds no URDF or several.
    """
    given = Path(path)
    if given.is_file():
        folder = next((each for each in given.parents if (each / "package.xml").is_file()), given.parent)
        return given, folder
    if not given.is_dir():
        raise ParameterError(f"--description: found {path}, allowed a description package or an expanded URDF")
    found = sorted(given.rglob("*.urdf"))
    if len(found) != 1:
        names = ", ".join(str(each.relative_to(given)) for each in found) or "none"
        raise ParameterError(f"--description: found the URDFs {names} in {path}, allowed one, or the path of a URDF; "
                             "expand a xacro file first: xacro ARM.urdf.xacro > ARM.urdf")
    return found[0], given


def with_meshes(urdf_xml: str, description: str) -> str:
    """Returns the URDF of an arm with the visuals of the vendor's description.

    A link keeps its own visuals where the description has none. Joints are matched by name.

    Args: description: path as of `description_urdf`.
    Raises: ParameterError: with every fault: a joint that the description lacks or places elsewhere, or a mesh file
        that is missing.
    """
    path, folder = description_urdf(description)
    own, its = _Tree(urdf_xml, "URDF"), _Tree(path.read_text(encoding="utf-8"), str(path))
    faults = _unlike(own, its)
    if faults:
        raise ParameterError(faults)
    dressed: Dict[str, List[ElementTree.Element]] = {}
    for link in its.robot.findall("link"):
        visuals = link.findall("visual")
        place = _place(own, its, link.get("name")) if visuals else None
        if place is None:
            continue
        name, X = place
        for visual in visuals:
            dressed.setdefault(name, []).append(_moved(visual, X))
            faults += _anchored(visual, folder, path.parent)
    if not dressed and not faults:
        faults.append(f"--description: found no visual in {path}, allowed a description with meshes")
    if faults:
        raise ParameterError(list(dict.fromkeys(faults)))
    materials = {each.get("name") for each in own.robot.findall("material")}
    for material in its.robot.findall("material"):
        if material.get("name") not in materials:
            own.robot.insert(0, material)
    for link in own.robot.findall("link"):
        if link.get("name") in dressed:
            for visual in link.findall("visual"):
                link.remove(visual)
            link.extend(dressed[link.get("name")])
    ElementTree.indent(own.robot)
    return ElementTree.tostring(own.robot, encoding="unicode") + "\n"


class _Tree:
    """Joints and links of a URDF; poses at zero joint positions."""

    def __init__(self, urdf_xml: str, name: str) -> None:
        try:
            self.robot = ElementTree.fromstring(urdf_xml)
        except ElementTree.ParseError as error:
            raise ParameterError(f"{name}: found no XML ({error}), allowed an expanded URDF") from error
        self.parents = {joint.find("child").get("link"): joint for joint in self.robot.findall("joint")}
        self.joints = {joint.get("name"): joint for joint in self.robot.findall("joint")}

    def moving(self, link: Optional[str]) -> Optional[str]:
        """Name of the joint that moves a link, None for a link of the base."""
        joint = self.parents.get(link)
        while joint is not None and joint.get("type") == "fixed":
            joint = self.parents.get(joint.find("parent").get("link"))
        return None if joint is None else joint.get("name")

    def pose(self, link: Optional[str]) -> np.ndarray:
        """(4, 4) of a link in the root."""
        X, joint = np.eye(4), self.parents.get(link)
        while joint is not None:
            X = origin_pose(joint) @ X
            joint = self.parents.get(joint.find("parent").get("link"))
        return X

    def child(self, joint: str) -> Any:
        """Link that a joint moves."""
        return self.joints[joint].find("child").get("link")

    def parent(self, joint: str) -> Any:
        """Link on which a joint stands."""
        return self.joints[joint].find("parent").get("link")

    def axis(self, joint: str) -> np.ndarray:
        """(3,) in the frame of the joint."""
        axis = self.joints[joint].find("axis")
        return np.array((axis.get("xyz") if axis is not None else "1 0 0").split(), dtype=float)


def _unlike(own, its):
    """A text for every moving joint of the arm that the description lacks or has elsewhere."""
    faults = []
    for name, joint in own.joints.items():
        if joint.get("type") == "fixed":
            continue
        if name not in its.joints:
            faults.append(f"--description: found no joint {name}, allowed the joints of this arm")
            continue
        before = own.moving(own.parent(name))
        if before is None or before not in its.joints:
            continue
        steps = [inverse(tree.pose(tree.child(before))) @ tree.pose(tree.child(name)) for tree in (own, its)]
        apart = inverse(steps[0]) @ steps[1]
        off, turn = float(np.linalg.norm(apart[:3, 3])), rotation_angle(apart[:3, :3])
        if off > SAME_M or turn > SAME_RAD or not np.allclose(own.axis(name), its.axis(name), atol=1e-6):
            faults.append(f"--description: found joint {name} {1e3 * off:.1f} mm and {math.degrees(turn):.2f} deg from "
                          f"its place on this arm, allowed {1e3 * SAME_M:g} mm and {math.degrees(SAME_RAD):.2f} deg")
    return faults


def _place(own, its, link):
    """(link of the arm, its pose to the description's link) for the visuals of that link; None: moved by a joint that
    the arm lacks."""
    moved_by = its.moving(link)
    if moved_by is None:  # a link of the base: it is seen from the first joint
        joint = next(name for name, joint in own.joints.items() if joint.get("type") != "fixed"
                     and own.moving(own.parent(name)) is None)
        other = own.parent(joint)
    elif moved_by in own.joints:
        joint, other = moved_by, own.child(moved_by)
    else:
        return None
    mine = link if own.moving(link) == moved_by and link in own.parents else other
    here, there = (inverse(tree.pose(tree.child(joint))) @ tree.pose(name) for tree, name in ((own, mine), (its, link)))
    return mine, inverse(here) @ there


def _moved(visual, X):
    """The visual, its origin seen from another link. X: pose of its own link there."""
    place = X @ origin_pose(visual)
    origin = visual.find("origin")
    if origin is None:
        origin = ElementTree.Element("origin")
        visual.insert(0, origin)
    origin.set("xyz", " ".join(f"{value:.9g}" for value in place[:3, 3] + 0.0))
    origin.set("rpy", " ".join(f"{value:.9g}" for value in rpy_of(place[:3, :3])))
    return visual


def _anchored(visual, package, beside) -> List[str]:
    """Gives the mesh of a visual its absolute path. Returns faults."""
    faults = []
    for mesh in visual.iter("mesh"):
        text = mesh.get("filename", "")
        if text.startswith(PACKAGE):
            name, _, rest = text[len(PACKAGE):].partition("/")
            folder = package if name in (package.name, _name(package)) else package_path(name)
            path = None if folder is None else folder / rest
        else:
            path = beside / text.replace("file://", "", 1)
        if path is None or not path.is_file():
            faults.append(f"--description: found the mesh {text}, allowed a file; no such file: {path or 'no package'}")
            continue
        mesh.set("filename", str(path.resolve()))
    return faults


def _name(package) -> str:
    """Name in the package.xml of a folder, "" without one."""
    path = package / "package.xml"
    return (ElementTree.parse(path).getroot().findtext("name") or "").strip() if path.is_file() else ""
