"""What Gazebo makes of the visuals of a URDF."""
import xml.etree.ElementTree as ElementTree

#: Files of meshes that have materials of their own.
PAINTED = (".dae", ".obj")
WHITE = "1 1 1 1"


def paint_as_gazebo(robot):
    """Makes visuals white, but meshes with materials of their own: Gazebo does not look at <material> of a URDF.

    <gazebo reference="LINK"><material> stays and has the last word.
    """
    for visual in robot.findall("link/visual"):
        for material in visual.findall("material"):
            visual.remove(material)
        mesh = visual.find("geometry/mesh")
        if mesh is None or not mesh.get("filename", "").lower().endswith(PAINTED):
            ElementTree.SubElement(ElementTree.SubElement(visual, "material", name=""), "color", rgba=WHITE)
    for material in robot.findall("material"):
        robot.remove(material)
