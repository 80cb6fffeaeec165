"""The rospy nodes, and the modules that only they need. Besides this room only `bags` imports ROS."""
