"""Links of one model as solids in the simulation of another, which draws them or lets its own links touch them."""
import copy
import xml.etree.ElementTree as ElementTree

import numpy
import scipy.spatial

from aras_visual_servo_sim import ArasError, mesh_triangles

#: Share of its convex hull that a mesh fills; what fills less is hollow or open, and its hull cannot stand for it.
CONVEX_SHARE = 0.9
_convex = {}  #: of the meshes read so far


def solid_of(robot, link, name, seen, touched):
    """Entry of the simulator's sim.scene.solids[], None if the link has nothing of the kind.

    Args:
        robot: root element of a URDF.  link, name: of the link, of the solid.
        seen, touched: whether it has the link's <visual>s, its <collision>s.
    """
    alone = ElementTree.Element("robot", name=name)
    own = next(each for each in robot.findall("link") if each.get("name") == link)
    looks = [each for each in robot.findall("gazebo") if each.get("reference") == link]
    made = ElementTree.SubElement(alone, "link", name=link)
    if seen:
        made.extend(copy.deepcopy(each) for each in own.findall("visual"))
        alone.extend(copy.deepcopy(each) for each in looks
                     if any(each.find(tag) is not None for tag in ("material", "light", "visual")))
    if touched:
        made.extend(copy.deepcopy(each) for each in own.findall("collision") if convex(each))
    if made.find("visual") is None and made.find("collision") is None:
        return None
    entry = {"name": name, "urdf": ElementTree.tostring(alone, encoding="unicode")}
    if made.find("collision") is not None:
        entry["touches"] = "robot"
    shadows = [each.findtext("visual/cast_shadows", "true").strip() for each in looks
               if each.find("visual") is not None]
    if shadows and all(each in ("false", "0") for each in shadows):
        entry["material"] = {"casts_shadows": False}
    return entry


def convex(collision):
    """Whether the shape of a <collision> is what its convex hull is."""
    mesh = collision.find("geometry/mesh")
    if mesh is None:
        return True
    path = mesh.get("filename", "").replace("file://", "", 1)
    if path not in _convex:
        _convex[path] = filled_share(path) >= CONVEX_SHARE
    return _convex[path]


def filled_share(path):
    """Volume of a mesh over that of its convex hull; 0 for what cannot be read or is flat."""
    try:
        corners = mesh_triangles(path).astype(float)
        volume = abs(numpy.einsum("ij,ij->i", corners[:, 0], numpy.cross(corners[:, 1], corners[:, 2])).sum()) / 6.0
        return float(volume / scipy.spatial.ConvexHull(corners.reshape(-1, 3)).volume)
    except (ArasError, scipy.spatial.QhullError, ZeroDivisionError, ValueError):
        return 0.0
