"""Topics and actions of the controllers, one file a type. Importing this makes all of them known."""
from . import diff_drives, grippers, groups, joint_states, singles, trajectories
from .adapter import adapter_of, parameters_of, types_of_adapters

__all__ = ["adapter_of", "parameters_of", "types_of_adapters", "diff_drives",
           "grippers", "groups", "joint_states", "singles", "trajectories"]
