"""How features look in the camera's image. Each file of this folder is one kind of overlay; `base` says how to write
one.

A feature names its kind (`Feature.overlay`). Report and video ask `overlay_of` for all that a run's features show.
"""

from .base import Overlay, Scene, Shape, Way, overlay_of, register_overlay

__all__ = ["Overlay", "Scene", "Shape", "Way", "overlay_of", "register_overlay"]
