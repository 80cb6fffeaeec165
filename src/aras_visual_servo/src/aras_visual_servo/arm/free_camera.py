"""Kinematics of a camera that flies freely: a link behind a floating joint, placed and moved exactly as it is told.

It has the interface of `Kinematics`, so that servo, sequence and sweeps work on it as on an arm. Its six coordinates
are those of the simulator's driven base (`sim.base: driven`): px, py, pz, rx, ry, rz. As positions they are the place
and the rotation vector of the link behind the floating joint in the base, as velocities the twist of that link in its
own axes, [v; w]. Where the camera is that link, the Jacobian is the identity at every attitude. So there is no
singularity, no limit and no posture to choose, and a turn of exactly half a circle about any axis is a turn as any
other.

A rotation vector is not unique at half a turn, and its derivative is not the angular velocity. So nobody may add or
subtract these coordinates: `way` and `moved` do it on the pose itself, by its logarithm and exponential.
"""

import xml.etree.ElementTree as ElementTree

import numpy as np

from ..ground.errors import ModelError, NotFiniteError, ShapeError
from ..spatial import adjoint, exponential, inverse, logarithm, pose_from_rpy, rotation, rotation_vector
from .joint_vectors import JointVectors

NAMES = ("px", "py", "pz", "rx", "ry", "rz")


class FreeCamera(JointVectors):
    """The chain base_link -> floating joint -> tip_link of a URDF.

    Attributes:
        joint_names: NAMES.  lower, upper: (6,) -inf, inf.  velocity: (6,) inf.
        spare_motion: False, every motion of the coordinates moves the camera.
    """

    joint_names, spare_motion = NAMES, False

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str):
        """Raises ModelError: no floating joint that begins at base_link, or another moving joint above the tip."""
        joints = joints_above(urdf_xml, base_link, tip_link)
        kinds = [joint.get("type") for joint in joints]
        if kinds != ["floating"] + ["fixed"] * (len(kinds) - 1):
            raise ModelError(f"camera '{tip_link}': found joints {', '.join(kinds)} between '{base_link}' and it, "
                             "allowed a floating joint and then fixed ones")
        self._X_LC = np.eye(4)
        for joint in joints[1:]:
            self._X_LC = self._X_LC @ _origin(joint)
        self._X_CL = inverse(self._X_LC)
        self._J = adjoint(self._X_CL)
        self.lower, self.upper = np.full(6, -np.inf), np.full(6, np.inf)
        self.velocity = np.full(6, np.inf)

    @staticmethod
    def _checked(q):
        q = np.asarray(q, dtype=float)
        if q.shape != (6,):
            raise ShapeError(f"q: {q.size} values, expected 6")
        if not np.isfinite(q).all():
            raise NotFiniteError("q: a coordinate is not finite")
        return q

    def pose(self, q):
        """X_BC, (4, 4) homogeneous, at coordinates q, (6,). Raises ShapeError, NotFiniteError."""
        return _pose(self._checked(q)) @ self._X_LC

    camera = pose  # as of `Kinematics`

    def jacobian(self, q):
        """J_BC_C, (6, 6): twist of C in B, at C's origin and in its axes, [v; w]; the same at every q."""
        self._checked(q)
        return self._J.copy()

    def held(self, inverse, jacobian, q, q_dot, dt_s, most_part):
        """((6,), 1.0): q_dot itself. There are no limits, and the Jacobian does not change."""
        return q_dot + inverse.turning(jacobian, jacobian, q_dot, most_part), 1.0

    def manipulability(self, q, length_m, rows):
        """(w, (6,) zeros): Yoshikawa's manipulability of these rows of the twist (T42), the same at every q."""
        self._checked(q)
        A = (self._J / np.array([length_m] * 3 + [1.0] * 3)[:, None])[list(rows)]
        return float(np.sqrt(np.linalg.det(A @ A.T))), np.zeros(6)

    def coordinates(self, X_BC):
        """q, (6,), at which the camera has this pose, (4, 4)."""
        return _coordinates(X_BC @ self._X_CL)

    def way(self, start, end):
        """(6,) velocities that, held for one second, bring the camera from one place to another on a screw."""
        return logarithm(inverse(_pose(start)) @ _pose(end))

    def moved(self, q, q_dot, dt_s):
        """(6,) coordinates after velocities q_dot were held for dt_s: X exp(dt q_dot)."""
        return _coordinates(_pose(q) @ exponential(dt_s * q_dot))


def joints_above(urdf_xml, base_link, tip_link):
    """Joints (XML elements) from base_link to tip_link, () where the URDF cannot be read or has no such way."""
    try:
        root = ElementTree.fromstring(urdf_xml)
    except (ElementTree.ParseError, ValueError):
        return []
    above = {joint.find("child").get("link"): joint for joint in root.iterfind("joint")
             if joint.find("child") is not None and joint.find("parent") is not None}
    way, link = [], tip_link
    while link != base_link and link in above and len(way) <= len(above):
        way.insert(0, above[link])
        link = above[link].find("parent").get("link")
    return way if link == base_link else []


def _origin(joint):
    origin = joint.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = ([float(a) for a in origin.get(key, "0 0 0").split()] for key in ("xyz", "rpy"))
    return pose_from_rpy(xyz, rpy)


def _pose(q):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = rotation(q[3:]), q[:3]
    return X


def _coordinates(X):
    return np.concatenate([X[:3, 3], rotation_vector(X[:3, :3])])
