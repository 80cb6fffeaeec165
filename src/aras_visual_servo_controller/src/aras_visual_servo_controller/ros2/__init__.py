"""The door to ROS 2: a relay between this graph and rclpy nodes on the same machine."""
