"""Node `play_motion`: sends a motion from a file as set points on `joint_command`, as a trajectory driver makes them.

    rosrun aras_visual_servo_controller play_motion first/excite.yaml __ns:=aras_visual_servo

It is for a simulated arm: a driver of a real one takes the file itself.
"""

import sys
import time
from pathlib import Path

import numpy as np
import rospy
from sensor_msgs.msg import JointState

from aras_visual_servo import ParameterError
from ..bags.motions import read_motion

#: Set points in a second of ROS time, and the time that the first joint state and a listener may take. [s]
RATE_HZ, WAIT_S = 100.0, 20.0
#: The last set point is sent for so long: what is in rospy's queue when a process ends is lost. [s]
HOLD_S = 0.2
EXIT_DONE, EXIT_STOPPED, EXIT_PARAMETERS = 0, 1, 2
USAGE = "usage: rosrun aras_visual_servo_controller play_motion MOTION.yaml __ns:=NAMESPACE"


def main() -> int:
    """Entry of scripts/play_motion. Returns the exit code when the motion is over, or ROS shuts down."""
    arguments = rospy.myargv(sys.argv)[1:]
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(USAGE)
        return EXIT_DONE if {"-h", "--help"} & set(arguments) else EXIT_PARAMETERS
    try:
        motion = read_motion(Path(arguments[0]))
        rospy.init_node("play_motion")
        commands = rospy.Publisher("joint_command", JointState, queue_size=10, tcp_nodelay=True)
        return _play(motion, commands)
    except ParameterError as error:
        print(f"play_motion: {error}", file=sys.stderr)
        return EXIT_PARAMETERS
    except rospy.ROSInterruptException:
        return EXIT_STOPPED


def _play(motion, commands):
    try:
        state = rospy.wait_for_message("joint_states", JointState, WAIT_S)
    except rospy.ROSException:
        raise ParameterError(f"{rospy.resolve_name('joint_states')}: found no message in {WAIT_S:g} s, allowed the "
                             "joint states of a running simulator: set the namespace with __ns:=NAMESPACE") from None
    here = dict(zip(state.name, state.position))
    if not set(motion.joint_names) <= set(here):
        raise ParameterError(f"joint_names: found {', '.join(motion.joint_names)}, allowed those of "
                             f"{rospy.resolve_name('joint_states')}: {', '.join(here)}")
    way, end_s = motion.way(np.array([here[name] for name in motion.joint_names])), float(motion.times_s[-1])
    _wait_for_listener(commands)
    rate, begun = rospy.Rate(RATE_HZ), rospy.get_rostime()
    print(f"{len(motion.joint_names)} joints, {end_s:g} s", flush=True)
    while not rospy.is_shutdown():
        now = rospy.get_rostime()
        t = (now - begun).to_sec()
        command = JointState(name=list(motion.joint_names), position=way(min(t, end_s)).tolist())
        command.header.stamp = now
        commands.publish(command)
        if t >= end_s + HOLD_S:
            return EXIT_DONE
        rate.sleep()
    return EXIT_STOPPED


def _wait_for_listener(commands):
    end = time.monotonic() + WAIT_S
    while commands.get_num_connections() == 0 and not rospy.is_shutdown():
        if time.monotonic() > end:
            raise ParameterError(f"{commands.resolved_name}: found no listener in {WAIT_S:g} s, allowed a simulator "
                                 "that takes joint commands")
        rospy.rostime.wallsleep(0.02)
