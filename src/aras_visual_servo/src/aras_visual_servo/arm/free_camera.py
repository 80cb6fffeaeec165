"""Kinematics of a camera that flies freely: a link behind a floating joint, placed and moved exactly as it is told.

Servo, sequence and sweeps work on it as on an arm. Its six coordinates are those of the simulator's driven base
(`sim.base: driven`): px, py, pz, rx, ry, rz. As positions they are the place and the rotation vector of the link behind
the floating joint in the base. As velocities they are the twist of that link in its own axes, [v; w]. The Jacobian is
the same at every attitude, so there is no singularity.

A rotation vector is not unique at half a turn, and its derivative is not the angular velocity. Never add or subtract
these coordinates: `way` and `moved` work on the pose itself, by its logarithm and exponential.
"""

import xml.etree.ElementTree as ElementTree
from typing import Any, List, Sequence, Tuple

import numpy as np

from ..ground.errors import ModelError, NotFiniteError, ShapeError
from ..spatial import adjoint, exponential, inverse, logarithm, pose_from_rpy, rotation, rotation_vector, transform
from .kinematics import RobotKinematics

NAMES = ("px", "py", "pz", "rx", "ry", "rz")


class FreeCamera(RobotKinematics):
    """The chain base_link -> floating joint -> tip_link of a URDF; its six coordinates have no limits."""

    joint_names, spare_motion = NAMES, False

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str) -> None:
        """Raises ModelError: no floating joint that begins at base_link, or another moving joint above the tip."""
        joints = joints_above(urdf_xml, base_link, tip_link)
        kinds = [joint.get("type", "") for joint in joints]
        if kinds != ["floating"] + ["fixed"] * (len(kinds) - 1):
            raise ModelError(f"camera '{tip_link}': found joints {', '.join(kinds)} between '{base_link}' and it, "
                             "allowed a floating joint and then fixed ones")
        self._X_LC = np.eye(4)
        for joint in joints[1:]:
            self._X_LC = self._X_LC @ origin_pose(joint)
        self._X_CL = inverse(self._X_LC)
        self._J = adjoint(self._X_CL)
        self.lower, self.upper = np.full(6, -np.inf), np.full(6, np.inf)
        self.velocity = np.full(6, np.inf)

    @staticmethod
    def _checked(q: np.ndarray) -> np.ndarray:
        q = np.asarray(q, dtype=float)
        if q.shape != (6,):
            raise ShapeError(f"q: {q.size} values, expected 6")
        if not np.isfinite(q).all():
            raise NotFiniteError("q: a coordinate is not finite")
        return q

    def pose(self, q: np.ndarray) -> np.ndarray:
        return _pose(self._checked(q)) @ self._X_LC

    def camera(self, q: np.ndarray) -> np.ndarray:
        return self.pose(q)

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        self._checked(q)
        return self._J.copy()

    def held(self, inverse: Any, jacobian: np.ndarray, q: np.ndarray, q_dot: np.ndarray, dt_s: float,
             most_part: float) -> Tuple[np.ndarray, float]:
        """Returns q_dot itself: there are no limits, and the Jacobian does not change."""
        return q_dot + inverse.turning(jacobian, jacobian, q_dot, most_part), 1.0

    def manipulability(self, q: np.ndarray, length_m: float, rows: Sequence[int]) -> Tuple[float, np.ndarray]:
        """Returns (w, zeros): w is the same at every q."""
        self._checked(q)
        A = (self._J / np.array([length_m] * 3 + [1.0] * 3)[:, None])[list(rows)]
        return float(np.sqrt(np.linalg.det(A @ A.T))), np.zeros(6)

    def coordinates(self, X_BC: np.ndarray) -> np.ndarray:
        """Returns q, (6,), at which the camera has this pose, (4, 4)."""
        return _coordinates(X_BC @ self._X_CL)

    def way(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Returns the velocities that, held for one second, bring the camera from start to end on a screw, (6,)."""
        return logarithm(inverse(_pose(start)) @ _pose(end))

    def moved(self, q: np.ndarray, q_dot: np.ndarray, dt_s: float) -> np.ndarray:
        """Returns the coordinates of X exp(dt q_dot)."""
        return _coordinates(_pose(q) @ exponential(dt_s * q_dot))


def joints_above(urdf_xml: str, base_link: str, tip_link: str) -> List[ElementTree.Element]:
    """Returns the joints from base_link to tip_link, none where the URDF cannot be read or has no such way."""
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


def origin_pose(element: ElementTree.Element) -> np.ndarray:
    """Returns the (4, 4) pose that `<origin>` gives a joint, a visual or another element of a URDF."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    xyz, rpy = ([float(a) for a in origin.get(key, "0 0 0").split()] for key in ("xyz", "rpy"))
    return pose_from_rpy(xyz, rpy)


def _pose(q):
    return transform(rotation(q[3:]), q[:3])


def _coordinates(X):
    return np.concatenate([X[:3, 3], rotation_vector(X[:3, :3])])
