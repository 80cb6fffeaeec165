"""Features of the camera's pose: its displacement from the goal, and the reference point of law `hybrid`.

The laws that measure the pose put these values into the `View`. They need no interaction matrix, so these features
have no rows (docs/theory.md T25, T30).
"""

from ..ground.errors import DegenerateFeature
from .base import Feature, register_feature
from ..palette import BLUE, BROWN, GREEN, NAVY, PURPLE, VERMILION


class _OfPose(Feature):
    sees_tilt, index, overlay, also_from = True, 0, "pose", ("matches", "tag")

    def row(self, view):
        raise DegenerateFeature(f"{self.name}: this feature has no interaction row, allowed with the laws that measure "
                                "the pose (pbvs, hybrid) only")


class _Displacement(_OfPose):
    def value(self, view):
        return 0.0 if view.displacement is None else float(view.displacement[self.index])


class _ReferencePoint(_OfPose):
    overlay = "reference"

    def value(self, view):
        if view.reference_point is None:
            return (view.features.xg, view.features.yg, 0.0)[self.index]
        return float(view.reference_point[self.index])


for _index, (_name, _colour) in enumerate(zip(("tx", "ty", "tz", "rx", "ry", "rz"),
                                              (BLUE, VERMILION, GREEN, NAVY, BROWN, PURPLE))):
    _kind, _axis = _name
    _text = f"{_name} of the displacement from the goal: p_CgC [m], then theta u of R_CgC [rad] (T25)."
    register_feature(_name)(type(_name, (_Displacement,), {
        "index": _index, "__doc__": _text, "unit": "m" if _kind == "t" else "rad", "symbol": f"{_kind}_{_axis}",
        "label": f"camera displaced along {_axis}" if _kind == "t" else f"camera turned about {_axis}",
        "colour": _colour}))

for _index, (_name, _label, _colour) in enumerate((("xr", "reference point in x", BLUE),
                                                   ("yr", "reference point in y", VERMILION),
                                                   ("zr", "logarithm of the reference point's depth", GREEN))):
    _text = f"{_name} of (x, y, ln(Z/Z*)) of the target's reference point, its centroid at the goal (T30) [-]."
    register_feature(_name)(type(_name, (_ReferencePoint,), {
        "index": _index, "__doc__": _text, "symbol": f"{_name[0]}_r", "label": _label, "colour": _colour}))
