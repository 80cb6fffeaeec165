"""Topics of what plugins do, one file a kind. Importing this makes all of them known."""
from . import diff_drive, force_torque, imu, laser
from .outlet import outlet_of

__all__ = ["diff_drive", "force_torque", "imu", "laser", "outlet_of"]
