"""Sources whose features another node makes: poses, corners and boxes of a detector, over ROS only.

The controller node subscribes to their topics and hands each message to `Source.read`. Nothing is taught to a camera.
"""

from math import isfinite, nan
from types import SimpleNamespace
from typing import Any, Mapping, Optional, Sequence, Tuple

import numpy as np

from ...ground.errors import ParameterError
from ...ground.types import Features
from ...spatial import pose_from_quaternion
from .base import Source, Taught, register_source
from .matches import points_view
from .moments import Moments
from .tag import Tag

#: Corners of the square that stands for a pose, in the target's frame [m].
SQUARE_M = 0.05 * np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
#: A pose is refused when its standard deviation is above this part of its distance, or above this angle [rad].
MOST_UNSURE, MOST_UNSURE_RAD = 0.1, 0.2
#: Orders of the moments of a box: what features of first and second order need.
ORDERS = [(i, k - i) for k in range(4) for i in range(k, -1, -1)]


class Elsewhere(Source):
    """Base class of sources whose features another node makes: refuses runs in one process, and messages of another
    frame. A subclass says how it reads a message (`_read`)."""

    sees_parts = from_elsewhere = True

    def extractor(self, camera_info: Mapping[str, Any], vision: Mapping[str, Any]) -> Any:
        raise ParameterError(f"servo.source: found {self.name}, which another node makes; allowed over ROS only")

    def read(self, message: Any, camera: Any, reference: Any) -> Any:
        (view, fault), frame = self._read(message, camera, reference), message.header.frame_id
        if camera.frame_id and frame and frame != camera.frame_id:
            fault = f"{self.topic}: found frame '{frame}', allowed that of the camera, '{camera.frame_id}'"
        view.header, view.fault = message.header, fault
        view.target_visible = view.valid = not fault
        return view

    def _read(self, message: Any, camera: Any, reference: Any) -> Tuple[Any, str]:
        """Returns (features of a message, why they cannot be used or "")."""
        raise NotImplementedError


@register_source("pose")
class Pose(Elsewhere, Tag):
    """The pose of the target's frame in the camera's. Its plane z = 0 is the target's, and four points stand for it."""

    topic, message, section = "target/pose", "geometry_msgs/PoseStamped", ""

    def _read(self, message: Any, camera: Any, reference: Any) -> Tuple[Any, str]:
        return self._of_pose(message.pose)

    def _of_pose(self, pose):
        p, q = ([getattr(part, axis) for axis in axes] for part, axes in ((pose.position, "xyz"),
                                                                          (pose.orientation, "xyzw")))
        seen = SimpleNamespace(has_reference=True, reference_stamp_ns=-1, z_star_m=nan, point_x=(), point_y=(),
                               position_m=p, orientation=q)
        size = float(np.linalg.norm(q))
        if not isfinite(sum(p)) or not abs(size - 1.0) < 0.01:
            return seen, f"{self.topic}: found no finite position with a unit quaternion: the target is not in view"
        seen.orientation = [value / size for value in q]
        points = pose_from_quaternion(p, seen.orientation)[:3] @ np.c_[SQUARE_M, np.ones(4)].T
        if not points[2].min() > 0.0:
            return seen, f"{self.topic}: the target is behind the camera"
        seen.point_x, seen.point_y = (tuple((points[k] / points[2]).tolist()) for k in (0, 1))
        return seen, ""


@register_source("pose_with_covariance")
class PoseWithCovariance(Pose):
    """As `pose`. A pose of large variance is refused."""

    topic, message = "target/pose_with_covariance", "geometry_msgs/PoseWithCovarianceStamped"

    def _read(self, message: Any, camera: Any, reference: Any) -> Tuple[Any, str]:
        seen, fault = self._of_pose(message.pose.pose)
        variance = np.reshape(np.asarray(message.pose.covariance, dtype=float), (6, 6)).diagonal()
        if fault or not variance.any():  # zeros: the covariance is not known
            return seen, fault
        if not (np.isfinite(variance).all() and variance.min() >= 0.0):
            return seen, f"{self.topic}: covariance: found variances {variance.tolist()}, allowed finite ones >= 0"
        distance_m, unsure = float(np.linalg.norm(seen.position_m)), np.sqrt(variance)
        if unsure[:3].max() > MOST_UNSURE * distance_m or unsure[3:].max() > MOST_UNSURE_RAD:
            return seen, (f"{self.topic}: covariance: found standard deviations {unsure[:3].max():.3g} m and "
                          f"{unsure[3:].max():.3g} rad, allowed {MOST_UNSURE * distance_m:.3g} m and "
                          f"{MOST_UNSURE_RAD:g} rad")
        return seen, ""


@register_source("corners")
class Corners(Elsewhere, Tag):
    """Points of the image in px, in one order in all images; z is their depth [m], or 0 where it is not known."""

    topic, message, section = "target/corners", "geometry_msgs/PolygonStamped", ""

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        return True  # the message may bring them

    def taught(self, features: Any, z_star_m: float, normal_C: Sequence[float]) -> Taught:
        return super().taught(SimpleNamespace(**vars(features), position_m=()), z_star_m, normal_C)

    def kept(self, features: Any, z_star_m: Optional[float] = None) -> Features:
        z_star_m = features.z_star_m if z_star_m is None else z_star_m
        n = len(features.point_x)
        view = points_view(features, features.point_x, features.point_y, z_star_m, features.point_z)
        view.xg, view.yg = sum(features.point_x) / n, sum(features.point_y) / n
        view.xn, view.yn = z_star_m * view.xg, z_star_m * view.yg
        return view

    def _read(self, message: Any, camera: Any, reference: Any) -> Tuple[Any, str]:
        seen = SimpleNamespace(has_reference=True, reference_stamp_ns=-1, z_star_m=nan, point_x=(), point_y=(),
                               point_z=(), depth_fault=f"{self.topic} has no depths")
        rows = [(point.x, point.y, point.z) for point in message.polygon.points]
        if not rows:
            return seen, f"{self.topic}: found no points: the target is not in view"
        xy, fault = camera.normalised([row[:2] for row in rows])
        if fault:
            return seen, fault
        seen.point_x, seen.point_y = (tuple(column) for column in xy.T.tolist())
        depths = tuple(row[2] for row in rows)
        if min(depths) > 0.0 and isfinite(sum(depths)):
            seen.point_z, seen.depth_fault = depths, ""
        return seen, ""


@register_source("detections")
class Detections(Elsewhere, Moments):
    """The box of the best detection in px, as an object of that shape: for xn, yn and an. A box tells no turn."""

    topic, message = "target/detections", "vision_msgs/Detection2DArray"

    def wants_depth(self, vision: Mapping[str, Any]) -> bool:
        return False

    def why_lost(self, features: Any) -> str:
        return features.fault

    def _read(self, message: Any, camera: Any, reference: Any) -> Tuple[Any, str]:
        view = Features()
        if not message.detections:
            return view, f"{self.topic}: found no detections: the target is not in view"
        box = max(message.detections, key=_score).bbox
        u, v, width, height = box.center.x, box.center.y, box.size_x, box.size_y
        if not (width > 0.0 and height > 0.0):
            return view, f"{self.topic}: found a box of {width:g} x {height:g} px, allowed > 0"
        xy, fault = camera.normalised([(u - 0.5 * width, v), (u + 0.5 * width, v),
                                       (u, v - 0.5 * height), (u, v + 0.5 * height)])
        if fault:
            return view, fault
        (x0, x1), (y0, y1) = xy[:2, 0].tolist(), xy[2:, 1].tolist()
        view.moment_names = tuple(f"{i}{j}" for i, j in ORDERS)
        view.xg, view.yg, view.area, view.alpha = 0.5 * (x0 + x1), 0.5 * (y0 + y1), (x1 - x0) * (y1 - y0), 0.0
        view.m = tuple(_power(x0, x1, i) * _power(y0, y1, j) for i, j in ORDERS)
        a, b = 0.5 * (x1 - x0), 0.5 * (y1 - y0)
        view.mu = tuple(_power(-a, a, i) * _power(-b, b, j) for i, j in ORDERS)
        goal = None if reference is None else reference.view
        if goal is not None and goal.area_star > 0.0:
            view.has_reference, view.z_star_m, view.area_star = True, goal.z_star_m, goal.area_star
            view.an = goal.z_star_m * (goal.area_star / view.area) ** 0.5
            view.xn, view.yn = view.an * view.xg, view.an * view.yg
        return view, ""


def _power(low, high, power):
    """The integral of x^power from low to high."""
    return (high ** (power + 1) - low ** (power + 1)) / (power + 1)


def _score(detection):
    """The best score of a detection's hypotheses, in both forms that vision_msgs has had; 0 without any."""
    return max((getattr(result, "hypothesis", result).score for result in detection.results), default=0.0)
