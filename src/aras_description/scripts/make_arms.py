#!/usr/bin/env python3
"""Writes arm.urdf of every folder of arms from its table.yaml, which holds the published figures and their sources.

Shapes are cylinders of our own that follow the outline of the arm. Run without arguments; the output is the same bytes
on every run.
"""

import argparse
import pathlib
import sys
from xml.etree import ElementTree

import numpy as np
import yaml

ARMS = pathlib.Path(__file__).resolve().parent.parent / "arms"
COLOURS = {"white": (0.93, 0.93, 0.92), "grey": (0.7, 0.71, 0.73), "dark": (0.12, 0.12, 0.13),
           "blue": (0.36, 0.55, 0.74), "orange": (0.9, 0.45, 0.1), "yellow": (0.95, 0.76, 0.15)}
#: Mass [kg] and size [m] of the camera's body, along x (view), y and z: a common depth camera.
CAMERA_KG, CAMERA_M = 0.1, (0.025, 0.09, 0.025)
#: Axes of an optical frame (z is the view, x right) in those of a body whose x is the view and whose z is up.
R_BODY_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def rotation(roll, pitch, yaw):
    """Rotation matrix of fixed-axis roll, pitch, yaw [rad], as URDF defines it, shape (3, 3)."""
    (a, b, c), (d, e, f) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    return np.array([[c * b, c * e * d - f * a, c * e * a + f * d], [f * b, f * e * d + c * a, f * e * a - c * d],
                     [-e, b * d, b * a]])


def rpy_of(matrix):
    """Roll, pitch, yaw [rad] of a rotation matrix; with the pitch at a right angle the roll is 0."""
    pitch = np.arctan2(-matrix[2, 0], np.hypot(matrix[0, 0], matrix[1, 0]))
    if abs(matrix[2, 0]) > 1.0 - 1e-12:
        return 0.0, pitch, np.arctan2(-matrix[0, 1], matrix[1, 1])
    return np.arctan2(matrix[2, 1], matrix[2, 2]), pitch, np.arctan2(matrix[1, 0], matrix[0, 0])


def numbers(values):
    """Text of numbers with ten digits, which is below a nanometre."""
    return " ".join(f"{value:.10g}" for value in np.round(np.asarray(values, dtype=float), 12) + 0.0)


def origin(node, xyz=(0, 0, 0), rpy=(0, 0, 0)):
    """Adds <origin>, [m] and [rad]."""
    ElementTree.SubElement(node, "origin", xyz=numbers(xyz), rpy=numbers(rpy))


def inertial(link, mass, com, moments):
    """Adds <inertial>: mass [kg], com [m], moments (ixx, iyy, izz, ixy, ixz, iyz) about it [kg m^2]."""
    node = ElementTree.SubElement(link, "inertial")
    origin(node, com)
    ElementTree.SubElement(node, "mass", value=numbers([mass]))
    ElementTree.SubElement(node, "inertia", **dict(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
                                                       (numbers([value]) for value in moments))))


def cylinder_moments(mass, radius, length, axis):
    """Moments of a solid cylinder along x, y or z about its centre, as `inertial` takes them [kg m^2]."""
    across, along = mass * (3 * radius**2 + length**2) / 12, mass * radius**2 / 2
    return [along if axis == name else across for name in "xyz"] + [0.0, 0.0, 0.0]


def shape(link, geometry, size, colour, xyz, rpy):
    """Adds a shape as <visual> and as <collision>."""
    for kind in ("visual", "collision"):
        node = ElementTree.SubElement(link, kind)
        origin(node, xyz, rpy)
        ElementTree.SubElement(ElementTree.SubElement(node, "geometry"), geometry, **size)
        if kind == "visual":
            ElementTree.SubElement(node, "material", name=colour)


def tube(link, colour, radius, start, end):
    """Adds a cylinder from one point to another [m]."""
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    way = end - start
    pitch, yaw = np.arctan2(np.hypot(way[0], way[1]), way[2]), np.arctan2(way[1], way[0])
    shape(link, "cylinder", {"radius": numbers([radius]), "length": numbers([np.linalg.norm(way)])}, colour,
          (start + end) / 2, (0.0, pitch, yaw))


def fixed(robot, name, parent, child, xyz, rpy):
    """Adds a fixed joint."""
    joint = ElementTree.SubElement(robot, "joint", name=name, type="fixed")
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    origin(joint, xyz, rpy)


def moving(robot, name, entry, unit, dynamics):
    """Adds a joint that turns about its z: revolute, or continuous where it has no limits of position."""
    lower, upper, velocity, effort = entry["limits"]
    joint = ElementTree.SubElement(robot, "joint", name=name, type="continuous" if lower is None else "revolute")
    ElementTree.SubElement(joint, "parent", link=entry["parent"])
    ElementTree.SubElement(joint, "child", link=entry["child"])
    origin(joint, entry.get("xyz", (0, 0, 0)), np.radians(entry.get("rpy", (0, 0, 0))))
    ElementTree.SubElement(joint, "axis", xyz="0 0 1")
    bounds = {} if lower is None else {"lower": numbers([lower * unit]), "upper": numbers([upper * unit])}
    ElementTree.SubElement(joint, "limit", **bounds, effort=numbers([effort]), velocity=numbers([velocity * unit]))
    ElementTree.SubElement(joint, "dynamics", damping=numbers(dynamics[:1]), friction=numbers(dynamics[1:]))


def camera(robot, entry):
    """Adds the links of the camera: the optical frame, and the body before it, unless the arm's own link holds it."""
    R_PO = rotation(*np.radians(entry["rpy"]))
    parent, xyz, rpy = entry["parent"], entry["xyz"], rpy_of(R_PO)
    if entry["body"]:
        fixed(robot, "camera_joint", parent, "camera_link", xyz, rpy_of(R_PO @ R_BODY_OPTICAL.T))
        link = ElementTree.SubElement(robot, "link", name="camera_link")
        x, y, z = CAMERA_M
        inertial(link, CAMERA_KG, (-x / 2, 0, 0), [CAMERA_KG / 12 * part for part in
                                                   (y**2 + z**2, x**2 + z**2, x**2 + y**2)] + [0.0, 0.0, 0.0])
        shape(link, "box", {"size": numbers(CAMERA_M)}, "dark", (-x / 2, 0, 0), (0, 0, 0))
        parent, xyz, rpy = "camera_link", (0, 0, 0), rpy_of(R_BODY_OPTICAL)
    fixed(robot, "camera_optical_joint", parent, "camera_optical_frame", xyz, rpy)
    ElementTree.SubElement(robot, "link", name="camera_optical_frame")


def urdf(table):
    """Returns the text of the URDF of a table."""
    robot = ElementTree.Element("robot", name=table["name"])
    for name, rgb in COLOURS.items():
        ElementTree.SubElement(ElementTree.SubElement(robot, "material", name=name), "color",
                               rgba=numbers((*rgb, 1.0)))
    links = {entry[end] for entry in table["joints"].values() for end in ("parent", "child")}
    for name in ["world", *sorted(links - {"world", *table["links"]}), *table["links"]]:
        link, entry = ElementTree.SubElement(robot, "link", name=name), table["links"].get(name, {})
        if "mass" in entry:
            moments = entry.get("inertia") or cylinder_moments(entry["mass"], *entry["cylinder"])
            inertial(link, entry["mass"], entry["com"], moments)
        for each in entry.get("shapes", ()):
            tube(link, *each)
    unit = np.pi / 180 if table["angles"] == "deg" else 1.0
    for name, entry in table["joints"].items():
        if "limits" in entry:
            moving(robot, name, entry, unit, table["dynamics"])
        else:
            fixed(robot, name, entry["parent"], entry["child"], entry.get("xyz", (0, 0, 0)),
                  np.radians(entry.get("rpy", (0, 0, 0))))
    camera(robot, table["camera"])
    for name in (name for name, entry in table["joints"].items() if "limits" in entry):
        node = ElementTree.SubElement(robot, "transmission", name=f"{name}_transmission")
        ElementTree.SubElement(node, "type").text = "transmission_interface/SimpleTransmission"
        for tag, of in (("joint", name), ("actuator", f"{name}_motor")):
            part = ElementTree.SubElement(node, tag, name=of)
            ElementTree.SubElement(part, "hardwareInterface").text = "hardware_interface/PositionJointInterface"
        ElementTree.SubElement(part, "mechanicalReduction").text = "1"
    ElementTree.indent(robot)
    return "\n".join(['<?xml version="1.0"?>',
                      f"<!-- {table['name']}: made from table.yaml, which has the source of each value, by "
                      "scripts/make_arms.py. -->",
                      ElementTree.tostring(robot, encoding="unicode"), ""])


def main(argv=None):
    """Writes the files; with --check only compares. Returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="only say which files differ")
    check, differing = parser.parse_args(argv).check, []
    for path in sorted(ARMS.glob("*/table.yaml")):
        made, target = urdf(yaml.safe_load(path.read_text(encoding="utf-8"))), path.parent / "arm.urdf"
        if not target.is_file() or target.read_text(encoding="utf-8") != made:
            differing.append(str(target))
            if not check:
                target.write_text(made, encoding="utf-8")
    print("\n".join(differing) or "nothing differs")
    return 1 if check and differing else 0


if __name__ == "__main__":
    sys.exit(main())
