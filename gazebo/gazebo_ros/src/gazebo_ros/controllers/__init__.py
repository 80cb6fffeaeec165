"""Topics and actions of the controllers. Importing this makes all types known."""
from . import diff_drives, grippers, joint_states, singles, trajectories
from .adapter import ADAPTERS, Adapter

__all__ = ["ADAPTERS", "Adapter", "diff_drives", "grippers", "joint_states", "singles", "trajectories"]
