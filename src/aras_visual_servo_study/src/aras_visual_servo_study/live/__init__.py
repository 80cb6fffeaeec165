"""The live page: a run that somebody watches and changes while it goes on. No ROS; its door to ROS is in `nodes`."""
