"""Builds the parts of a scenario without ROS: simulator, camera, and kinematics of the robot."""

from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Tuple

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..config.files import package_paths
from ..ground.errors import ParameterError
from ..ground.images import in_rgb

if TYPE_CHECKING:
    from ..scenario.scenario import Scenario
    from aras_visual_servo_sim import Simulation


def simulation_of(scenario: "Scenario", urdf_xml: Optional[str] = None,
                  sim: Optional[Dict[str, Any]] = None) -> "Simulation":
    """Makes the scenario's simulator, with another URDF or another section `sim` where they are given."""
    from aras_visual_servo_sim import Simulation  # C++: not needed to import this
    return Simulation(urdf_xml or scenario.urdf_xml(), sim or scenario.sim, scenario.controllers(), package_paths())


class SimulatedCell:
    """Simulator, camera and robot of a scenario.

    Args:
        camera: name of the camera; None: the first of the scenario.
        sim: a Simulation made of the same robot, controllers and `sim` section, which is reset and used again; None: a
            new one is made, which takes as long as a second of simulated time. Either way the bytes are the same.
        calibrated: the kinematics lead to where `robot.hand_eye` has the camera; False: to its true place.
    Raises:
        ParameterError, ModelError and the simulator's errors: faults of the scenario.

    Attributes:
        camera_info: dict with the fields of CameraInfo, the true ones.  encoding: of the camera's images.
        eye_to_hand: whether the arm carries the target, and the camera stands still.
    """

    def __init__(self, scenario: "Scenario", camera: Optional[str] = None, sim: Optional["Simulation"] = None,
                 calibrated: bool = True) -> None:
        self.scenario = scenario
        self.camera: str = camera or (scenario.sim.get("cameras") or [{"name": "camera"}])[0]["name"]
        if sim is None:
            sim = simulation_of(scenario)
        else:
            sim.reset()
        self.sim = sim
        self.camera_info: Dict[str, Any] = sim.camera_info(self.camera)
        self.encoding: str = sim.camera_encoding(self.camera)
        self.kinematics: RobotKinematics = scenario.kinematics(calibrated)
        self.eye_to_hand = scenario.robot.get("target_link") is not None
        target = next(iter(scenario.sim.get("scene", {}).get("models", [])), None)
        self._target = target and target["name"]
        self._target_moves = target is not None and not {"motion", "attached_to"}.isdisjoint(target)
        names = list(sim.joint_names)
        missing = [name for name in self.kinematics.joint_names if name not in names]
        if missing:
            raise ParameterError(f"robot: the simulator has no joint {', '.join(missing)}, it has {', '.join(names)}")
        order = [names.index(name) for name in self.kinematics.joint_names]
        self._order = None if order == list(range(len(names))) else order
        self._placed_ns = 0
        self._frame: Any = None  # taken last: image, joints, poses of camera and models at its stamp

    def place(self, joints: Mapping[str, float], settle_s: float = 0.0) -> None:
        """Puts the arm at joint positions at once instead of driving it there.

        Args:
            joints: joint name -> position [m, rad]; the others stay.
            settle_s: simulated time in which the arm comes to rest under gravity and friction, with these positions as
                set-points [s].
        """
        self.sim.set_joint_positions(joints)
        self.sim.step(round(settle_s * 1e9 / self.sim.period_ns))
        self._placed_ns = self.sim.time_ns

    def take(self) -> Tuple[int, np.ndarray, np.ndarray]:
        """Takes the next image that was not on its way while the arm was put elsewhere.

        Returns: (stamp_ns, image, q): the image, grey or rgb, is overwritten by the next one; q (n,) are the joint
            positions that it shows, in the order of the kinematics.
        """
        stamp_ns = self.sim.step_to_image(self.camera)
        while stamp_ns < self._placed_ns:
            stamp_ns = self.sim.step_to_image(self.camera)
        frame = self._frame = self.sim.frame(self.camera)
        return stamp_ns, in_rgb(frame.image, self.encoding), self.in_order(frame.joint_positions)

    def in_order(self, joints: np.ndarray) -> np.ndarray:
        """Returns a joint vector of the simulator in the order of the kinematics."""
        return joints if self._order is None else joints[self._order]

    def camera_pose(self) -> np.ndarray:
        """Returns X_WC, (4, 4), of the instant that the image taken last shows."""
        return self._frame.camera_pose

    def moving_target_pose(self) -> Optional[np.ndarray]:
        """Returns X_WT, (4, 4), at the last image, of a target that moves; None of one that rests."""
        return self.seen_target_pose() if self._target_moves else None

    def seen_target_pose(self) -> Optional[np.ndarray]:
        """Returns X_WT, (4, 4), of the target at the last image; None in a scene without one."""
        return self._target and self._frame.model_poses[self._target]

    def target_pose(self) -> Optional[np.ndarray]:
        """Returns X_WT, (4, 4), of the target now; None in a scene without one."""
        return self._target and self.sim.model_pose(self._target)
