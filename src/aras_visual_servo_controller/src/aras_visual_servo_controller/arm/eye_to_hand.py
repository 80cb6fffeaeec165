"""Kinematics of an arm that carries the target in front of a camera that stands still (eye-to-hand).

All laws, and all that the servo knows of the target, go by the pose of the camera in a frame in which the target is at
rest, and by the twist of the camera there. With the camera in the hand that frame is the robot's base B. Here it is the
frame E of the link that carries the target. When the joints move this link with the twist V_BE_E, the camera moves in
it with V_EC_C = -Ad(X_CE) V_BE_E, so that s_dot = L V_EC_C = -L Ad(X_CE) J_BE_E q_dot: the minus of eye-to-hand stands
in this Jacobian and nowhere else. What the other modules call X_BC and J_BC_C is X_EC and J_EC_C here.

Reference: F. Chaumette and S. Hutchinson, Visual servo control, part II: advanced approaches, IEEE RAM 14(1), 2007.
"""

import numpy as np

from ..ground.errors import ModelError
from .kinematics import Kinematics


class EyeToHand(Kinematics):
    """The chain target_link -> base_link -> tip_link of a URDF: the interface of `Kinematics`, in the frame E."""

    def __init__(self, urdf_xml: str, base_link: str, tip_link: str, target_link: str):
        """Raises ModelError: as `Kinematics`, or the camera does not stand still in the base."""
        carrier = Kinematics(urdf_xml, base_link, target_link)
        super().__init__(urdf_xml, target_link, tip_link, upwards=True)
        if self.joint_names != carrier.joint_names:
            differing = sorted(set(self.joint_names) ^ set(carrier.joint_names))
            raise ModelError(f"camera '{tip_link}': found that it moves in '{base_link}' with the joints "
                             f"{', '.join(differing)}, allowed with target_link a camera that stands still there")
        q = np.zeros(len(self.joint_names))
        self._X_BC = carrier.pose(q) @ self.pose(q)

    def camera(self, q):
        """X_BC, (4, 4), which no joint changes."""
        return self._X_BC
