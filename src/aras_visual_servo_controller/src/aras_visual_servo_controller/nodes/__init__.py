"""The rospy nodes and what only they need. No other room but `bags` knows ROS."""
