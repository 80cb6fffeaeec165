"""Features of the camera's pose: its displacement from the goal, and the reference point of law `hybrid`.

The laws that measure the pose put these values into the `View`. They need no interaction matrix, so these features
have no rows (docs/theory.md T25, T30).
"""

from ..ground.errors import DegenerateFeature
from .base import POINT_SOURCES, Feature, register_each
from ..palette import BLUE, BROWN, GREEN, NAVY, PURPLE, VERMILION


class _OfPose(Feature):
    sees_tilt, overlay, also_from = True, "pose", POINT_SOURCES

    def row(self, view):
        raise DegenerateFeature(f"{self.name}: this feature has no interaction row, allowed with the laws that measure "
                                "the pose (pbvs, hybrid) only")


class _Displacement(_OfPose):
    """Of the displacement from the goal: p_CgC [m], then theta u of R_CgC [rad] (T25)."""

    def value(self, view):
        return 0.0 if view.displacement is None else float(view.displacement[self.index])


register_each(_Displacement, ((f"t{axis}", f"t_{axis}", f"camera displaced along {axis}", colour)
                              for axis, colour in zip("xyz", (BLUE, VERMILION, GREEN))), unit="m")
register_each(_Displacement, ((f"r{axis}", f"r_{axis}", f"camera turned about {axis}", colour)
                              for axis, colour in zip("xyz", (NAVY, BROWN, PURPLE))), first=3, unit="rad")


class _ReferencePoint(_OfPose):
    """Of (x, y, ln(Z/Z*)) of the target's reference point, its centroid at the goal (T30) [-]."""

    overlay = "reference"

    def value(self, view):
        if view.reference_point is None:
            return (view.features.xg, view.features.yg, 0.0)[self.index]
        return float(view.reference_point[self.index])


register_each(_ReferencePoint, (("xr", "x_r", "reference point in x", BLUE),
                                ("yr", "y_r", "reference point in y", VERMILION),
                                ("zr", "z_r", "logarithm of the reference point's depth", GREEN)))
