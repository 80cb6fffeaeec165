"""A real arm: section `real` of a scenario, and the forms of commands that its driver takes, as ros_control does.

    @register_form("mine")
    class Mine(Form):
        def messages(self, point): return [Message("/my_arm/command", "my_msgs/Target", {"q": list(point.position)})]

Topics and message types are plain text; this module imports nothing of ROS. The node makes the messages from the
fields. A simulated arm in lockstep does not read the section.
"""

from dataclasses import dataclass
from math import inf
from typing import Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple, Type, TypeVar

import numpy as np

from ..config.reader import Names, faults_of, read
from ..config.settings import setting
from ..ground.errors import ParameterError
from ..ground.registry import Registry, unknown_name
from .kinematics import RobotKinematics

FORMS: Registry[Type["Form"]] = Registry("real.command")
F = TypeVar("F", bound="Form")


class SetPoint(NamedTuple):
    """Set-points of the joints from now on.

    Attributes:
        stamp_ns: ROS time [ns].  joint_names: n names.
        position: (n,) set-points for a driver that takes positions [m, rad].
        velocity: (n,) velocities for a driver that takes velocities [m/s, rad/s]; 0 at rest.
        resting: the arm is to stand still.
        twist: (6,) [v; w] of the camera that the velocities make [m/s, rad/s], along the axes of frame_id.
        frame_id: name of the frame of the twist.
    """

    stamp_ns: int
    joint_names: Tuple[str, ...]
    position: Any
    velocity: Any
    resting: bool
    twist: Any = (0.0,) * 6
    frame_id: str = ""


class Message(NamedTuple):
    """One message to publish: its topic, its type "package/Type", and its fields as plain values.

    A field `header` holds the stamp [ns], `frame_id` its frame, `twist` six numbers, a field whose name ends in `_s` of
    a trajectory point a duration [s].
    """

    topic: str
    kind: str
    fields: Dict[str, Any]


def register_form(name: str) -> Callable[[Type[F]], Type[F]]:
    """Returns a class decorator that makes a form known by name."""
    return FORMS.register(name, name=name)


def make_form(settings: "RealSettings", output: str = "joints") -> "Form":
    """Makes the `Form` that the settings name. Raises ParameterError: the settings have faults.

    Args: output: `servo.output`; with `twist` the settings' command is not used.
    """
    faults = faults_of(settings)
    if faults:
        raise ParameterError(faults)
    return Twist(settings) if output == "twist" else FORMS[settings.command](settings)


class Form:
    """Base class of the forms."""

    name = ""

    def __init__(self, settings: "RealSettings") -> None:
        self._settings = settings

    def messages(self, point: SetPoint) -> List[Message]:
        """Returns the messages for these set-points."""
        raise NotImplementedError


class JointNumbers(Form):
    """One number per joint: the attribute of the set-points that has the name of the form."""

    def messages(self, point: SetPoint) -> List[Message]:
        """Returns one message for all joints if they share a controller, else one for each."""
        settings, data = self._settings, [float(value) for value in getattr(point, self.name)]
        if settings.controller:
            return [Message(f"{settings.controller}/command", "std_msgs/Float64MultiArray", {"data": data})]
        names = [settings.joint_controllers.get(name, f"{name}_controller") for name in point.joint_names]
        return [Message(f"{controller}/command", "std_msgs/Float64", {"data": value})
                for controller, value in zip(names, data)]


@register_form("position")
class Position(JointNumbers):
    """One position per joint [m or rad]: JointPositionController, or JointGroupPositionController for all joints."""


@register_form("velocity")
class Velocity(JointNumbers):
    """One velocity per joint [m/s or rad/s]: JointVelocityController, or JointGroupVelocityController for all."""


@register_form("trajectory")
class Trajectory(Form):
    """JointTrajectoryController: one point `ahead_s` from now, replaced by the next message; at rest the set-point."""

    def messages(self, point: SetPoint) -> List[Message]:
        ahead_s = self._settings.ahead_s
        velocity = [0.0 if point.resting else float(v) for v in point.velocity]
        position = [float(q) + v * ahead_s for q, v in zip(point.position, velocity)]
        # A stamp of 0 tells the driver to begin at once: its clock may differ from ours.
        fields = {"header": 0, "joint_names": list(point.joint_names),
                  "points": [{"positions": position, "velocities": velocity, "time_from_start_s": ahead_s}]}
        return [Message(f"{self._settings.controller}/command", "trajectory_msgs/JointTrajectory", fields)]


class Twist(Form):
    """The camera's twist, for a driver that has kinematics of its own: MoveIt Servo, ur_robot_driver, franka."""

    def messages(self, point: SetPoint) -> List[Message]:
        twist = [0.0] * 6 if point.resting else [float(value) for value in point.twist]
        return [Message(self._settings.twist_topic, "geometry_msgs/TwistStamped",
                        {"header": point.stamp_ns, "frame_id": point.frame_id, "twist": twist})]


@dataclass(frozen=True)
class WorkspaceSettings:
    """Section `real.workspace`: the box that the camera's optical centre stays in, in the robot's base."""

    lower_m: Tuple[float, ...] = setting(size=3, unit="m", help="Corner with the smallest x, y and z.")
    upper_m: Tuple[float, ...] = setting(size=3, unit="m", help="Corner with the largest x, y and z.")

    def check(self) -> Iterator[str]:
        """Along every axis the box has a length."""
        if not all(low < high for low, high in zip(self.lower_m, self.upper_m)):
            yield f"upper_m: found {list(self.upper_m)}, allowed above lower_m along each axis"

    def outside_m(self, position: np.ndarray) -> float:
        """Returns how far a position (3,) [m] in the robot's base is outside the box along one axis, 0 inside [m]."""
        beyond = np.maximum(np.subtract(self.lower_m, position), np.subtract(position, self.upper_m))
        return float(np.maximum(beyond, 0.0).max())


@dataclass(frozen=True)
class RealSettings:
    """Section `real`: how the controller drives an arm that is no simulator in lockstep."""

    command: str = setting(
        "trajectory", not_empty=True,
        help="Input of the arm's driver: `position` or `velocity` (a number per joint), or `trajectory` "
             "(trajectory_msgs/JointTrajectory with one point).")
    controller: str = setting(
        "arm_controller",
        help="ros_control controller of all joints, on CONTROLLER/command. Empty, with `position` or `velocity`: one "
             "controller per joint.")
    joint_controllers: Dict[str, str] = setting(
        {}, by="joint",
        help="With an empty `controller`: controller names by joint, else JOINT_controller.")
    twist_topic: str = setting(
        "servo_server/delta_twist_cmds", not_empty=True,
        help="With `servo.output: twist`: topic of the twists (geometry_msgs/TwistStamped).")
    twist_frame: str = setting(
        "base", choices=("base", "camera"),
        help="With `servo.output: twist`: axes of the twist, those of `robot.base_link` or of `robot.tip_link`. The "
             "twist is that of the camera's optical centre.")
    command_period_s: float = setting(0.008, unit="s", above=0, help="Time between commands to the arm.")
    ahead_s: float = setting(
        0.024, unit="s", above=0,
        help="With `trajectory`: time of the point ahead of the command. Several command periods bridge a late "
             "message.")
    image_delay_s: float = setting(
        0.0, unit="s", at_least=0,
        help="Delay of the image stamps after the exposure. Drivers of USB cameras stamp an image on arrival.")
    max_joint_gap_s: float = setting(
        0.05, unit="s", above=0, help="Longest gap between joint states for interpolation.")
    max_extrapolation_s: float = setting(
        0.01, unit="s", at_least=0,
        help="An image newer than the newest joint state by at most this extrapolates the joints; a later one waits.")
    joint_timeout_s: float = setting(
        0.1, unit="s", above=0,
        help="The arm stops after this time without a joint state.")
    clock_jump_s: float = setting(
        0.2, unit="s", above=0,
        help="A larger step of ROS time between two commands, or a step back, ends the goal.")
    predict: bool = setting(
        False,
        help="Predicts the features from the image time to the time of the command's effect. Moments and points only.")
    command_delay_s: float = setting(
        0.0, unit="s", at_least=0, help="Time from a command to the motion of the joints; part of the prediction.")
    max_prediction_s: float = setting(
        0.3, unit="s", above=0, help="Images that need a longer prediction are rejected.")
    deadman: bool = setting(
        True,
        help="The arm moves only while `true` arrives on topic `deadman` (std_msgs/Bool). Its end ends the goal.")
    deadman_timeout_s: float = setting(0.2, unit="s", above=0, help="Longest time between two such messages.")
    speed_part: float = setting(
        0.2, above=0, at_most=1,
        help="Fraction of the URDF's velocity limits. One factor slows all joints.")
    joint_speed: Dict[str, float] = setting(
        {}, unit="m/s, rad/s", above=0, by="joint",
        help="Largest speed by joint, instead of speed_part.")
    joint_acceleration: float = setting(
        5.0, unit="m/s^2, rad/s^2", above=0,
        help="Largest acceleration of a joint. Stops are immediate, as fast as the drives brake.")
    workspace: Optional[WorkspaceSettings] = setting(
        None, help="Box for the camera, in the robot's base frame; the arm brakes before leaving it.")

    def check(self) -> Iterator[str]:
        """The form is known and has the controllers that it needs."""
        if self.command not in FORMS:
            yield unknown_name("command", self.command, FORMS)
        elif self.command == "trajectory" and not self.controller:
            yield "controller: found an empty text, allowed with command: trajectory the name of a controller"
        if self.controller and self.joint_controllers:
            yield "joint_controllers: found names, allowed with an empty `controller`"

    @classmethod
    def from_dict(cls, source: Dict[str, Any], joint_names: Sequence[str] = ()) -> "RealSettings":
        """Reads the section. Raises ParameterError listing every fault."""
        return read(cls, source, "real", Names(joints=tuple(joint_names)))

    def largest_speed(self, kinematics: RobotKinematics) -> np.ndarray:
        """Returns the largest speeds of the joints, (n,); inf where neither this section nor the URDF has one."""
        part = [self.speed_part * float(most) if most < inf else inf for most in kinematics.velocity]
        return kinematics.vector({name: min(self.joint_speed.get(name, default), float(most)) for name, default, most
                                  in zip(kinematics.joint_names, part, kinematics.velocity)})
