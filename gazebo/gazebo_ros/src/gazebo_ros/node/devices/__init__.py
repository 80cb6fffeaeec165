"""Topics of plugins. Importing this package registers all kinds."""
from . import bodies, commanded, diff_drive, grippers, rotors, sensors
from .outlet import outlet_of

__all__ = ["bodies", "commanded", "diff_drive", "grippers", "outlet_of", "rotors", "sensors"]
