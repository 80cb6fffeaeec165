"""Replacement of Gazebo's server: a world of models that are spawned and deleted at run time.

``world`` knows no ROS and is tested without a master; ``node`` is its ROS interface; ``controllers`` has the topics and
actions of each type of controller, one file a type.
"""
