"""The ROS interface of the world: /gazebo services and topics, controller managers, cameras."""
