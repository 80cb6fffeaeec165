"""Node `teleop`: moves the arm by keyboard. It reads `joint_states` and sends `joint_command` while a key is held."""

import sys
import threading
import time

import numpy as np
import rospy
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger

from aras_visual_servo import ArasError, ParameterError, robot_kinematics
from ..real.teleop import HELP, Keys, Teleop
from . import conversions as convert
from .parameters import Parameters

READ_S = 0.05  # wall time of one look at the keyboard
APART_S = 0.1  # ROS time between joint states of several messages that make one
EXIT_STOPPED, EXIT_PARAMETERS = 0, 2


class TeleopNode:
    """Answers each joint state with velocities while a key is held, and once with zeros when it is let go.

    The first key of a motion stops the goal that the controller works on, whose result then names this node. Otherwise
    it sends nothing. So it does not disturb another controller that moves the arm, and a simulator in
    lockstep does not begin to wait for its answers.
    """

    def __init__(self) -> None:
        """Raises ParameterError, which lists every fault of the parameters."""
        parameters = Parameters()
        urdf = parameters.searched("robot_description")
        base = parameters.value("~base_link", "world")
        tip = parameters.value("~camera_frame", "camera_optical_frame")
        speeds = [parameters.value("~" + name, default) for name, default in
                  (("joint_speed", 0.3), ("linear_m_per_s", 0.05), ("angular_rad_per_s", 0.2))]
        parameters.check()
        kinematics = robot_kinematics(urdf, base, tip)
        self.teleop = Teleop(kinematics, *speeds)
        self.lock = threading.Lock()
        self._names, self._moving = kinematics.joint_names, False
        self._rest = np.zeros(len(self._names))
        self._joints = convert.JointReader(kinematics.joint_names)
        self._command = rospy.Publisher("joint_command", JointState, queue_size=1, tcp_nodelay=True)
        self._stop = rospy.ServiceProxy("stop", Trigger)
        rospy.Subscriber("joint_states", JointState, self._on_joints, queue_size=1, tcp_nodelay=True)

    def _on_joints(self, message):
        with self.lock:
            try:
                q = self._joints.merged(message, APART_S)
            except ArasError as error:
                rospy.logwarn_throttle(5.0, "teleop: the arm rests: %s", error)
                q = None
            velocity = self._rest if q is None else self.teleop.velocity(q, time.monotonic())
            moves = bool(velocity.any())
            if moves and not self._moving:
                self._take_over()
            if moves or self._moving:
                command = JointState(name=list(self._names), velocity=velocity.tolist())
                command.header.stamp = message.header.stamp
                self._command.publish(command)
            self._moving = moves

    def _take_over(self):
        """End the controller's goal, if there is a controller: two must not drive the arm."""
        try:
            self._stop()
        except (rospy.ServiceException, rospy.ROSException):
            pass  # there is no controller


def main(descriptor: int = 0) -> int:
    """Entry of scripts/teleop. Runs until the quit key is pressed or ROS shuts down. Returns the exit code."""
    if {"-h", "--help"} & set(sys.argv):
        print(HELP)
        return EXIT_STOPPED
    rospy.init_node("teleop", disable_signals=False)
    try:
        node = TeleopNode()
        with Keys(descriptor) as keys:
            print(HELP)
            shown = None
            while not rospy.is_shutdown() and not node.teleop.quit:
                for key in keys.read(READ_S):
                    with node.lock:
                        node.teleop.press(key, time.monotonic())
                if node.teleop.status() != shown:
                    shown = node.teleop.status()
                    print(shown, flush=True)
    except ParameterError as error:
        rospy.logfatal("teleop: bad parameters:\n%s", error)
        return EXIT_PARAMETERS
    except ArasError as error:
        print(error, file=sys.stderr)
        return EXIT_PARAMETERS
    return EXIT_STOPPED
