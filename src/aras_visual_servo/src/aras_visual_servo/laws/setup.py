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

    infinity_part: float = setting(above=0, below=1, help="Gain factor far from the goal; 1 at the goal.")
    slope: float = setting(above=0, help="Decrease of the factor near the goal, per unit of the largest error.")


@dataclass(frozen=True)
class LawSetup:
    """Settings of any law besides its gains: keys of the section `servo`.

    Attributes:
        target: the known target, read from the file `target_model`; None if there is no such file.
        settings: name of a law or feature -> its own settings; a name that is missing gets its defaults.
    """

    features: Tuple[str, ...] = setting(
        FEATURE_NAMES, not_empty=True,
        help="Features by name (docs/features_and_laws.md); `points4` is all of four points. Features that see tilt "
             "control all six degrees of freedom.")
    interaction: str = setting(
        "desired", choices=INTERACTIONS,
        help="Matrix that `ibvs` and `sliding` invert: at the goal, of the current view, or their mean (second-order "
             "minimisation).")
    adaptive_gain: Optional[AdaptiveGainSettings] = setting(
        None, help="Reduces the gains where the error is large (T22).")
    smooth_start_per_s: float = setting(
        0.0, unit="1/s", at_least=0,
        help="Rate at which the camera reaches the twist of the law from rest (T23); 0: at once.")
    target_normal_C: Tuple[float, ...] = setting(
        (0.0, 0.0, 1.0), size=3, condition=AWAY,
        help="Normal of the target's plane in the goal camera frame, z > 0.")
    point_depth: str = setting(
        "plane", choices=POINT_DEPTHS,
        help="Depth of points in the matrix of the current view: `plane`, from the target's plane and the joints; "
             "`goal`, as at the goal; `image`, from the depth image.")
    target_model: str = setting(
        "", not_empty=True,
        help="For `pbvs` and `hybrid`: file of the planar target. With central symmetry its pose is ambiguous by half "
             "a turn.")
    pose_from: str = setting(
        "moments", choices=POSES,
        help="Source of the pose for `pbvs` and `hybrid`: `moments` of the known target; `points`, its corners or, "
             "without `target_model`, points in the taught plane; `depth`, these points in the depth image.")
    symmetric_target: bool = setting(
        False,
        help="The target looks the same after half a turn (rectangle, ellipse): alpha is controlled modulo half a "
             "turn.")
    source: str = setting(
        "", not_empty=True,
        help="Source of the features: `matches` makes points and poses from keypoints matched with the goal image; "
             "none: each feature's own.")
    target: Optional[PlanarTarget] = None
    settings: Mapping[str, Any] = field(default_factory=dict)
