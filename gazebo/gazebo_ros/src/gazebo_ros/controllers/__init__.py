"""Topics and actions of the controllers. Importing this makes all types known."""
from . import diff_drives, grippers, joint_states, singles, trajectories
from .adapter import adapter_of, parameters_of, types_of_adapters

__all__ = ["adapter_of", "parameters_of", "types_of_adapters", "diff_drives", "grippers", "joint_states", "singles",
           "trajectories"]
