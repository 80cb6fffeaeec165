"""Applies Gazebo's rules to the visuals of a URDF."""
import os
import typing
import xml.etree.ElementTree as ElementTree

from ..sdf.materials import SCRIPTED

#: Files of meshes that have materials of their own.
PAINTED = (".dae", ".obj")
WHITE = "1 1 1 1"


def paint_as_gazebo(robot: ElementTree.Element) -> None:
    """Makes visuals white, but meshes with materials of their own: Gazebo does not look at <material> of a URDF.

    <gazebo reference="LINK"><material> stays and has the last word; pictures of a package's scripts stay too.
    """
    for visual in robot.findall("link/visual"):
        if visual.find("material") is not None and visual.find("material").get("name", "").startswith(SCRIPTED):
            continue
        for material in visual.findall("material"):
            visual.remove(material)
        mesh = visual.find("geometry/mesh")
        if mesh is None or not mesh.get("filename", "").lower().endswith(PAINTED):
            ElementTree.SubElement(ElementTree.SubElement(visual, "material", name=""), "color", rgba=WHITE)
    for material in robot.findall("material"):
        robot.remove(material)


def drop_missing_meshes(robot: ElementTree.Element) -> typing.List[str]:
    """Takes out visuals and collisions whose file of a mesh is not there, as Gazebo does. Returns a line for each file.
    """
    missing = {}
    for link in robot.findall("link"):
        for part in link.findall("visual") + link.findall("collision"):
            mesh = part.find("geometry/mesh")
            name = "" if mesh is None else mesh.get("filename", "")
            if not name.startswith(("file://", "/", "package://", "model://")):
                continue  # a relative name has no base folder: the simulator rejects it
            if not os.path.isfile(name.replace("file://", "", 1)):
                link.remove(part)
                missing.setdefault(name, []).append(link.get("name"))
    return ["mesh %s of %s: there is no such file: ignored" % (name, ", ".join(dict.fromkeys(links)))
            for name, links in missing.items()]
