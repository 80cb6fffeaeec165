"""A camera twist of a ROS 2 node as a joint command with the stamp of the image that it answers. No ROS here."""

import threading
from collections import OrderedDict
from typing import Any, Dict, Optional

import numpy as np

from aras_visual_servo import TwistInverse

#: Joint positions of so many images are kept.
KEPT = 100
#: Wall time for which a twist waits for the joint positions of its stamp [s].
PATIENCE_S = 1.0


class TwistToJoints:
    """Turns twists of the camera into joint velocities, at the joint positions of the same stamp.

    Args: kinematics: `Kinematics` of the chain to the camera.
    """

    def __init__(self, kinematics: Any) -> None:
        self._kinematics = kinematics
        self._invert = TwistInverse(np.ones(len(kinematics.joint_names)))
        self._positions: "OrderedDict[int, np.ndarray]" = OrderedDict()
        self._came = threading.Condition()

    def add(self, stamp_ns: int, q: np.ndarray) -> None:
        """Keeps the joint positions, (n,) [m or rad], of a stamp."""
        with self._came:
            if self._positions and stamp_ns < next(reversed(self._positions)):
                self._positions.clear()  # time was set back
            self._positions[stamp_ns] = q
            while len(self._positions) > KEPT:
                self._positions.popitem(last=False)
            self._came.notify_all()

    def velocities(self, stamp_ns: int, twist: np.ndarray) -> Optional[Dict[str, float]]:
        """Returns joint -> velocity [m/s or rad/s], scaled to the velocity limits as a whole.

        Args: twist: (6,) of the camera in its optical frame [m/s, rad/s].
        Returns None: the twist is not finite, or there are no joint positions of its stamp. For those of a stamp to
        come it waits up to PATIENCE_S.
        """
        with self._came:
            self._came.wait_for(lambda: self._positions and next(reversed(self._positions)) >= stamp_ns, PATIENCE_S)
            q = self._positions.get(stamp_ns)
            if q is None or not np.isfinite(twist).all():
                return None
        q_dot = self._invert(self._kinematics.jacobian(q)).joint_velocity(twist)
        q_dot = q_dot / max(1.0, float(np.max(np.abs(q_dot) / self._kinematics.velocity)))
        return dict(zip(self._kinematics.joint_names, q_dot.tolist()))
