"""Source `matches`: keypoints of a textured plane, matched to those of the goal image (MatchFeatures)."""

from dataclasses import replace
from typing import Any, Mapping, Sequence

from ...ground.types import Features
from ..interaction import plane_from_pose
from .base import Source, Taught, register_source


@register_source("matches")
class Matches(Source):
    """Four points of the goal's plane, which the homography between both images moves; the pose follows from them."""

    topic, message, section = "camera/matches", "aras_visual_servo_msgs/MatchFeatures", "matches"
    extractor_class, sees_parts, averages = "MatchExtractor", True, False

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        return "depth" in vision[self.section]

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        """As of `Source`. The points are those that the camera package says it will follow.

        Where keypoints have depths, these tell how far the points' plane is, and it is parallel to the image.
        """
        if len(features.as_goal_z):
            z_star_m, normal_C = features.as_goal_z[0], (0.0, 0.0, 1.0)
        view = points_view(features, features.as_goal_x, features.as_goal_y, float(z_star_m), features.as_goal_z)
        return Taught(view, view, plane_from_pose(normal_C, [0.0, 0.0, view.z_star_m]))

    def kept(self, features: Any) -> Features:
        return points_view(features, features.point_x, features.point_y, features.z_star_m, features.point_z)

    def mean(self, views: Sequence[Any]) -> Features:
        """The points one by one, and their middle."""
        return replace(views[0], **self.means(views, ("point_x", "point_y"), ("xg", "yg", "xn", "yn")))


def points_view(features: Any, x: Sequence[float], y: Sequence[float], z_star_m: float,
                z: Sequence[float] = ()) -> Features:
    """Returns `Features` with these points and their centre, for laws on points and for teaching."""
    view = Features(target_visible=True, valid=True, has_reference=True, z_star_m=z_star_m,
                    reference_stamp_ns=features.reference_stamp_ns)
    view.point_x, view.point_y, view.point_z = tuple(x), tuple(y), tuple(z)
    view.xg, view.yg = sum(0.25 * value for value in x), sum(0.25 * value for value in y)
    view.xn, view.yn, view.an = z_star_m * view.xg, z_star_m * view.yg, z_star_m  # where the plane's middle is [m]
    return view
