"""What the protocol `map` maps: each registered law with each set of features that it works on.

A new law appears by itself, and so does a new mapping of the grey levels. A new feature is listed as left out until a
set of SETS has it; where one of a kind stands for all of them, or where there is a reason, STANDS_FOR says so.
"""

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Tuple

from aras_visual_servo import (FeatureSet, ParameterError, Scenario, expand, feature_class, known_features, known_laws,
                               load_scenario, works_on, yaml_section)

SCENARIO = "free_camera"
GAIN_PER_S, TIME_LIMIT_S = 2.0, 12.0
#: By the unit of a feature: threshold of the stop rule, and half the boundary layer of `sliding`.
THRESHOLDS = {"m": 0.0002, "rad": 0.0005, "-": 0.0002, "grey": 2.0}
BOUNDARIES = {"m": 0.005, "rad": 0.02, "-": 0.01}
#: Laws that are mapped with each matrix; the others have that of the base scenario.
WITH_EACH_MATRIX = {"ibvs": ("desired", "current", "mean")}
#: Half the view of the camera: 320 x 240 px at f = 188 px.
_VIEW = {"half_width": 0.849, "half_height": 0.636, "margin": 0.02}
#: What a law changes in the scenario of each set.
LAWS: Dict[str, Dict[str, Any]] = {"qp": {"servo.qp": _VIEW}, "mpc": {"servo.mpc": _VIEW},
                                   "broyden": {"servo.broyden": {"initial": "moves"}}}

_MODEL = "package://aras_description/targets/"
_POSE, _REFERENCE = ("tx", "ty", "tz", "rx", "ry", "rz"), ("xr", "yr", "zr", "rx", "ry", "rz")
_CORNERS = {"vision.points": "corners", "vision.point_count": 6}
_PICTURE = {"name": "target", "position_m": [-0.050017, 0.0, 0.362227], "rpy_rad": [0.0, 0.0, 1.5707963],
            "image": {"file": f"{_MODEL}photo.png", "size_m": [1.6, 1.2]}}


def _in_place(file):
    return {"sim.scene.models": [{"name": "target", "file": f"{_MODEL}{file}",
                                  "position_m": [-0.050017, 0.0, 0.362227], "rpy_rad": [0.0, 0.0, 1.5707963]}]}


class Set(NamedTuple):
    """Features that a law is given together.

    Attributes:
        name: short, for files.  label: what is measured, in words.  features: names as in a scenario.
        changes: {"section.key": value} of the scenario.
        laws: of the laws that take any features, those to map; None: all of them.  why: why the others are not mapped.
        coarse: factor on the thresholds, for measurements with noise.
        of_area: whether areas of the image are measured (moments, kernels, grey levels); False: points and lines.
    """

    name: str
    label: str
    features: Tuple[str, ...]
    changes: Mapping[str, Any]
    laws: Optional[Tuple[str, ...]] = None
    why: str = ""
    coarse: float = 1.0
    of_area: bool = False


def _followed(name, label, *features, **more):
    return Set(name, label, features, {**_CORNERS, **more})


def _area(name, label, *features, **changes):
    return Set(name, label, features, changes, of_area=True)


def _poses(name, label, changes, **more):
    return [Set(f"pose_{name}", f"pose: {label}", _POSE, changes, (), **more),
            Set(f"reference_{name}", f"pose: {label}", _REFERENCE, changes, (), **more)]


_KEYPOINTS = {"sim.scene.models": [_PICTURE], "vision.matches": {"detector": "orb"}, "servo.source": "matches",
              "servo.pose_from": "points"}
_TAG = {**_in_place("tag.yaml"), "vision.tag": {"family": "36h11", "id": 0, "size_m": 0.16}, "servo.source": "tag",
        "servo.pose_from": "points"}  # a rectangle's corners would be the same ones after half a turn
_SLOW = "an image takes as long as forty of an outline, and the points are those of the homography"


def _luminance(mapping):
    """The grey levels of a picture (`none`), or what one of the camera package's mappings makes of them."""
    levels = {} if mapping == "mixture" else {"levels": 4, "switch_px": 0.5}  # widens and narrows by itself
    matrix = "current" if mapping == "mutual_information" else "mean"  # the only one that it has
    plain = mapping == "none"
    return Set("photometric" if plain else f"photometric_{mapping}",
               "luminance of a picture" + ("" if plain else f", {mapping.replace('_', ' ')}"), ("photometric",), {
                   "sim.scene.models": [_PICTURE], "servo.interaction": "desired",
                   "servo.photometric": {"damping": 0.01, "rest_m_per_s": 0.0005, "rest_rad_per_s": 0.001},
                   "vision.photometric": {"interaction": matrix, **levels, **({} if plain else {"mapping": mapping}),
                                          "target_normal_C": [0.0, 0.0, 1.0]}}, (), of_area=True)


SETS = (
    _area("moments_4", "moments, tilt held by the joints", "xn", "yn", "an", "alpha"),
    _area("moments_s", "moments, tilt by sx, sy", "xn", "yn", "an", "sx", "sy", "alpha"),
    _area("moments_p", "moments, tilt by px, py", "xn", "yn", "an", "px", "py", "alpha"),
    _area("invariants", "moments, tilt by invariants", "xn", "yn", "an", "c1", "c2", "alpha"),
    _area("ellipse", "centroid and second moments", "xg", "yg", "n20", "n11", "n02", "sx", "sy"),
    _area("kernel", "kernel projections, tilt held", "kx", "ky", "an", "alpha",
          **{"vision.kernel": {"p": 1.0, "q": 1.0}}),
    _followed("points", "six points", "points6"),
    _followed("segments", "two segments", "xm1", "ym1", "l1", "alpha1", "xm4", "ym4", "l4", "alpha4"),
    _followed("polar", "six points, polar", *(f"{axis}{n}" for n in range(1, 7) for axis in ("rho", "theta"))),
    _followed("lines", "six lines", *(f"{axis}{n}" for n in range(1, 7) for axis in ("lr", "lt"))),
    _followed("rays", "six rays", *(f"{axis}{n}" for n in range(1, 7) for axis in ("us", "vs", "ws"))),
    Set("vanishing", "vanishing points and corners of an AprilTag",
        ("vx1", "vy1", "vz1", "vx2", "vy2", "vz2", "x1", "y1", "x3", "y3"), _TAG),
    Set("sphere", "sphere moments, vanishing points of an AprilTag",
        ("is1", "is2", "is3", "is4", "vx1", "vy1", "vz1", "vx2", "vy2", "vz2"), _TAG),
    *_poses("moments", "moments of a known target", {"servo.target_model": f"{_MODEL}l_shape.yaml"}, of_area=True),
    *_poses("points", "six points in the taught plane", {**_CORNERS, "servo.pose_from": "points"}),
    *_poses("keypoints", "ORB keypoints of a picture", _KEYPOINTS, coarse=10.0),
    *_poses("tag", "AprilTag", _TAG),
    Set("keypoints", "four points of ORB keypoints", ("points4",), _KEYPOINTS, ("ibvs",), _SLOW, 10.0),
    Set("tag", "four points of an AprilTag", ("points4",), _TAG, ("ibvs",), _SLOW),
    *map(_luminance, yaml_section("aras_visual_servo_camera", "photometric")["properties"]["mapping"]["enum"]),
)
#: Features that are in no set because others stand for them, or by themselves say too little.
STANDS_FOR = {
    **{f"c{n}": "c1, c2 stand for the invariants" for n in range(1, 11)},
    **dict.fromkeys(("xe", "ye", "e20", "e11", "e02"), "of a circle, whose turn about its axis does not show"),
    **dict.fromkeys(("ox", "oy", "oz"), "of a sphere, whose turns do not show"),
    **dict.fromkeys(("ug", "vg", "wg"), "the rays stand for their middle"),
    "is": "is1 to is4 stand for it"}


class Row(NamedTuple):
    """One map: a law, with its matrix where there are several, on a set of features."""

    name: str
    law: str
    set: Set
    scenario: Scenario


def plan(changes: Optional[Dict[str, Any]] = None) -> Tuple[List[Row], List[Tuple[str, str]]]:
    """Returns (rows, left_out): what is mapped, and what is not with why.

    Args: changes: dotted path -> value, put into every scenario; `servo.law` is the only law to map.
    Raises ParameterError: the law is not registered.
    """
    base, rows, left_out, rest = load_scenario(SCENARIO), [], [], dict(changes or {})
    chosen = rest.pop("servo.law", None)
    if chosen is not None and chosen not in known_laws():
        raise ParameterError(f"--law: found {chosen}, allowed {', '.join(known_laws())}")
    for one in SETS:
        for law in known_laws() if chosen is None else (chosen,):
            made_for = works_on(law)
            if made_for is not None and tuple(made_for) != expand(one.features):
                continue
            if made_for is None and one.laws is not None and law not in one.laws:
                left_out += [(f"{law}: {one.label}", one.why)] if one.why else []
                continue
            for matrix in WITH_EACH_MATRIX.get(law, ("",)):
                name = f"{law}_{matrix}" if matrix else law
                try:
                    scenario = scenario_of(base, one, law, matrix, rest)
                except ParameterError as error:
                    left_out.append((f"{law}: {one.label}", str(error)))
                    continue
                rows.append(Row(f"{name}_{one.name}", name.replace("_", ", "), one, scenario))
    return rows, left_out + _features_left_out()


def scenario_of(base: Scenario, one: Set, law: str, matrix: str = "",
                changes: Optional[Dict[str, Any]] = None) -> Scenario:
    """Returns the scenario of a law on a `Set`, with `changes` (dotted path -> value). Raises ParameterError."""
    names = expand(one.features)
    units = {name: feature_class(name).unit for name in names}
    boundary = {name: BOUNDARIES.get(unit, 0.01) for name, unit in units.items()}
    values: Dict[str, Any] = {
        "vision.order": max(3, FeatureSet(one.features, {}, one.changes.get("servo.source", "")).order),
        "servo.law": law, "servo.features": list(one.features), "servo.time_limit_s": TIME_LIMIT_S,
        "servo.gains_per_s": dict.fromkeys(names, GAIN_PER_S),
        "servo.thresholds": {name: one.coarse * THRESHOLDS.get(unit, 0.0002) for name, unit in units.items()},
        **({"servo.sliding": {"switching_per_s": 2.0, "boundary": boundary}} if law == "sliding" else {}),
        **({"servo.interaction": matrix} if matrix else {}), **LAWS.get(law, {}), **one.changes, **(changes or {})}
    return base.with_overrides(values)


def _features_left_out():
    """Features that no set has, list of (text, why)."""
    used = {name for one in SETS for name in expand(one.features)}
    kinds = used | {name.rstrip("0123456789") + "N" for name in used}
    return [(name, STANDS_FOR.get(name, "no set of compare/protocols/convergence/sets.py has it"))
            for name in known_features() if name not in kinds]
