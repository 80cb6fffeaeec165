"""Topics of what plugins do. Importing this makes all kinds known."""
from . import diff_drive, sensors
from .outlet import outlet_of

__all__ = ["diff_drive", "outlet_of", "sensors"]
