"""Kinematics of the chain from the robot base B to the camera C (KDL, through the C++ module `_kinematics`), and of an
arm that carries the target before a camera that stands still."""

from collections.abc import Mapping
from typing import Callable, Dict, Sequence, Tuple, Union

import numpy as np

from ..ground.errors import ModelError, ParameterError


class RobotKinematics:
    """Interface of every robot's kinematics, and joint vectors by name.

    Attributes:
        joint_names: the moving joints of the chain, SORTED BY NAME: the order of every joint vector.
        lower, upper: (n,) position limits [m or rad], +-inf where the URDF has none (continuous joints).
        velocity: (n,) velocity limits [m/s or rad/s], inf where the URDF has none.
        spare_motion: whether the joints may move without the camera.
        pose: q -> X_BC, (4, 4) homogeneous. Raises ShapeError, NotFiniteError.
        jacobian: q -> J_BC_C, (6, n): twist of C in B, taken at C's origin, expressed in C, [v; w]. Same errors.
        camera: q -> X_BC, (4, 4): where the camera is in the robot's base, to show it.
        way: (start, end) -> (n,) velocities that, held for one second, bring the joints from start to end, (n,) each.
        moved: (q, q_dot, dt_s) -> (n,) joint positions after the velocities q_dot were held for dt_s at q.
        held: inverse, jacobian, q, q_dot, dt_s, most_part -> (q_dot, factor): joint velocities slowed by one factor, so
            that every joint keeps its velocity limit, and corrected by at most `most_part` of them for the change of
            the Jacobian, so that the twist is right half-way while they are held for dt_s. Same errors.
        manipulability: q, length_m, rows of the twist -> (w, (n,) gradient of ln w): Yoshikawa's manipulability of
            these rows, linear ones divided by length_m (docs/theory.md T42); (0, zeros) where it vanishes. Same errors.
    """

    joint_names: Tuple[str, ...]
    lower: np.ndarray
    upper: np.ndarray
    velocity: np.ndarray
    spare_motion: bool
    pose: Callable[[np.ndarray], np.ndarray]
    jacobian: Callable[[np.ndarray], np.ndarray]
    camera: Callable[[np.ndarray], np.ndarray]
    way: Callable[[np.ndarray, np.ndarray], np.ndarray]
    moved: Callable[[np.ndarray, np.ndarray, float], np.ndarray]
    held: Callable[..., Tuple[np.ndarray, float]]
    manipulability: Callable[[np.ndarray, float, Sequence[int]], Tuple[float, np.ndarray]]

    def vector(self, q: Union[Sequence[float], Mapping[str, float]]) -> np.ndarray:
        """Returns a joint vector, never shared with the caller, from an array in the order of joint_names or a mapping.

        A mapping may hold more joints than the chain has. Raises ParameterError when one is missing.
        """
        if isinstance(q, np.ndarray) or not isinstance(q, Mapping):  # to ask for an array first is faster
            return np.array(q, dtype=float)
        try:
            return np.array([q[name] for name in self.joint_names], dtype=float)
        except KeyError:
            missing = [name for name in self.joint_names if name not in q]
            raise ParameterError(f"joints: found {sorted(q)}, missing {missing}") from None

    def by_name(self, vector: np.ndarray) -> Dict[str, float]:
        """Returns a joint vector as a dict."""
        return dict(zip(self.joint_names, vector.tolist()))


class Kinematics(RobotKinematics):
    """Chain base_link -> tip_link of a URDF."""

    spare_motion = True

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str, upwards: bool = False) -> None:
        """Args: upwards: the chain may lead up against joints first, so that the tip need not be below the base.

        Raises ModelError: bad URDF, unknown link, tip not below base, joint types the chain cannot represent.
        """
        from .._kinematics import ChainKinematics  # C++: not needed to read a scenario
        self._chain = ChainKinematics(urdf_xml, base_link, tip_link, upwards)
        self.joint_names = tuple(self._chain.joint_names)
        self.lower, self.upper, self.velocity = self._chain.lower, self._chain.upper, self._chain.velocity
        self.pose, self.jacobian, self.held = self._chain.pose, self._chain.jacobian, self._chain.held
        self.manipulability = self._chain.manipulability

    def camera(self, q: np.ndarray) -> np.ndarray:
        return self.pose(q)

    @staticmethod
    def way(start: np.ndarray, end: np.ndarray) -> np.ndarray:
        return end - start

    @staticmethod
    def moved(q: np.ndarray, q_dot: np.ndarray, dt_s: float) -> np.ndarray:
        return q + dt_s * q_dot


class EyeToHand(Kinematics):
    """An arm that carries the target in front of a camera that stands still (eye-to-hand).

    All laws, and all that the servo knows of the target, go by the pose of the camera in a frame in which the
    target is at rest, and by the twist of the camera there. With the camera in the hand that frame is the robot's
    base B. Here it is the frame E of the link that carries the target. When the joints move this link with the
    twist V_BE_E, the camera moves in it with V_EC_C = -Ad(X_CE) V_BE_E, so that s_dot = L V_EC_C = -L Ad(X_CE)
    J_BE_E q_dot: the minus of eye-to-hand stands in this Jacobian and nowhere else. What the other modules call
    X_BC and J_BC_C is X_EC and J_EC_C here.

    Reference: F. Chaumette and S. Hutchinson, Visual servo control, part II: advanced approaches, IEEE RAM 14(1), 2007.

    It is the chain target_link -> base_link -> tip_link of a URDF.
    """

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str, target_link: str) -> None:
        """Raises ModelError: as `Kinematics`, or the camera does not stand still in the base."""
        carrier = Kinematics(urdf_xml, base_link, target_link)
        super().__init__(urdf_xml, target_link, tip_link, upwards=True)
        if self.joint_names != carrier.joint_names:
            differing = sorted(set(self.joint_names) ^ set(carrier.joint_names))
            raise ModelError(f"camera '{tip_link}': found that it moves in '{base_link}' with the joints "
                             f"{', '.join(differing)}, allowed with target_link a camera that stands still there")
        q = np.zeros(len(self.joint_names))
        self._X_BC = carrier.pose(q) @ self.pose(q)

    def camera(self, q: np.ndarray) -> np.ndarray:
        """Returns X_BC, (4, 4), which no joint changes."""
        return self._X_BC
