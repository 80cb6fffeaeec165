"""Inverse dynamics of a tree of joints, linear in the inertial parameters of the links, over many samples at once."""

from dataclasses import dataclass
from typing import Dict, List, Sequence, Tuple
from xml.etree import ElementTree

import numpy as np

from aras_visual_servo import ModelError, root_link
from aras_visual_servo.spatial import rotation_rpy

MOVING = ("revolute", "continuous", "prismatic")


@dataclass(frozen=True)
class Inertia:
    """Attributes:
        mass: [kg].  first: (3,) mass times centre of mass [kg m].  second: (3, 3) about the link's origin [kg m^2].
        All in the frame of the link.
    """

    mass: float
    first: np.ndarray
    second: np.ndarray


@dataclass(frozen=True)
class _Joint:
    name: str
    kind: str
    parent: str
    child: str
    place: np.ndarray  # (3,)
    turn: np.ndarray  # (3, 3)
    axis: np.ndarray  # (3,)


class TreeDynamics:
    """Inverse dynamics of the moving joints of a URDF whose root is held in the world.

    Attributes:
        joint_names: in the order of every joint vector, sorted.  inertias: link -> `Inertia` of the URDF.
        damping, friction: (m,) of the URDF, in the order of joint_names.
    Raises:
        ParameterError: no XML, no or several root links.
        ModelError: a joint that is neither fixed, revolute, continuous nor prismatic.
    """

    def __init__(self, urdf_xml: str) -> None:
        root = root_link(urdf_xml)
        robot = ElementTree.fromstring(urdf_xml)
        joints = [_joint(element) for element in robot.findall("joint")]
        wrong = [f"{joint.name} ({joint.kind})" for joint in joints if joint.kind not in (*MOVING, "fixed")]
        mimics = [element.get("name", "") for element in robot.findall("joint") if element.find("mimic") is not None]
        if wrong or mimics:
            raise ModelError(f"joints: found {', '.join(wrong + [m + ' (mimic)' for m in mimics])}, allowed fixed, "
                             f"{', '.join(MOVING)} joints without mimic")
        self.inertias = {link.get("name", ""): _inertia(link) for link in robot.findall("link")}
        self._root, self._order = root, _from(root, joints)
        self.joint_names = tuple(sorted(joint.name for joint in joints if joint.kind in MOVING))
        self._above: Dict[str, List[str]] = {root: []}  # link -> moving joints that carry it
        for joint in self._order:
            carrying = [joint.name] if joint.kind in MOVING else []
            self._above[joint.child] = self._above[joint.parent] + carrying
        dynamics = {element.get("name"): element.find("dynamics") for element in robot.findall("joint")}
        self.damping, self.friction = (
            np.array([0.0 if dynamics[name] is None else float(dynamics[name].get(key, 0.0))  # type: ignore[union-attr]
                      for name in self.joint_names]) for key in ("damping", "friction"))

    def efforts(self, inertias: Sequence[Dict[str, Inertia]], motion: Sequence[np.ndarray],
                gravity_m_s2: Sequence[float]) -> np.ndarray:
        """Returns (p, n, m) efforts [N or N m] that give the links of each of p sets the motion, without friction.

        Newton and Euler for each link, and virtual work for the joints that carry it (Featherstone, Rigid Body Dynamics
        Algorithms, 2008, section 2.14 and 5.3).

        Args:
            inertias: p sets, link -> `Inertia`; links that are left out have none.
            motion: positions, velocities, accelerations, (n, m) each.
            gravity_m_s2: (3,) acceleration of gravity in the world.
        """
        q, v, a = (dict(zip(self.joint_names, np.asarray(values, dtype=float).T)) for values in motion)
        n = len(motion[0])
        zero = np.zeros((n, 3))
        states = {self._root: (np.broadcast_to(np.eye(3), (n, 3, 3)), zero, zero, zero,
                               zero - np.asarray(gravity_m_s2, dtype=float))}
        axes: Dict[str, Tuple[str, np.ndarray, np.ndarray]] = {}
        for joint in self._order:
            turn, place, spin, spin_dot, pull = states[joint.parent]
            lever = turn @ joint.place
            place = place + lever
            pull = pull + np.cross(spin_dot, lever) + np.cross(spin, np.cross(spin, lever))
            turn = turn @ joint.turn
            if joint.kind != "fixed":
                axis = turn @ joint.axis
                q_j, v_j, a_j = q[joint.name], v[joint.name][:, None], a[joint.name][:, None]
                if joint.kind == "prismatic":
                    slide = axis * q_j[:, None]
                    place = place + slide
                    pull = (pull + np.cross(spin_dot, slide) + np.cross(spin, np.cross(spin, slide))
                            + 2.0 * np.cross(spin, axis * v_j) + axis * a_j)
                else:
                    turn = turn @ _turns(joint.axis, q_j)
                    spin_dot = spin_dot + axis * a_j + np.cross(spin, axis * v_j)
                    spin = spin + axis * v_j
                axes[joint.name] = (joint.kind, axis, place)
            states[joint.child] = (turn, place, spin, spin_dot, pull)
        efforts = np.zeros((len(inertias), n, len(self.joint_names)))
        for i, links in enumerate(inertias):
            for link, inertia in links.items():
                self._add(efforts[i], link, inertia, states[link], axes)
        return efforts

    def _add(self, efforts, link, inertia, state, axes):
        """Adds what one link asks of the joints that carry it."""
        turn, place, spin, spin_dot, pull = state
        first = turn @ inertia.first
        second = turn @ inertia.second @ turn.transpose(0, 2, 1)
        force = inertia.mass * pull + np.cross(spin_dot, first) + np.cross(spin, np.cross(spin, first))
        moment = (np.einsum("nij,nj->ni", second, spin_dot) + np.cross(first, pull)
                  + np.cross(spin, np.einsum("nij,nj->ni", second, spin)))
        for name in self._above[link]:
            kind, axis, at = axes[name]
            total = force if kind == "prismatic" else moment + np.cross(place - at, force)
            efforts[:, self.joint_names.index(name)] += np.sum(axis * total, axis=1)


def _from(root, joints):
    """Joints in an order in which each follows those that carry it."""
    order, links = [], [root]
    while links:
        link = links.pop()
        below = [joint for joint in joints if joint.parent == link]
        order += below
        links += [joint.child for joint in below]
    return order


def _joint(element):
    origin, axis = element.find("origin"), element.find("axis")
    place, turn = _pose(origin)
    axis = _numbers(None if axis is None else axis.get("xyz"), (1.0, 0.0, 0.0))
    return _Joint(element.get("name"), element.get("type"), element.find("parent").get("link"),
                  element.find("child").get("link"), place, turn, axis / (np.linalg.norm(axis) or 1.0))


def _inertia(link):
    element = link.find("inertial")
    if element is None:
        return Inertia(0.0, np.zeros(3), np.zeros((3, 3)))
    mass = float(element.find("mass").get("value"))
    centre, turn = _pose(element.find("origin"))
    i = {key: float(value) for key, value in element.find("inertia").attrib.items()}
    about_centre = np.array([[i["ixx"], i["ixy"], i["ixz"]], [i["ixy"], i["iyy"], i["iyz"]],
                             [i["ixz"], i["iyz"], i["izz"]]])
    steiner = mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return Inertia(mass, mass * centre, turn @ about_centre @ turn.T + steiner)


def _pose(origin):
    place = _numbers(None if origin is None else origin.get("xyz"), (0.0, 0.0, 0.0))
    return place, rotation_rpy(_numbers(None if origin is None else origin.get("rpy"), (0.0, 0.0, 0.0)))


def _turns(axis, angles):
    """(n, 3, 3) rotations about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sine, versine = np.sin(angles)[:, None, None], (1.0 - np.cos(angles))[:, None, None]
    return np.eye(3) + sine * cross + versine * (cross @ cross)


def _numbers(text, default):
    return np.array(default if text is None else [float(word) for word in text.split()], dtype=float)
