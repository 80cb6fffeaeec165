"""Controller of ARAS Visual Servo: numpy core (no ROS) and thin rospy modules on top."""
