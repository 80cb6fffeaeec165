"""Source `tag`: the corners of an AprilTag (TagFeatures). Where its size is known, its pose gives the taught plane."""

from typing import Any, Mapping, Optional, Sequence

import numpy as np

from ...ground.types import Features
from ..interaction import plane_from_pose
from .base import Taught, register_source
from .matches import Matches, points_view


@register_source("tag")
class Tag(Matches):
    """Four corners, each known by the tag's code however the tag is turned; points and poses work on them."""

    topic, message, section = "camera/tag", "aras_visual_servo_msgs/TagFeatures", "tag"
    extractor_class, sees_parts, averages = "TagExtractor", False, True  # the whole tag has to be in view

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        return False

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        """As of `Source`. A tag of known size says itself how its plane lies; normal_C is for one of unknown size."""
        view = self.kept(features, float(z_star_m))
        if len(features.position_m) != 3:
            return Taught(view, view, plane_from_pose(normal_C, [0.0, 0.0, view.z_star_m]))
        x, y, z, w = features.orientation
        out_of_face = np.array([2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)])
        return Taught(view, view, plane_from_pose(-out_of_face, features.position_m))

    def kept(self, features: Any, z_star_m: Optional[float] = None) -> Features:
        return points_view(features, features.point_x, features.point_y,
                           features.z_star_m if z_star_m is None else z_star_m)
