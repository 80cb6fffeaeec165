"""What is read of, and changed in, the text of a URDF. No ROS."""
