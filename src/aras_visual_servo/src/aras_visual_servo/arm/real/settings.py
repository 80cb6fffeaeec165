"""Settings of a real arm: the scenario's section `real`. A simulated arm in lockstep does not read it."""

from dataclasses import dataclass
from math import inf
from typing import Dict, Optional, Tuple

from ...config.reader import Names, read
from ...config.settings import setting
from .forms.base import known_forms


@dataclass(frozen=True)
class WorkspaceSettings:
    """Section `real.workspace`: the box that the camera's optical centre stays in, in the robot's base."""

    lower_m: Tuple[float, ...] = setting(size=3, unit="m", help="Its corner of the smallest x, y and z.")
    upper_m: Tuple[float, ...] = setting(size=3, unit="m", help="Its corner of the largest x, y and z.")

    def check(self):
        """Along every axis the box has a length."""
        if not all(low < high for low, high in zip(self.lower_m, self.upper_m)):
            yield f"upper_m: found {list(self.upper_m)}, allowed above lower_m along each axis"


@dataclass(frozen=True)
class RealSettings:
    """Section `real`: how the controller drives an arm that is no simulator in lockstep."""

    command: str = setting(
        "trajectory", not_empty=True,
        help="What the arm's driver takes: `position` or `velocity` (a number per joint), or `trajectory` "
             "(trajectory_msgs/JointTrajectory with one point ahead).")
    controller: str = setting(
        "arm_controller",
        help="The ros_control controller that takes all joints at once, on CONTROLLER/command. An empty text with "
             "`position` or `velocity`: every joint has a controller of its own.")
    joint_controllers: Dict[str, str] = setting(
        {}, by="joint",
        help="With an empty `controller`: the controllers of the joints, by joint; without a name here it is "
             "JOINT_controller.")
    command_period_s: float = setting(0.008, unit="s", above=0, help="Time between two commands to the arm.")
    ahead_s: float = setting(
        0.024, unit="s", above=0,
        help="With `trajectory`: how far ahead its point lies; some command periods, so that a late message does not "
             "end the motion.")
    image_delay_s: float = setting(
        0.0, unit="s", at_least=0,
        help="How much later than the exposure the stamps of the images are: drivers of USB cameras stamp an image "
             "when it has arrived.")
    max_joint_gap_s: float = setting(
        0.05, unit="s", above=0,
        help="Joint states farther apart than this are not interpolated between.")
    max_extrapolation_s: float = setting(
        0.01, unit="s", at_least=0,
        help="An image at most this much later than the newest joint state is answered from the last two joint states; "
             "a later one waits for the next.")
    joint_timeout_s: float = setting(0.1, unit="s", above=0, help="Without a joint state for this long the arm rests.")
    clock_jump_s: float = setting(
        0.2, unit="s", above=0,
        help="When ROS time steps ahead by more than this between two commands, or back, the goal ends.")
    predict: bool = setting(
        False,
        help="The features are predicted from the time of the image to the time at which the command acts. Features of "
             "moments and points only.")
    command_delay_s: float = setting(
        0.0, unit="s", at_least=0,
        help="Time from a command to the motion of the joints; the prediction adds it.")
    max_prediction_s: float = setting(
        0.3, unit="s", above=0,
        help="An image that would have to be predicted over a longer time is refused.")
    deadman: bool = setting(
        True,
        help="The arm moves only while `true` comes on the topic `deadman` (std_msgs/Bool); its end ends the goal.")
    deadman_timeout_s: float = setting(0.2, unit="s", above=0, help="It has to come again within this time.")
    speed_part: float = setting(
        0.2, above=0, at_most=1,
        help="Part of the URDF's velocity limits that the joints may use; all joints are slowed by one factor.")
    joint_speed: Dict[str, float] = setting(
        {}, unit="m/s, rad/s", above=0, by="joint",
        help="Largest speed of a joint by its name, in the place of speed_part.")
    joint_acceleration: float = setting(
        5.0, unit="m/s^2, rad/s^2", above=0,
        help="Largest acceleration of a joint; stops are at once, and the drives brake as they can.")
    workspace: Optional[WorkspaceSettings] = setting(
        None,
        help="A box that the camera stays in; the arm brakes before it leaves it.")

    def check(self):
        """The form is known and has the controllers that it needs."""
        if self.command not in known_forms():
            yield f"command: found {self.command}, allowed {', '.join(known_forms())}"
        elif self.command == "trajectory" and not self.controller:
            yield "controller: found an empty text, allowed with command: trajectory the name of a controller"
        if self.controller and self.joint_controllers:
            yield "joint_controllers: found names, allowed with an empty `controller`"

    @classmethod
    def from_dict(cls, source, joint_names=()):
        """Read the section. Raises ParameterError listing every fault."""
        return read(cls, source, "real", Names(joints=tuple(joint_names)))

    def largest_speed(self, kinematics):
        """(n,) largest speeds of the joints of `kinematics`; inf where neither this section nor the URDF has one."""
        part = [self.speed_part * float(most) if most < inf else inf for most in kinematics.velocity]
        return kinematics.vector({name: min(self.joint_speed.get(name, default), float(most)) for name, default, most
                                  in zip(kinematics.joint_names, part, kinematics.velocity)})
