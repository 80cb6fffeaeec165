"""ROS side of ARAS Visual Servo: nodes, runs over ROS, bags, calibration and the real arm."""
