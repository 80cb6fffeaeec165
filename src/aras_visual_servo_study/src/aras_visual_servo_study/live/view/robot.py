"""A robot as a page draws it: the tree of its URDF's joints, and what each link looks like.

    robot = robot_of(urdf_xml)              # plain lists and dicts, for JSON
    robot["meshes"]                         # name -> package:// address, for `mesh_block`
"""

import xml.etree.ElementTree as tree
from typing import Any, Dict, List, Tuple

from aras_visual_servo import ModelError, ParameterError, resolve_uri
from .meshes import mesh_block

GREY = [0.6, 0.6, 0.62, 1.0]
MOVING = ("prismatic", "revolute", "continuous")


def robot_of(urdf_xml: str) -> Dict[str, Any]:
    """The robot of a URDF: dict root, joints, links, meshes.

    joints: list of name, type, parent, child, xyz [m], rpy [rad], axis, lower, upper (None: unbounded).
    links: name -> list of visuals: xyz, rpy, color (rgba, 0 to 1), and one of box (edges), cylinder (radius, length),
        sphere (radius) [m], or mesh (a name of `meshes`) with scale.
    Raises ModelError: the text is no URDF.
    """
    try:
        robot = tree.fromstring(urdf_xml)
    except tree.ParseError as error:
        raise ModelError(f"robot: not XML: {error}") from error
    colors = {material.get("name"): _color(material) for material in robot.findall("material")}
    meshes = {}
    joints = [_joint(joint) for joint in robot.findall("joint")]
    links = {link.get("name"): list(filter(None, (_visual(entry, colors, meshes) for entry in link.findall("visual"))))
             for link in robot.findall("link")}
    children = {joint["child"] for joint in joints}
    roots = [name for name in links if name not in children]
    if len(roots) != 1:
        raise ModelError(f"robot: found the root links {', '.join(roots) or 'none'}, allowed one")
    return {"root": roots[0], "joints": joints, "links": links, "meshes": meshes}


def mesh_blocks(robot: Dict[str, Any]) -> Tuple[Dict[str, bytes], List[str]]:
    """(name -> block, notes): the meshes of `robot_of` as bytes, and a line for each that cannot be drawn."""
    blocks, notes = {}, []
    for name, uri in robot["meshes"].items():
        try:
            blocks[name] = mesh_block(str(resolve_uri(uri, key="mesh")))
        except (ModelError, ParameterError) as error:
            notes.append(f"not drawn: {error}")
    return blocks, notes


def _numbers(text, default):
    return [float(word) for word in text.split()] if text else list(default)


def _origin(element):
    origin = element.find("origin")
    get = (lambda key: None) if origin is None else origin.get
    return {"xyz": _numbers(get("xyz"), (0, 0, 0)), "rpy": _numbers(get("rpy"), (0, 0, 0))}


def _color(material):
    color = None if material is None else material.find("color")
    return None if color is None else _numbers(color.get("rgba"), GREY)


def _joint(joint):
    limit, axis, kind = joint.find("limit"), joint.find("axis"), joint.get("type")
    bounded = limit is not None and kind in ("prismatic", "revolute")
    return {"name": joint.get("name"), "type": kind, "parent": joint.find("parent").get("link"),
            "child": joint.find("child").get("link"), **_origin(joint),
            "axis": _numbers(None if axis is None else axis.get("xyz"), (1, 0, 0)),
            "lower": float(limit.get("lower", 0)) if bounded else None,
            "upper": float(limit.get("upper", 0)) if bounded else None}


def _visual(visual, colors, meshes):
    geometry, material = visual.find("geometry"), visual.find("material")
    shape = {} if geometry is None else {child.tag: child for child in geometry}
    look = {**_origin(visual),
            "color": _color(material) or colors.get(None if material is None else material.get("name")) or GREY}
    if "mesh" in shape:
        uri = shape["mesh"].get("filename")
        name = next((name for name, known in meshes.items() if known == uri), None)
        if name is None:
            name = f"{len(meshes)}-{uri.rpartition('/')[2]}"
            meshes[name] = uri
        return {**look, "mesh": name, "scale": _numbers(shape["mesh"].get("scale"), (1, 1, 1))}
    if "box" in shape:
        return {**look, "box": _numbers(shape["box"].get("size"), (1, 1, 1))}
    if "cylinder" in shape:
        return {**look, "cylinder": [float(shape["cylinder"].get(key)) for key in ("radius", "length")]}
    if "sphere" in shape:
        return {**look, "sphere": float(shape["sphere"].get("radius"))}
    return None
