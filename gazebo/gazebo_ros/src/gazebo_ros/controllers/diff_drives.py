"""A base on wheels at its two sides: the topics cmd_vel and odom of diff_drive_controller."""
import math
import typing

import rospy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from aras_visual_servo_sim import ParameterError

from ..node.odometry import WheelOdometry, odometry_message, transform_message
from ..node.outlet import Beat
from .adapter import Adapter, Parameters, register

CONTROL_RATE_HZ = 100.0  #: how often the wheels get new speeds
DEFAULTS: Parameters = {
    "publish_rate": 50.0, "cmd_vel_timeout": 0.5, "wheel_separation_multiplier": 1.0, "open_loop": False,
    "left_wheel_radius_multiplier": 1.0, "right_wheel_radius_multiplier": 1.0, "base_frame_id": "base_link",
    "odom_frame_id": "odom", "enable_odom_tf": True}


def sides(parameters: Parameters) -> typing.List[typing.List[str]]:
    """Names of the joints at the left and at the right. Raises: ParameterError."""
    names: typing.List[typing.Any] = []
    for key in ("left_wheel", "right_wheel"):
        found = parameters.get(key)
        names.append([found] if isinstance(found, str) else found)
        if not names[-1] or not isinstance(names[-1], list):
            raise ParameterError("%s: found %r, allowed is the name of a joint or a list of them" % (key, found))
    if len(names[0]) != len(names[1]):
        raise ParameterError("#left wheels (%d) != #right wheels (%d)." % (len(names[0]), len(names[1])))
    return names


class Limit:
    """Bounds of a speed and of its change, parameters linear/x or angular/z."""

    def __init__(self, parameters: Parameters) -> None:
        self._velocity = self._pair(parameters, "velocity")
        self._acceleration = self._pair(parameters, "acceleration")

    @staticmethod
    def _pair(parameters: Parameters, what: str) -> typing.Tuple[float, float]:
        if not parameters.get("has_%s_limits" % what, False):
            return -math.inf, math.inf
        most = float(parameters.get("max_" + what, math.nan))
        if math.isnan(most):
            raise ParameterError("max_%s: is missing, must be there with has_%s_limits" % (what, what))
        return float(parameters.get("min_" + what, -most)), most

    def __call__(self, wanted: float, before: float, dt_s: float) -> float:
        """The speed that comes next."""
        lower, upper = self._velocity
        wanted = min(max(wanted, lower), upper)
        lower, upper = self._acceleration
        return min(max(wanted, before + lower * dt_s), before + upper * dt_s)


@register("diff_drive_controller/DiffDriveController")
class DiffDriveController(Adapter):
    @staticmethod
    def stand_in(parameters: Parameters) -> Parameters:
        """The simulator turns its wheels as a group of joints with one list of velocities."""
        left, right = sides(parameters)
        return {"type": "velocity_controllers/JointGroupVelocityController", "joints": left + right}

    def open(self) -> None:
        self._parameters = {**DEFAULTS, **(rospy.get_param(self.place, None) or {})}
        self._left, self._right = sides(self._parameters)
        if "wheel_radius_multiplier" in self._parameters:
            for side in ("left", "right"):
                self._parameters[side + "_wheel_radius_multiplier"] = self._parameters["wheel_radius_multiplier"]
        self._limits = Limit(self._parameters.get("linear", {}).get("x", {})), Limit(
            self._parameters.get("angular", {}).get("z", {}))
        self._size = self._separation_m(), self._radius_m()
        self._odometry = self.advertise(self.topic("odom"), Odometry)
        self._transforms = self.advertise("/tf", TFMessage)
        self.listen(self.topic("cmd_vel"), Twist, self._command)
        self.rate_hz = float(self._parameters["publish_rate"])

    def _separation_m(self) -> float:
        """As given, else the distance between the first wheels of both sides."""
        given = self._parameters.get("wheel_separation")
        if given is None:
            children = self.model.description.children
            ends = [self.model.link_pose(children[side[0]])[:3, 3] for side in (self._left, self._right)]
            given = math.dist(*ends)
        return float(given) * self._parameters["wheel_separation_multiplier"]

    def _radius_m(self) -> float:
        given = self._parameters.get("wheel_radius")
        if given is None:
            given = self.model.radius_of(self.model.description.children[self._left[0]])
        if given is None:
            raise ParameterError("wheel_radius: is missing, must be there where a wheel is no cylinder or sphere")
        return float(given)

    def _command(self, message: typing.Any) -> None:
        if not all(map(math.isfinite, (message.linear.x, message.angular.z))):
            rospy.logwarn_throttle(1.0, "Received NaN in velocity command. Ignoring.")
        elif self.running:
            self._wanted, self._told_ns = (message.linear.x, message.angular.z), self.world.time_ns

    def started(self, now_ns: int) -> None:
        super().started(now_ns)
        self._wanted, self._told_ns, self._issued = (0.0, 0.0), now_ns, (0.0, 0.0)
        separation, radius = self._size
        self._where = WheelOdometry(separation, radius * self._parameters["left_wheel_radius_multiplier"],
                                    radius * self._parameters["right_wheel_radius_multiplier"])
        self._where.update(*self._turned("joint_positions"))
        self._control = Beat(CONTROL_RATE_HZ, now_ns)

    def _turned(self, what: str) -> typing.List[float]:
        """Mean over the wheels of each side."""
        names, values = self.simulation.joint_names, getattr(self.simulation, what)
        return [sum(float(values[names.index(joint)]) for joint in side) / len(side)
                for side in (self._left, self._right)]

    def wanted(self) -> bool:
        return self.running

    @property
    def next_ns(self) -> int:
        return min(super().next_ns, self._control.next_ns) if self.running else super().next_ns

    def publish(self, now_ns: int) -> None:
        if not self.running:
            return
        self._where.update(*self._turned("joint_positions"))
        super().publish(now_ns)
        if self._control.due(now_ns):
            self._drive(now_ns)

    def _drive(self, now_ns: int) -> None:
        old = now_ns - self._told_ns > 1e9 * float(self._parameters["cmd_vel_timeout"])
        wanted = (0.0, 0.0) if old else self._wanted
        self._issued = tuple(limit(*pair, 1.0 / CONTROL_RATE_HZ)
                             for limit, pair in zip(self._limits, zip(wanted, self._issued)))
        forward, turn = self._issued
        rim = 0.5 * turn * self._where.separation_m
        left, right = (forward - rim) / self._where.left_radius_m, (forward + rim) / self._where.right_radius_m
        self.simulation.set_group_command(self.name, [left] * len(self._left) + [right] * len(self._right))

    def send(self, now_ns: int) -> None:
        parameters, variances = self._parameters, [0.0] * 6
        for key in ("pose_covariance_diagonal", "twist_covariance_diagonal"):
            parameters.setdefault(key, variances)
        velocity = self._issued[:1] + (0.0,) + self._issued[1:] if parameters["open_loop"] else \
            self._where.velocity(*self._turned("joint_velocities"))
        message = odometry_message(now_ns, parameters["odom_frame_id"], parameters["base_frame_id"],
                                   self._where.pose(), velocity, parameters["pose_covariance_diagonal"],
                                   parameters["twist_covariance_diagonal"])
        self._odometry.publish(message)
        if parameters["enable_odom_tf"]:
            self._transforms.publish([transform_message(message.header, message.child_frame_id, message.pose.pose)])
