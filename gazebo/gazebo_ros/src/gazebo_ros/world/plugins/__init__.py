"""Plugins of models and worlds, one file each: its tag with Gazebo's keys and defaults, and what it does without ROS.
Tags are read through here, so that all of them are known."""
from . import (block_laser, bumper, grasp_fix, joint_states, link_attacher, p3d, planar_move, range_sensor, rotors,
               skid_steer, vacuum_gripper)
from ..devices import read_device, read_world_device

__all__ = ["block_laser", "bumper", "grasp_fix", "joint_states", "link_attacher", "p3d", "planar_move", "range_sensor",
           "read_device", "read_world_device", "rotors", "skid_steer", "vacuum_gripper"]
