"""A robot as a page draws it: the tree of its URDF's joints, and what each link looks like.

    robot = robot_of(urdf_xml)              # plain lists and dicts, for JSON
    robot["meshes"]                         # name -> package:// address, for `mesh_block`

A mesh is sent as a small binary block: every vertex once, in steps of 1/65535 of the mesh's box. A block is,
little-endian: the number of vertices and of triangles (uint32 each), the lowest corner of the box and the step along
each axis (float32, 3 each), the vertices (uint16, 3 each), padding to four bytes, and the triangles (uint32, 3 each).
`web/lib/meshes.js` reads it.
"""

import functools
import xml.etree.ElementTree as tree
from pathlib import Path
from typing import Any, Dict, List, Tuple, Union

import numpy as np

from aras_visual_servo import ModelError, ParameterError, resolve_uri

STEPS = 65535
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
        raise ModelError(f"robot: found the root links {', '.join(map(str, roots)) or 'none'}, allowed one")
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


@functools.lru_cache(maxsize=128)
def mesh_block(path: str) -> bytes:
    """The block, bytes, of a mesh file. Raises ModelError: it cannot be read."""
    return as_block(triangles_of(path))


def as_block(corners: np.ndarray) -> bytes:
    """The block of triangles, float (n, 3, 3) [m]; corners that fall together become one vertex."""
    points = np.asarray(corners, dtype=float).reshape(-1, 3)
    low, high = points.min(axis=0), points.max(axis=0)
    step = np.maximum(high - low, 1e-9) / STEPS
    cells = np.round((points - low) / step).astype(np.uint16)
    # The three cells of a corner as one number sort ten times as fast as three numbers.
    packed, index = np.unique(cells.astype(np.uint64) @ np.array([1 << 32, 1 << 16, 1], np.uint64), return_inverse=True)
    vertices = np.stack([packed >> np.uint64(shift) & np.uint64(STEPS) for shift in (32, 16, 0)], axis=1)
    index = index.reshape(-1, 3)
    # A triangle with two corners in one cell has no area.
    index = index[(index[:, 0] != index[:, 1]) & (index[:, 1] != index[:, 2]) & (index[:, 2] != index[:, 0])]
    head = np.array([len(vertices), len(index)], "<u4").tobytes() + np.concatenate([low, step]).astype("<f4").tobytes()
    flat = vertices.astype("<u2").tobytes()
    return head + flat + bytes(-len(flat) % 4) + index.astype("<u4").tobytes()


def triangles_of(path: Union[str, Path]) -> np.ndarray:
    """Corners, float (n, 3, 3) [m], of a mesh file of any kind that the simulator reads. Raises ModelError."""
    from aras_visual_servo_sim import mesh_triangles  # C++: not needed to import this
    try:
        corners = mesh_triangles(str(path))
    except RuntimeError as error:
        raise ModelError(str(error)) from error
    if not np.isfinite(corners).all():
        raise ModelError(f"mesh '{path}': found numbers that are not finite")
    return corners


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
