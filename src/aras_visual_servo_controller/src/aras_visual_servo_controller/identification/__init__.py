"""Identification of what an arm does with its commands, from recorded joint states. No ROS."""
