"""Settings that all laws share: keys of the section `servo` for the inputs and the mode of a law."""

from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Tuple

from ..config.settings import setting
from ..ground.types import FEATURE_NAMES
from ..features.target.target_pose import PlanarTarget

INTERACTIONS = ("desired", "current", "mean")
POINT_DEPTHS = ("plane", "goal", "image")
POSES = ("moments", "points", "depth")
AWAY = ("z > 0 (away from the camera)", lambda normal: normal[2] > 0.0)


@dataclass(frozen=True)
class AdaptiveGainSettings:
    """Section `servo.adaptive_gain`: the gains become smaller where the error is large (T22)."""

    infinity_part: float = setting(above=0, below=1, help="Factor on the gains far from the goal; at the goal it is 1.")
    slope: float = setting(above=0, help="How fast the factor falls near the goal, per unit of the largest error.")


@dataclass(frozen=True)
class LawSetup:
    """Settings of any law besides its gains: keys of the section `servo`.

    Attributes:
        target: the known target, read from the file `target_model`; None if there is no such file.
        settings: name of a law or feature -> its own settings; a name that is missing gets its defaults.
    """

    features: Tuple[str, ...] = setting(
        FEATURE_NAMES, not_empty=True,
        help="What is servoed on, by name (docs/features_and_laws.md); `points4` stands for all of four points. "
             "Features that see tilt servo all six degrees of freedom.")
    interaction: str = setting(
        "desired", choices=INTERACTIONS,
        help="Which matrix `ibvs` and `sliding` invert: that at the goal, that of the current view, or the mean of "
             "both (second-order minimisation).")
    adaptive_gain: Optional[AdaptiveGainSettings] = setting(
        None, help="If given, the gains become smaller where the error is large (T22).")
    smooth_start_per_s: float = setting(
        0.0, unit="1/s", at_least=0,
        help="The camera starts from rest and reaches the twist of the law at this rate (T23); 0: at once.")
    target_normal_C: Tuple[float, ...] = setting(
        (0.0, 0.0, 1.0), size=3, condition=AWAY,
        help="Normal of the target's plane in the camera frame at the goal, z > 0.")
    point_depth: str = setting(
        "plane", choices=POINT_DEPTHS,
        help="Depth of followed points in the matrix of the current view: `plane` takes the target's plane as the "
             "joint positions place it, `goal` the depths at the goal, `image` those of the depth image.")
    target_model: str = setting(
        "", not_empty=True,
        help="For `pbvs` and `hybrid`: file of the known planar target. The pose of a target with central symmetry is "
             "known up to half a turn.")
    pose_from: str = setting(
        "moments", choices=POSES,
        help="From what `pbvs` and `hybrid` find the pose: `moments` of the known target, or followed `points`, which "
             "are its corners or, without `target_model`, points in the taught plane; or `depth`, the same points "
             "where the depth image puts them.")
    symmetric_target: bool = setting(
        False,
        help="The target is the same after half a turn (rectangle, ellipse): alpha is servoed on modulo half a turn, "
             "even where a tilted view seems to tell the two apart.")
    source: str = setting(
        "", not_empty=True,
        help="What makes the features of an image, where several can: `matches` makes followed points, and poses of "
             "them, from keypoints that match those of the goal image. Left out: each feature's own.")
    target: Optional[PlanarTarget] = None
    settings: Mapping[str, Any] = field(default_factory=dict)
