"""Worlds and models of SDF: read by libsdformat, told as URDF and settings. No ROS."""
