"""Plugins of models and worlds, one file each: its tag with Gazebo's keys and defaults, and what it does without ROS.
Tags are read through here, so that all of them are known."""
from . import (block_laser, bumper, grasp_fix, joint_states, link_attacher, p3d, planar_move, range_sensor, rotors,
               skid_steer, vacuum_gripper)
from ..depth_cameras import CAMERA, KINECT, REALSENSE
from ..devices import is_read, read_device, read_world_device
from ..multicameras import MULTICAMERA, PROSILICA

CONTROL, MIMIC = "gazebo_ros_control", "mimic_joint"  #: pieces of file names


def is_simulated(file: str) -> bool:
    """Whether a plugin of this file name does its work here, as a device, a camera, ros_control or a mimic joint."""
    return (is_read(file) or file in (CAMERA, *KINECT, REALSENSE, MULTICAMERA, PROSILICA) or
            any(piece in file for piece in (CONTROL, MIMIC)))


__all__ = ["block_laser", "bumper", "grasp_fix", "is_simulated", "joint_states", "link_attacher", "p3d", "planar_move",
           "range_sensor", "read_device", "read_world_device", "rotors", "skid_steer", "vacuum_gripper"]
