"""Replaces ament_index_python, from which xacro gets the folders of packages."""
