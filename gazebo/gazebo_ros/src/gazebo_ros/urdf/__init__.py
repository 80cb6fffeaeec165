"""Reads and changes the text of a URDF. No ROS."""
