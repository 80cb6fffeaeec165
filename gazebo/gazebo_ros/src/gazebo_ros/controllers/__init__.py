"""Topics and actions of the controllers, one file a type. Importing this makes all of them known."""
from . import grippers, groups, joint_states, singles, trajectories
from .adapter import adapter_of

__all__ = ["adapter_of", "grippers", "groups", "joint_states", "singles", "trajectories"]
