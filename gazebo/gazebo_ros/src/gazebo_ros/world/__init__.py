"""The world: models, each a simulation of its own, under one clock. No ROS."""
