"""Settings of an experiment: the scenario's section `experiment`."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import radians
from typing import Any, Dict, Iterator, Optional, Tuple

import numpy as np

from ..arm.kinematics import RobotKinematics
from ..arm.reach import outside_limits, reach
from ..config.reader import Names, read
from ..config.settings import setting
from ..ground.errors import ParameterError
from ..spatial import pose_from_rpy


@dataclass(frozen=True)
class CameraPlace:
    """Section `camera` of a place: the pose of the camera in the robot's base (`robot.base_link`)."""

    position_m: Tuple[float, ...] = setting(size=3, unit="m", help="The optical centre.")
    rpy_rad: Tuple[float, ...] = setting(
        size=3, unit="rad",
        help="Roll, pitch and yaw of the optical frame, as in a URDF; `[3.14159265358979, 0, 0]` looks straight down.")

    def pose(self) -> np.ndarray:
        """X_BC, (4, 4)."""
        return pose_from_rpy(self.position_m, self.rpy_rad)


@dataclass(frozen=True)
class Place:
    """Where the robot stands: either `joints` or `camera`."""

    joints: Optional[Dict[str, float]] = setting(
        None, unit="m, rad", by="joint_position",
        help="Positions by joint, within their limits; other joints stay where they are.")
    camera: Optional[CameraPlace] = setting(
        None,
        help="Pose of the camera; an arm takes joint positions that reach it.")

    def check(self) -> Iterator[str]:
        """One of the two."""
        if (self.joints is None) == (self.camera is None):
            yield f"found {'neither' if self.joints is None else 'both'} of joints and camera, allowed one of them"

    def at(self, kinematics: RobotKinematics, near: Optional[np.ndarray] = None) -> "Place":
        """The place by joints.

        Args: near: (n,) joint positions from which those of a camera pose are searched; None: 0, within the limits.
        Raises: ParameterError: the pose is out of reach.
        """
        if self.camera is None:
            return self
        if near is None:
            near = np.clip(np.zeros(len(kinematics.joint_names)), kinematics.lower, kinematics.upper)
        joints, refusal = reach(kinematics, near, self.camera.pose())
        if joints is not None:
            refusal = outside_limits(kinematics, joints)
        if refusal:
            raise ParameterError(f"camera: {refusal}")
        return Place(joints)


def place_of(source: Mapping[str, Any], where: str, kinematics: RobotKinematics,
             near: Optional[np.ndarray] = None) -> Place:
    """`Place` by joints of a section `goal` or `start`, dict. Arguments and errors as `Place.at` and `read`."""
    return read(Place, source, where, Names(joints=tuple(kinematics.joint_names))).at(kinematics, near)


@dataclass(frozen=True)
class JudgeSettings:
    """Section `experiment.judge`: the largest final error of the true camera pose, in the goal camera's frame."""

    x_mm: float = setting(unit="mm", above=0, help="Along x of the goal camera.")
    y_mm: float = setting(unit="mm", above=0, help="Along y of the goal camera.")
    z_mm: float = setting(unit="mm", above=0, help="Along z of the goal camera.")
    angle_deg: float = setting(unit="deg", above=0, help="Remaining rotation angle.")


def still(x_mm: float, y_mm: float, z_mm: float, angle_deg: float) -> Tuple[float, float]:
    """Largest motion of the camera while a view is taught: a tenth of the judge's limits [m, rad]."""
    return 1e-4 * min(x_mm, y_mm, z_mm), 0.1 * radians(angle_deg)


@dataclass(frozen=True)
class ExperimentSettings:
    """Section `experiment`: teach the view at the goal, go to the start, servo, judge."""

    goal: Place = setting(help="Place at which the goal view is taught.")
    start: Place = setting(help="Place at which the servo starts.")
    z_star_m: float = setting(unit="m", above=0, help="Depth of the target in the taught view.")
    teach_images: int = setting(
        300, at_least=1,
        help="Largest number of averaged images of the taught view: as many as their noise needs, two without noise, "
             "one if the goal may move.")
    settle_s: float = setting(0.5, unit="s", at_least=0, help="Shortest wait at goal and start.")
    settle_limit_s: float = setting(
        2.0, unit="s", above=0,
        help="Longest further wait for the joints to rest.")
    settle_speed: float = setting(0.002, unit="m/s, rad/s", above=0, help="A joint slower than this is at rest.")
    arrived_within: float = setting(
        0.05, unit="m, rad", above=0,
        help="A joint that rests farther than this from its place at goal or start ends the run.")
    speed_part: float = setting(
        0.3, above=0, at_most=1,
        help="Fraction of the joints' velocity limits for the trajectories to goal and start.")
    acceleration: float = setting(2.0, unit="m/s^2, rad/s^2", above=0, help="Acceleration on these trajectories.")
    image_period_s: float = setting(
        1.0 / 30.0, unit="s", above=0,
        help="Image period assumed for the first image, then measured.")
    judge: Optional[JudgeSettings] = setting(
        None,
        help="Limits of the final error for a run to pass; off: a converged run passes.")

    @property
    def still(self) -> Optional[Tuple[float, float]]:
        """Largest motion of the camera while the view is taught [m, rad]; None: no judge."""
        return None if self.judge is None else still(**vars(self.judge))

    @classmethod
    def from_dict(cls, source: Mapping, kinematics: RobotKinematics) -> "ExperimentSettings":
        """Reads the section. Raises ParameterError listing every fault."""
        config = read(cls, source, "experiment", _within_limits(kinematics))
        near, faults, places = None, [], {}
        for name in ("goal", "start"):
            try:
                places[name] = getattr(config, name).at(kinematics, near)
            except ParameterError as error:
                faults += [f"experiment.{name}.{fault}" for fault in error.faults]
            if name in places:
                near = _posture(places[name], kinematics, near)
        if faults:
            raise ParameterError(faults)
        return replace(config, **places)

    def with_start(self, source: Mapping[str, Any], kinematics: RobotKinematics) -> "ExperimentSettings":
        """These settings with another start: its section, dict. Raises ParameterError listing every fault."""
        start = read(Place, source, "experiment.start", _within_limits(kinematics))
        return replace(self, start=start.at(kinematics, _posture(self.goal, kinematics)))


def _within_limits(kinematics):
    """`Names` of the joints and their limits."""
    limits = zip(kinematics.lower.tolist(), kinematics.upper.tolist())
    return Names(joints=tuple(kinematics.joint_names), limits=dict(zip(kinematics.joint_names, limits)))


def _posture(place, kinematics, otherwise=None):
    """(n,) joint positions of a place that names all joints."""
    return kinematics.vector(place.joints) if set(place.joints) == set(kinematics.joint_names) else otherwise
