"""A base on two wheels that are driven by a twist: cmd_vel in; odometry, transforms and joint states out."""
import math
import typing

import numpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from ...world.devices import DiffDrive, named
from ..convert import pose_message, stamp, stamped
from ..odometry import WheelOdometry, odometry_message, transform_message
from .outlet import DeviceOutlet, serves

NEAR_M_S = 0.01  #: a wheel that is this near to its wanted speed gets it at once
#: Variances of x, y, z, roll, pitch, yaw, as Gazebo's plugin states them.
VARIANCES = (1e-5, 1e-5, 1e12, 1e12, 1e12, 1e-3)


@serves(DiffDrive)
class DiffDriveOutlet(DeviceOutlet):
    def open(self) -> None:
        device = self.device
        self._rest()
        self.listen(named(device.namespace, device.command_topic), Twist, self._command)
        self._transforms = self.advertise("/tf", TFMessage)
        self._odometry = self._states = None
        if device.publishes_odometry:
            self._odometry = self.advertise(named(device.namespace, device.odometry_topic), Odometry)
        if device.publishes_joint_states:
            self._states = self.advertise(named(device.namespace, "joint_states"), JointState)

    def _command(self, message: typing.Any) -> None:
        self._wanted = (message.linear.x, message.angular.z)
        if not all(map(math.isfinite, self._wanted)):
            self._wanted = (0.0, 0.0)

    def _wheels(self, what: str) -> numpy.ndarray:
        names, values = self.simulation.joint_names, getattr(self.simulation, what)
        return numpy.array([values[names.index(joint)] for joint in self.device.joints()])

    def time_reset(self, now_ns: int) -> None:
        super().time_reset(now_ns)
        self._rest()

    def wanted(self) -> bool:
        return True

    def _rest(self) -> None:
        self._wanted = (0.0, 0.0)          # of the base [m/s, rad/s]
        self._issued = numpy.zeros(2)      # speed of the rims, left and right [m/s]
        radius = 0.5 * self.device.diameter_m
        self._counted = WheelOdometry(self.device.separation_m, radius, radius)
        self._counted.update(*self._wheels("joint_positions"))

    def send(self, now_ns: int) -> None:
        if self.device.from_wheels:
            self._counted.update(*self._wheels("joint_positions"))
        if self._odometry is not None:
            self._send_odometry(now_ns)
        if self.device.publishes_wheel_tf:
            self._send_wheels(now_ns)
        if self._states is not None:
            self._states.publish(stamped(JointState, now_ns, name=list(self.device.joints()),
                                         position=list(map(float, self._wheels("joint_positions")))))
        self._drive()

    def _drive(self) -> None:
        """Sets the wheels' speeds, both at once, no faster than the acceleration allows."""
        device, radius = self.device, 0.5 * self.device.diameter_m
        forward, turn = self._wanted
        wanted = forward + numpy.array([-0.5, 0.5]) * turn * device.separation_m
        rims = radius * self._wheels("joint_velocities")
        if device.acceleration_m_s2 <= 0.0 or numpy.any(abs(wanted - rims) < NEAR_M_S):
            self._issued = wanted
        else:
            most = device.acceleration_m_s2 / (device.rate_hz if device.rate_hz > 0.0 else 1000.0)
            self._issued = self._issued + numpy.clip(wanted - rims, -most, most)
        self.model.turn_wheels(device, self._issued / radius)

    def _send_odometry(self, now_ns: int) -> None:
        device = self.device
        if device.from_wheels:
            pose, velocity = self._counted.pose(), self._counted.velocity(*self._wheels("joint_velocities"))
        else:
            pose, twist = self.model.pose(), self.model.twist()
            yaw = math.atan2(pose[1, 0], pose[0, 0])
            velocity = (math.cos(yaw) * twist[0] + math.sin(yaw) * twist[1],
                        math.cos(yaw) * twist[1] - math.sin(yaw) * twist[0], twist[5])
        message = odometry_message(now_ns, device.odometry_frame, device.base_frame, pose, velocity, VARIANCES)
        self._odometry.publish(message)
        if device.publishes_tf:
            self._transforms.publish([transform_message(message.header, device.base_frame, message.pose.pose)])

    def _send_wheels(self, now_ns: int) -> None:
        for joint in self.device.joints():
            parent, child = self.model.description.parents[joint], self.model.description.children[joint]
            pose = pose_message(numpy.linalg.inv(self.model.link_pose(parent)) @ self.model.link_pose(child))
            self._transforms.publish([transform_message(Header(stamp=stamp(now_ns), frame_id=parent), child, pose)])
