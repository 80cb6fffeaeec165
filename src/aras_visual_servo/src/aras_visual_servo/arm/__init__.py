"""The arm: kinematics, reach, limits, from camera twists to joint velocities, and set-points. No ROS."""
