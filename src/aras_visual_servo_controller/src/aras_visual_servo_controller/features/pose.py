"""Features that a pose of the camera gives: displacement from the goal, and the reference point of law `hybrid`.

Laws that know the pose put it into the `View`; there are no interaction rows (docs/theory.md T25, T30).
"""

from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature


class _OfPose(Feature):
    sees_tilt, index = True, 0

    def row(self, view):
        raise DegenerateFeature(f"{self.name}: is for laws of the pose, which need no interaction matrix")


class _Displacement(_OfPose):
    def value(self, view):
        return 0.0 if view.displacement is None else float(view.displacement[self.index])


class _ReferencePoint(_OfPose):
    def value(self, view):
        if view.reference_point is None:
            return (view.features.xg, view.features.yg, 0.0)[self.index]
        return float(view.reference_point[self.index])


for _index, _name in enumerate(("tx", "ty", "tz", "rx", "ry", "rz")):
    _text = f"{_name} of the displacement from the goal: p_CgC [m], then theta u of R_CgC [rad] (T25)."
    register_feature(_name)(type(_name, (_Displacement,), {"index": _index, "__doc__": _text}))

for _index, _name in enumerate(("xr", "yr", "zr")):
    _text = f"{_name} of (x, y, ln(Z/Z*)) of the target's reference point, its centroid at the goal (T30) [-]."
    register_feature(_name)(type(_name, (_ReferencePoint,), {"index": _index, "__doc__": _text}))
