"""Source `moments`: image moments of the target, its corners, its kernel projections (MomentFeatures); and the default
features xn, yn, an, alpha of it: position, depth and orientation of the target (docs/theory.md T3, T4).
"""

import numpy as np

from ..ground.types import Features
from . import interaction
from .base import Feature, register_feature
from .interaction import plane_from_pose
from .palette import BLUE, GREEN, PURPLE, VERMILION
from .source import Source, Taught, register_source


@register_feature("xn")
class NormalisedX(Feature):
    """x of the centroid times an (T4, T9) [m]."""

    unit, symbol, label, colour = "m", "x_n", "centroid in x, at the depth of the target", BLUE
    index = 0

    def value(self, view):
        return getattr(view.features, self.name)

    def row(self, view):
        return view.L_normalised()[self.index]


@register_feature("yn")
class NormalisedY(NormalisedX):
    """y of the centroid times an (T4, T9) [m]."""

    symbol, label, colour = "y_n", "centroid in y, at the depth of the target", VERMILION
    index = 1


@register_feature("an")
class NormalisedArea(NormalisedX):
    """Depth of the target as its area tells it (T4, T9) [m]."""

    symbol, label, colour = "a_n", "depth of the target, by its area", GREEN
    index = 2


@register_feature("alpha")
class Alpha(Feature):
    """Orientation (T3, T10) [rad]."""

    order, angle = 3, True
    unit, symbol, label, colour = "rad", "α", "orientation of the target in the image", PURPLE

    def value(self, view):
        return view.features.alpha

    def row(self, view):
        return interaction.orientation(view.m, view.mu, view.plane)


@register_source("moments")
class Moments(Source):
    """The camera node always makes them."""

    topic, message = "camera/features", "aras_visual_servo_msgs/MomentFeatures"
    tell_reference = ("reference_stamp_ns", "z_star_m", "area_star")

    def extractor(self, camera_info, vision):
        from aras_visual_servo_camera import MomentExtractor  # C++: not needed to import this
        return MomentExtractor(camera_info, vision)

    def why_lost(self, features):
        if features.target_visible and features.valid:
            return ""
        if getattr(features, "ambiguous", False):
            return "several objects in view, and it is not clear which is the target"
        return "target cut by the border or not orientable" if features.target_visible else "target not in view"

    def taught(self, features, z_star_m, normal_C):
        """Normalised by its own area, a view has an = Z* (T4)."""
        view = Features.from_object(features)
        view.has_reference, view.z_star_m, view.area_star = True, float(z_star_m), view.area
        view.an, view.xn, view.yn = view.z_star_m, view.z_star_m * view.xg, view.z_star_m * view.yg
        return Taught(view, view, plane_from_pose(normal_C, view.z_star_m * np.array([view.xg, view.yg, 1.0])))

    def follow(self, extractor, features):
        """Area and orientation are in the features; the orientation may be half a turn off."""
        extractor.set_reference(features.z_star_m, features.area_star, features.alpha)
