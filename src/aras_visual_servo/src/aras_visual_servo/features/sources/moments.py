"""Source `moments`: image moments of the target, its corners, its kernel projections (MomentFeatures)."""

from dataclasses import replace
from math import pi, remainder
from typing import Any, Mapping, Sequence

import numpy as np

from ...ground.errors import DegenerateFeature
from ...ground.types import VIEW_POINTS, Features
from ..interaction import plane_from_pose
from .base import Source, Taught, register_source


@register_source("moments")
class Moments(Source):
    """Features of the target as a dark or bright object in the image. The camera node always publishes them."""

    topic, message = "camera/features", "aras_visual_servo_msgs/MomentFeatures"
    extractor_class = "MomentExtractor"
    tell_reference = ("reference_stamp_ns", "z_star_m", "area_star")

    def renewed(self, extractor: Any) -> Any:
        extractor.clear_reference()
        extractor.forget_previous()
        return extractor

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        return "depth" in vision

    def why_lost(self, features: Any) -> str:
        if features.target_visible and features.valid:
            return ""
        if getattr(features, "ambiguous", False):
            return "several objects in view, and it is not clear which is the target"
        return "target cut by the border or not orientable" if features.target_visible else "target not in view"

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        """As of `Source`. A view that is its own reference has an = Z*, xn = Z* xg and yn = Z* yg (T4)."""
        view = Features.from_object(features)
        if len(view.ray_x) and not view.area > 0.0:
            _without_moments(view)
        view.has_reference, view.z_star_m, view.area_star = True, float(z_star_m), view.area
        view.an, view.xn, view.yn = view.z_star_m, view.z_star_m * view.xg, view.z_star_m * view.yg
        return Taught(view, view, plane_from_pose(normal_C, view.z_star_m * np.array([view.xg, view.yg, 1.0])))

    def kept(self, features: Any) -> Features:
        return Features.from_object(features)

    def mean(self, views: Sequence[Any]) -> Features:
        """Moments, points and features one by one; alpha the short way round from the first view's."""
        first, points = views[0], [name for name in VIEW_POINTS if name != "point_z"]
        mean = self.means(views, ("m", "mu", *points), ("area", "xg", "yg", "xn", "yn", "an"))
        alpha = first.alpha + float(np.mean([remainder(view.alpha - first.alpha, pi) for view in views]))
        return replace(first, alpha=alpha, **mean)

    def follow(self, extractor: Any, features: Any) -> None:
        """As of `Source`. Area and orientation come from the features; the orientation may be half a turn off."""
        extractor.set_reference(features.z_star_m, features.area_star, features.alpha)


def _without_moments(view):
    """Adds the centre of the points, in place of moments, to a view of points beside and behind the camera.

    Raises DegenerateFeature: the middle is not before the camera, so that it has no depth.
    """
    x, y, z = (float(np.mean(values)) for values in (view.ray_x, view.ray_y, view.ray_z))
    if not z > 0.0:
        raise DegenerateFeature("the middle of the points is not before the camera, where it would have the depth "
                                "z_star_m")
    view.xg, view.yg, view.area, view.alpha = x / z, y / z, 1.0, 0.0
    view.moment_names = view.m = view.mu = ()
