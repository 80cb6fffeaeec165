"""Data that flows between camera, servo and robot. Plain containers, no ROS.

Their fields carry the names and units of the messages of aras_visual_servo_msgs, so that a converter is a list of
assignments. Twists are stacked [v; w], in the camera optical frame C. Joints are matched by name.
"""

from dataclasses import dataclass, field
from enum import IntEnum
from math import nan
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np

from .errors import ParameterError

#: The features servoed on unless a scenario names others, in the order of every s, e, gain and threshold: xn, yn,
#: an [m], alpha [rad].
FEATURE_NAMES = ("xn", "yn", "an", "alpha")
#: Joint positions by name, or (n,) in the order of `RobotKinematics.joint_names` [m or rad].
JointPositions = Union[Mapping[str, float], np.ndarray]


class Status(IntEnum):
    """Codes of aras_visual_servo_msgs/ServoState."""

    IDLE = 0
    SERVOING = 1
    CONVERGED = 2
    TARGET_LOST = 3
    STALE_INPUT = 4
    JOINT_LIMIT = 5
    NEAR_SINGULARITY = 6
    TIMED_OUT = 7
    STOPPED = 8
    FAULT = 9
    STOPPED_BY_RULE = 10
    SETTLED = 11
    OUT_OF_REACH = 12


#: Statuses that end the servo phase; only a new start moves the arm again.
FINAL = (Status.CONVERGED, Status.TIMED_OUT, Status.STOPPED, Status.FAULT, Status.STOPPED_BY_RULE, Status.SETTLED)

#: Steps of an experiment, in order (ServoState.phase); "idle" before it starts.
PHASES = ("idle", "to_goal", "settle_goal", "teach", "to_start", "settle_start", "servo", "done")


@dataclass
class Features:
    """Image moments of the target in one image: the fields of aras_visual_servo_msgs/MomentFeatures.

    A quantity that does not exist in this image is NaN; the points are empty where they are not found. The servo only
    reads attributes, so the extractor's object and the ROS message serve as they are; this class is for tests and for
    objects that must outlive their source.
    """

    target_visible: bool = False
    touches_border: bool = False
    symmetric: bool = False
    has_reference: bool = False
    valid: bool = False
    ambiguous: bool = False
    components: int = 0
    area: float = nan
    xg: float = nan
    yg: float = nan
    alpha: float = nan
    xn: float = nan
    yn: float = nan
    an: float = nan
    z_star_m: float = nan
    area_star: float = nan
    reference_stamp_ns: int = -1
    orientation_condition: float = nan
    asymmetry: float = nan
    edge_stddev: float = nan
    moment_names: Sequence[str] = ()
    m: Sequence[float] = ()
    mu: Sequence[float] = ()
    point_x: Sequence[float] = ()
    point_y: Sequence[float] = ()
    point_z: Sequence[float] = ()
    depth_fault: str = ""
    ray_x: Sequence[float] = ()
    ray_y: Sequence[float] = ()
    ray_z: Sequence[float] = ()
    kernel_x: Sequence[float] = ()
    kernel_y: Sequence[float] = ()
    age_s: float = nan

    @classmethod
    def from_object(cls, source: Any) -> "Features":
        """Copy of any object with these attributes (those of `_OPTIONAL` may be missing)."""
        names = [name for name in cls.__dataclass_fields__ if name not in _OPTIONAL]
        copy = cls(**{name: getattr(source, name) for name in names},
                   **{name: getattr(source, name, default) for name, default in _OPTIONAL.items()})
        for name in ("moment_names", "m", "mu", *VIEW_POINTS):
            setattr(copy, name, tuple(getattr(copy, name)))
        return copy

    def raw_moments(self) -> Dict[str, float]:
        """m_ij by name "ij"."""
        return dict(zip(self.moment_names, self.m))

    def centred_moments(self) -> Dict[str, float]:
        """mu_ij by name "ij"."""
        return dict(zip(self.moment_names, self.mu))


@dataclass(slots=True)
class Observation:
    """Inputs of the servo at one image.

    Attributes:
        stamp_ns: time of the state the image shows [ns].
        features: `Features`, or any object with its attributes; None when there is no image.
        q: joint positions at stamp_ns.
        frame: index of the image.
    """

    stamp_ns: int
    features: Optional[Any]
    q: JointPositions
    frame: int = -1


@dataclass(slots=True)
class Command:
    """Answers to one observation, for any subset of the joints, by name.

    `position` sets set-points at once [m or rad]; `velocity` [m/s or rad/s] is integrated into the set-point until the
    next command. A joint that is in neither of the two keeps its set-point, and its velocity is no longer integrated.
    """

    stamp_ns: int
    position: Dict[str, float] = field(default_factory=dict)
    velocity: Dict[str, float] = field(default_factory=dict)


@dataclass(slots=True)
class ServoRecord:
    """State of the servo at one image: the fields of aras_visual_servo_msgs/ServoState."""

    stamp_ns: int
    status: Status
    status_text: str = ""
    phase: str = "idle"
    converged: bool = False
    feature_names: Tuple[str, ...] = FEATURE_NAMES
    s: np.ndarray = field(default_factory=lambda: np.full(4, nan))
    s_star: np.ndarray = field(default_factory=lambda: np.full(4, nan))
    e: np.ndarray = field(default_factory=lambda: np.full(4, nan))
    twist: np.ndarray = field(default_factory=lambda: np.zeros(6))
    joint_names: Tuple[str, ...] = ()
    q: np.ndarray = field(default_factory=lambda: np.empty(0))
    q_dot: np.ndarray = field(default_factory=lambda: np.empty(0))
    set_point: np.ndarray = field(default_factory=lambda: np.empty(0))
    manipulability: float = nan
    cond_l: float = nan
    tilt_rad: float = nan
    position_m: float = nan
    rotation_rad: float = nan


@dataclass(frozen=True)
class Reference:
    """The goal as taught: features and attitude of the camera.

    Attributes:
        s_star: (k,) wanted features; by default xn, yn, an [m], alpha [rad].
        optical_axis_B: (3,) unit vector, optical axis in the robot base frame; None: tilt is not held.
        posture: joint positions by name; None: the spare motion has no posture to return to.
        view: the taught `Features`, with the fields `VIEW_FIELDS` only, for laws that use the matrix at the goal; or
        None.
        plane_C: (3,) (A, B, C) of the target in the taught camera frame [1/m]; or None.
        images: number of images whose mean the view is.
    """

    s_star: np.ndarray
    optical_axis_B: Optional[np.ndarray] = None
    posture: Optional[Dict[str, float]] = None
    view: Optional[Features] = None
    plane_C: Optional[np.ndarray] = None
    images: int = 1

    def to_dict(self) -> Dict[str, Any]:
        """Returns plain lists, for a parameter server or a file, without keys whose value is None."""
        result = {key: np.asarray(getattr(self, key), dtype=float).tolist()
                  for key in ("s_star", "optical_axis_B", "plane_C") if getattr(self, key) is not None}
        result["images"] = self.images
        if self.posture is not None:
            result["posture"] = {name: float(q) for name, q in self.posture.items()}
        if self.view is not None:
            values = {key: np.asarray(getattr(self.view, key), dtype=float) for key in (*_VIEW, *_WHERE_KNOWN)}
            result["view"] = {"moment_names": list(self.view.moment_names), **{
                key: value.tolist() for key, value in values.items()
                if key in _VIEW or value.size and np.isfinite(value).all()}}  # holes of depth are NaN
        return result

    @classmethod
    def from_dict(cls, source: Mapping[str, Any]) -> "Reference":
        """Inverse of `to_dict`. Raises ParameterError on wrong keys, lengths or non-finite numbers."""
        faults = [f"reference.{key}: unknown key" for key in source if key not in cls.__dataclass_fields__]
        s_star, posture = _numbers("s_star", source.get("s_star"), None, faults), source.get("posture")
        axis, plane = (None if source.get(key) is None else _numbers(key, source[key], (3,), faults)
                       for key in ("optical_axis_B", "plane_C"))
        view = None if source.get("view") is None else _view(source["view"], faults)
        if isinstance(posture, Mapping):
            posture = dict(zip(posture, _numbers("posture", list(posture.values()), None, faults).tolist()))
        elif posture is not None:
            faults.append(f"reference.posture: found {posture}, allowed joint positions by name")
        images = source.get("images", 1)
        if type(images) is not int or images < 1:
            faults.append(f"reference.images: found {images}, allowed a whole number >= 1")
        if faults:
            raise ParameterError(faults)
        return cls(s_star, axis, posture, view, plane, images)


#: Fields of the taught view that a reference keeps, beside its moments.
VIEW_FIELDS = ("xn", "yn", "an", "alpha", "z_star_m", "area_star")
#: ... and the followed points and the kernel projections, where there are any.
VIEW_POINTS = ("point_x", "point_y", "point_z", "ray_x", "ray_y", "ray_z", "kernel_x", "kernel_y")
_VIEW, _WHERE_KNOWN = ("m", "mu", *VIEW_FIELDS), (*VIEW_POINTS, "edge_stddev")
_OPTIONAL: Dict[str, Any] = {"ambiguous": False, "reference_stamp_ns": -1, "depth_fault": "", "age_s": nan,
                             "edge_stddev": nan, **dict.fromkeys(VIEW_POINTS, ())}


def _view(source, faults):
    """Features of the dict that `Reference.to_dict` makes of a view."""
    needed = ("moment_names", *_VIEW)
    if not isinstance(source, Mapping) or set(source) - set(_WHERE_KNOWN) != set(needed):
        faults.append(f"reference.view: found {source}, allowed {', '.join(needed)} and, if any, "
                      f"{', '.join(_WHERE_KNOWN)}")
        return None
    names = tuple(map(str, source["moment_names"]))
    shapes = {key: () if key in VIEW_FIELDS else (len(names),) for key in _VIEW}
    if "edge_stddev" in source:
        shapes["edge_stddev"] = ()
    for key in VIEW_POINTS:  # x and y come as a pair: both or neither; z may be missing
        along_x = source.get(key[:-1] + "x")
        if along_x and (key in source or not key.endswith("z")):
            shapes[key] = np.shape(along_x)
    values = {key: _numbers(f"view.{key}", source.get(key), shape, faults).tolist() for key, shape in shapes.items()}
    return Features(target_visible=True, valid=True, has_reference=True, moment_names=names, **values)


def _numbers(key, value, shape, faults):
    """Array of finite numbers. Args: shape: that it must have; None: any list."""
    try:
        numbers = np.array(value, dtype=float)
    except (TypeError, ValueError):
        numbers = np.array(nan)
    fits = numbers.ndim == 1 if shape is None else numbers.shape == shape
    if not fits or not np.isfinite(numbers).all():
        allowed = f"{shape[0]} finite numbers" if shape else "a list of finite numbers" if shape is None else "a number"
        faults.append(f"reference.{key}: found {value}, allowed {allowed}")
    return numbers
