"""The services under /gazebo."""
