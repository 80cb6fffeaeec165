"""The live page: a run to watch and to change while it goes on. No ROS; its door to ROS is in `nodes`."""
