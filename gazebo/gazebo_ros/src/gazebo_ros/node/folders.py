"""Where packages and models are, as ROS and Gazebo look for them."""
import os

import rospkg

MODEL_PATH = "GAZEBO_MODEL_PATH"


class Folders:
    """Callable: the folder of a package or model, or None. What was found is remembered."""

    def __init__(self):
        self._packages = rospkg.RosPack()

    def __call__(self, name):
        for place in os.environ.get(MODEL_PATH, "").split(":"):
            if place and os.path.isdir(os.path.join(place, name)):
                return os.path.join(place, name)
        try:
            return self._packages.get_path(name)
        except rospkg.ResourceNotFound:
            return None
